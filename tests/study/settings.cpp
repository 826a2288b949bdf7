// Values of a sweep: splitting, quoting, combinations, names.
#include "src/study/settings.hpp"

#include <doctest/doctest.h>

#include "grid/error.hpp"

using namespace quern;

namespace {

using Texts = std::vector<std::string>;

std::string message_of(const std::string& text) {
    try {
        parse_swept(text, "--set");
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

TEST_CASE("Settings: commas part values, but not in quotes or brackets") {
    const auto values = [](const std::string& text) { return parse_swept("a=" + text, "--set").values; };
    CHECK(values("1") == Texts{"1"});
    CHECK(values(" 1, 2 ,3") == Texts{"1", "2", "3"});
    CHECK(values("[1, 0.5]") == Texts{"[1, 0.5]"});
    CHECK(values("[1, [2, 3]],[4, 5]") == Texts{"[1, [2, 3]]", "[4, 5]"});
    CHECK(values("{x: 1, y: 2}") == Texts{"{x: 1, y: 2}"});
    CHECK(values("'a, b',c") == Texts{"'a, b'", "c"});
    CHECK(values(R"("a\", b",c)") == Texts{R"("a\", b")", "c"});
    CHECK(values("min(1, 2),3") == Texts{"min(1, 2)", "3"});
    CHECK(values("${max(a, b)}") == Texts{"${max(a, b)}"});
    CHECK(values("45 deg") == Texts{"45 deg"});
    CHECK(parse_swept("params.mu = 1", "--set").key == "params.mu");
}

TEST_CASE("Settings: what is no list of values is an error that says so") {
    CHECK(contains(message_of("a"), "--set: got 'a', expected key=value"));
    CHECK(contains(message_of("=1"), "--set: got '=1'"));
    CHECK(contains(message_of("a="), "--set: a: got no value"));
    CHECK(contains(message_of("a=1,,2"), "empty piece"));
    CHECK(contains(message_of("a=1,"), "empty piece"));
    CHECK(contains(message_of("a=[1,2"), "a closing ]"));
    CHECK(contains(message_of("a='x,y"), "a closing '"));
    CHECK(contains(message_of("a=1,2,1"), "the value '1' twice"));
}

TEST_CASE("Settings: the product has every combination once, the last key fastest") {
    const std::vector<StudyCase> cases = product(
        {{"params.mu", {"0.1", "0.3"}}, {"time.end", {"2"}}, {"contact.rule", {"pair", "seed", "none"}}});
    REQUIRE(cases.size() == 6);
    CHECK(cases[0].name == "mu=0.1,rule=pair");
    CHECK(cases[1].name == "mu=0.1,rule=seed");
    CHECK(cases[5].name == "mu=0.3,rule=none");
    CHECK(cases[4].overrides == Texts{"params.mu=0.3", "time.end=2", "contact.rule=seed"});
    CHECK(cases[4].values == Texts{"0.3", "2", "seed"});
    CHECK(product({}).size() == 1);
    CHECK(product({{"a", {"1"}}})[0].name == "run");
    CHECK_THROWS_AS(product({{"a", {"1"}}, {"a", {"2"}}}), InputError);
}

TEST_CASE("Settings: names of folders are short, plain and different") {
    const std::vector<StudyCase> cases =
        product({{"materials.a.density", {"1", "2"}}, {"materials.b.density", {"[1, 2]", "[1; 2]"}}});
    CHECK(cases[0].name == "a.density=1,b.density=_1,_2_");
    CHECK(cases[1].name == "a.density=1,b.density=_1__2_");
    const std::vector<StudyCase> alike = product({{"a", {"x/y", "x y"}}});
    CHECK(alike[0].name == "a=x_y");
    CHECK(alike[1].name == "a=x_y+2");
    CHECK(folder_name("../x") == "_.._x");
    CHECK(folder_name("-x") == "_-x");
    CHECK(folder_name(std::string(500, 'x')).size() == 120);
}
