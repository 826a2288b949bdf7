// Reading runs back: tables, summary, values by name.
#include "src/study/run_values.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;

namespace {

const Columns history{{"time", "kinetic"}, {{0, 1, 2, 3}, {4, 8, std::nan(""), 3}}};

std::string message_of(const std::string& text, const Deck& deck) {
    try {
        RunValue(text, deck);
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL_CHECK("no error");
    return {};
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("RunValue: statistics of columns and formulas of them") {
    const Deck deck = read_text(plain_deck, {"output.track=all"});
    RunFiles run;
    run.history = history;
    run.grains[1] = Columns{{"time", "grain", "x"}, {{0, 1}, {1, 1}, {2, 5}}};
    const auto value = [&](const std::string& text) { return RunValue(text, deck).of(run); };
    CHECK(value("history.kinetic.first") == 4);
    CHECK(value("history.kinetic.last") == 3);
    CHECK(value("history.kinetic.min") == 3);
    CHECK(value("history.kinetic.max") == 8);
    CHECK(value("history.kinetic.mean") == 5);
    CHECK(value("grains.1.x.last") == 5);
    CHECK(value("(grains.1.x.last - grains.1.x.first)/history.time.last") == 1);
    CHECK(value("part = max(history.kinetic.last, 7)") == 7);
    CHECK(RunValue("part = history.kinetic.last", deck).name() == "part");
    CHECK(RunValue("history.kinetic.last", deck).name() == "history.kinetic.last");
    CHECK(std::isnan(value("grains.0.x.last")));       // no rows
    CHECK(std::isnan(value("1/history.time.first")));  // no number
}

TEST_CASE("RunValue: what a run does not write is named with the nearest") {
    const Deck deck = read_text(plain_deck, {"output.track=[1]"});
    CHECK(contains(message_of("history.kinetc.last", deck), "did you mean kinetic?"));
    CHECK(contains(message_of("history.kinetic.lst", deck), "did you mean last?"));
    CHECK(contains(message_of("grains.1.z.last", deck), "the unknown column 'z'"));
    CHECK(contains(message_of("grains.0.x.last", deck), "--set output.track='[0]'"));
    CHECK(contains(message_of("grains.2.x.last", deck), "a grain from 0 to 1"));
    CHECK(contains(message_of("grains.x.last", deck), "grains.NUMBER.COLUMN.STATISTIC"));
    CHECK(contains(message_of("history.kinetic", deck), "history.COLUMN.STATISTIC"));
    CHECK(contains(message_of("3", deck), "a formula of columns"));
    CHECK(contains(message_of("histoy.kinetic.last", deck), "--value"));
    CHECK(contains(message_of("history.time.last + foo", deck), "unknown name 'foo'"));
    CHECK(contains(message_of("history.time.last +", deck), "--value"));
    CHECK(contains(message_of("a =", deck), "nothing"));
}

TEST_CASE("read_columns: numbers under names, without a line that was never finished") {
    const TempFolder folder;
    const Columns columns = read_columns(folder.write("a.csv", "time,x\n0,1\n1e-3,nan\n2,-in"));
    CHECK(columns.names == std::vector<std::string>{"time", "x"});
    REQUIRE(columns.n_rows() == 2);
    CHECK((*columns.find("time"))[1] == 1e-3);
    CHECK(std::isnan((*columns.find("x"))[1]));
    CHECK(columns.find("y") == nullptr);
    CHECK_THROWS_AS(read_columns(folder.write("b.csv", "time,x\n0\n")), InputError);
    CHECK_THROWS_AS(read_columns(folder.write("c.csv", "") + ".none"), InputError);
    const auto grains =
        split_by_grain(read_columns(folder.write("d.csv", "time,grain,x\n0,3,1\n0,5,2\n1,3,7\n")));
    REQUIRE(grains.size() == 2);
    CHECK(*grains.at(3).find("x") == std::vector<double>{1, 7});
    CHECK(split_by_grain(columns).at(0).n_rows() == 2);
}

TEST_CASE("RunSummary: members by path, null and missing are no numbers") {
    const TempFolder folder;
    const std::string file = folder.write(
        "summary.json",
        R"({"outcome": "failed: \"x\"", "steps": 12, "energy": {"friction": 1.5e-3, "damping": null},
 "stages": {"kick": 1, "drift": 2}, "warnings": [{"text": "slow", "count": 3}, {"text": "steep", "count": 1}]})");
    const RunSummary summary(std::filesystem::path(file).parent_path().string());
    CHECK(summary.exists());
    CHECK(summary.text("outcome") == "failed: \"x\"");
    CHECK(summary.number("steps") == 12);
    CHECK(summary.number("energy.friction") == 1.5e-3);
    CHECK(std::isnan(summary.number("energy.damping")));
    CHECK(std::isnan(summary.number("energy.elastic")));
    CHECK(std::isnan(summary.number("outcome")));
    CHECK(summary.members("stages") ==
          std::vector<std::pair<std::string, double>>{{"kick", 1}, {"drift", 2}});
    CHECK(summary.n_warnings() == 4);
    CHECK(summary.warnings() == "slow (3 times); steep (1 times)");
    CHECK_FALSE(RunSummary(file + ".none").exists());
    folder.write("summary.json", "{\"outcome\": \"do");
    CHECK_FALSE(RunSummary(std::filesystem::path(file).parent_path().string()).exists());
}
