// Rules of the source tree that no compiler checks: rooms, heavy headers, pragmas, short steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace quern::test {

namespace {

namespace fs = std::filesystem;

struct Source {
    std::string path;  ///< from the root of the project
    std::vector<std::string> lines;
};

std::vector<Source> sources(const std::vector<std::string>& folders) {
    std::vector<Source> list;
    for (const std::string& folder : folders)
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(QUERN_SOURCE_DIR) / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".hpp" && extension != ".cpp") continue;
            Source source{fs::relative(entry.path(), QUERN_SOURCE_DIR).string(), {}};
            std::ifstream file(entry.path());
            for (std::string line; std::getline(file, line);) source.lines.push_back(line);
            list.push_back(std::move(source));
        }
    REQUIRE(!list.empty());
    return list;
}

std::string included(const std::string& line) {
    static const std::regex include("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*");
    std::smatch match;
    return std::regex_match(line, match, include) ? match[1].str() : std::string();
}

/// "path:line: text" of every line of the folders for which bad(line, path) holds.
template <class Bad>
std::string offenders(const std::vector<std::string>& folders, Bad&& bad) {
    std::ostringstream list;
    for (const Source& source : sources(folders))
        for (std::size_t i = 0; i < source.lines.size(); ++i)
            if (bad(source.lines[i], source.path))
                list << source.path << ':' << i + 1 << ": " << source.lines[i] << '\n';
    return list.str();
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](const std::string& beginning) { return text.rfind(beginning, 0) == 0; });
}

}  // namespace

TEST_CASE("Architecture: a lower room includes nothing of a higher one") {
    const auto upward = [](const std::string& folder, const std::vector<std::string>& higher) {
        return offenders({folder}, [&](const std::string& line, const std::string&) {
            const std::string header = included(line);
            return starts_with_any(header, higher) || header.rfind("../", 0) == 0;
        });
    };
    CHECK(upward("grid", {"particles/", "contact/", "src/", "tests/"}) == "");
    CHECK(upward("particles", {"contact/", "src/", "tests/"}) == "");
    CHECK(upward("contact", {"src/", "tests/"}) == "");
    CHECK(upward("src", {"tests/"}) == "");
    // Reading and writing know nothing of the simulation.
    CHECK(upward("src/deck", {"src/sim", "src/mesh", "src/results", "contact/"}) == "");
    CHECK(upward("src/mesh", {"src/sim", "src/results", "contact/"}) == "");
    CHECK(upward("src/import", {"src/sim", "contact/", "particles/"}) == "");
    CHECK(upward("src/results", {"src/sim", "src/mesh", "contact/", "particles/"}) == "");
    // Statistics of contacts know neither decks nor files.
    CHECK(upward("src/observe", {"src/sim", "src/deck", "src/mesh", "src/results", "src/study"}) == "");
    // Packings are tables of grains: decks and pictures are all they need.
    CHECK(upward("src/pack", {"src/sim", "src/mesh", "src/study", "contact/"}) == "");
    // Studies run the program, and know it by its files.
    CHECK(upward("src/study", {"src/sim", "src/mesh", "contact/", "particles/"}) == "");
}

TEST_CASE("Architecture: file formats, meshers and renderers stay in src, out of headers but their own") {
    const auto heavy = [](const std::string& header) {
        return std::regex_match(
            header, std::regex("(hdf5|H5).*\\.h|vtk[A-Z].*\\.h|gmsh.*|yaml-cpp/.*|CLI/.*|muParser.*"));
    };
    CHECK(offenders({"grid", "particles", "contact"}, [&](const std::string& line, const std::string&) {
              return heavy(included(line));
          }) == "");
}

TEST_CASE("Architecture: threads live in one file") {
    static const std::regex threads(
        "^\\s*#\\s*pragma\\s+omp\\s+(parallel|for|task|critical|atomic|sections|single|barrier).*");
    const auto bad = [](const std::string& line, const std::string& path) {
        return std::regex_match(line, threads) && path != "grid/parallel.hpp";
    };
    CHECK(offenders({"grid", "particles", "contact", "src"}, bad) == "");
    CHECK(offenders({"grid", "particles", "contact", "src"},
                    [](const std::string& line, const std::string& path) {
                        return included(line) == "omp.h" && path != "grid/parallel.hpp";
                    }) == "");
    // The rule finds what it looks for.
    CHECK(offenders({"grid"}, [](const std::string& line, const std::string&) {
              return std::regex_match(line, threads);
          }) != "");
}

TEST_CASE("Architecture: the libraries print nothing") {
    static const std::regex print("(^|.*[^a-z_:])(std::cout|std::cerr|printf|puts|fmt::print)\\b.*");
    CHECK(offenders({"grid", "particles", "contact"}, [](const std::string& line, const std::string&) {
              return std::regex_match(line, print);
          }) == "");
}

TEST_CASE("Architecture: a step can be read at one sight") {
    for (const Source& source : sources({"src/sim"})) {
        if (source.path != "src/sim/step.cpp") continue;
        const auto begin =
            std::find_if(source.lines.begin(), source.lines.end(),
                         [](const std::string& line) { return line.rfind("void kick(", 0) == 0; });
        REQUIRE(begin != source.lines.end());
        const auto end = std::find(begin, source.lines.end(), "}");
        CHECK(end - begin - 1 <= 30);
        CHECK(end - begin - 1 > 5);
    }
}

TEST_CASE("Architecture: files stay readable, nothing is left to do") {
    for (const Source& source : sources({"grid", "particles", "contact", "src", "tests"})) {
        CAPTURE(source.path);
        CHECK(source.lines.size() <= 600);
    }
    CHECK(offenders({"grid", "particles", "contact", "src"}, [](const std::string& line, const std::string&) {
              return std::regex_search(line, std::regex("\\b(TODO|FIXME|XXX|HACK)\\b"));
          }) == "");
}

}  // namespace quern::test
