// Which grains are evaluated together, and that nobody can tell.
#include "src/sim/force_plan.hpp"

#include <set>

#include "tests/sim/scenes.hpp"

namespace quern::test {

namespace {

float largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    float most = 0.0f;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

}  // namespace

TEST_CASE("Force plan: every grain once; alike ones in batches, similar ones in unions, the bar alone") {
    const auto scene = scene_of<2>(unequal_deck);
    std::multiset<int> seen;
    std::vector<int> unions, batches, alone;
    for (const ForceTask& task : scene->force_tasks) {
        seen.insert(task.grain.begin(), task.grain.begin() + task.size);
        (task.union_batch >= 0 ? unions : task.alone ? alone : batches).push_back(task.size);
    }
    CHECK(seen.size() == 21);
    CHECK(std::set<int>(seen.begin(), seen.end()).size() == 21);
    CHECK(unions == std::vector<int>{8, 8});
    CHECK(batches == std::vector<int>{4});
    CHECK(alone == std::vector<int>{1});
    for (const std::string kernel : {"single", "reference"}) {
        const auto plain = scene_of<2>(unequal_deck, {"compute.kernel=" + kernel});
        CHECK(plain->unions.empty());
        CHECK(plain->force_tasks.size() == 21);
    }
}

TEST_CASE(
    "Force plan: unions break the bonds that single grains break, and report the same energies and fields") {
    for (const std::string model : {"lps", "peridem"}) {
        CAPTURE(model);
        const std::string law = "materials.rubber.model=" + model;
        const auto together = scene_of<2>(unequal_deck, {law}),
                   single = scene_of<2>(unequal_deck, {law, "compute.kernel=single"});
        const Outcome a = advance(*together, 150), b = advance(*single, 150);
        CHECK(together->n_bonds == single->n_bonds);
        CHECK(a.newly_broken == b.newly_broken);
        CHECK(b.newly_broken > 50);
        CHECK(std::abs(a.fracture / b.fracture - 1.0) < 1e-9);  // measured 2.0e-13, bound 1e-9
        CHECK(std::abs(a.elastic / b.elastic - 1.0) < 1e-9);    // measured 3.7e-13, bound 1e-9
        CHECK(a.frame.damage == b.frame.damage);
        CHECK(*std::max_element(b.frame.damage.begin(), b.frame.damage.end()) > 0.1);
        const float largest = *std::max_element(b.frame.stress.begin(), b.frame.stress.end());
        // measured 0 to 6e-8, the rounding of 32 bits; bound 2e-7
        CHECK(largest_difference(a.frame.stress, b.frame.stress) < 2e-7f * largest);
        CHECK(*std::max_element(b.frame.damage_z.begin(), b.frame.damage_z.end()) > 1.0f);
        CHECK(largest_difference(a.frame.damage_z, b.frame.damage_z) < 1e-6f);  // measured 6e-13, bound 1e-6
    }
}

}  // namespace quern::test
