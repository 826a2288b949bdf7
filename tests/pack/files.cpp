// What `quern pack` leaves behind, also when the fraction is out of reach.
#include <doctest/doctest.h>

#include <sstream>

#include "grid/error.hpp"
#include "src/pack/pack.hpp"
#include "tests/pack/specs.hpp"

using namespace quern;

namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("pack: table, summary and picture") {
    const TempFolder folder;
    const std::filesystem::path spec = folder.write("spec.yaml", plain_spec);
    const std::filesystem::path out = spec.parent_path() / "new" / "grains.csv";
    const PackReport report = pack({spec.string(), out.string(), {"solid_fraction=0.7"}, false});
    CHECK(report.fraction == doctest::Approx(0.7).epsilon(1e-4));
    REQUIRE(report.files.size() == 3);
    CHECK(report.files[2] == (spec.parent_path() / "new" / "grains.png").string());
    const std::string table = text_of(out), summary = text_of(report.files[1]);
    CHECK(table.find("\nx,y,radius,shape,group\n") != std::string::npos);
    CHECK(std::count(table.begin(), table.end(), '\n') == report.n_grains + 2);
    CHECK(summary.find(fmt::format("\"n_grains\": {},", report.n_grains)) != std::string::npos);
    CHECK(summary.find("\"title\": \"Disks\"") != std::string::npos);
    CHECK(summary.find("\"reached\": true") != std::string::npos);
    CHECK(summary.find("\"groups\": {\"held\": ") != std::string::npos);
    CHECK(text_of(report.files[2]).substr(1, 3) == "PNG");
}

TEST_CASE("pack: a fraction out of reach is an error that keeps the packing") {
    const TempFolder folder;
    const std::filesystem::path spec = folder.write("spec.yaml", plain_spec);
    const std::filesystem::path out = spec.parent_path() / "grains.csv";
    CHECK_THROWS_WITH_AS(pack({spec.string(), out.string(), {"solid_fraction=0.97", "rounds=2"}, false}),
                         doctest::Contains("reached, 0.9700 asked for, after 2 rounds; the packing of 0.8"),
                         SimulationError);
    CHECK(text_of(spec.parent_path() / "grains.json").find("\"reached\": false") != std::string::npos);
    CHECK(text_of(out).find("x,y,radius") != std::string::npos);
    CHECK_THROWS_WITH_AS(pack({spec.string(), "grains.txt", {}, false}), doctest::Contains("ends in .csv"),
                         InputError);
}
