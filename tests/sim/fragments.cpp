// Grains that are broken along a given crack: what their halves and their debris do afterwards.
#include "src/sim/fragments.hpp"

#include <cmath>
#include <random>

#include "grid/parallel.hpp"
#include "particles/pieces.hpp"
#include "src/sim/checkpoint.hpp"
#include "src/sim/observe.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

/// A bar of 2 m by 0.6 m, cut in a test, and the same as two grains.
const std::string bar_deck = R"yaml(title: bar
params: {angle: 0, friction: 0}
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, critical_stretch: 1}
shapes:
  bar: {type: rectangle, size: [2, 0.6], spacing: 0.1}
  half: {type: rectangle, size: [1, 0.6], spacing: 0.1}
grid: {origin: [0, 0], extent: [6, 6], spacing: 0.2}
contact: {friction: "${friction}"}
time: {end: 0.1}
)yaml";
const std::string one_bar = bar_deck +
                            "grains: [{shape: bar, material: rubber, position: [3.03, 3.07], angle: "
                            "\"${angle}\"}]\n";
const std::string two_halves = bar_deck + R"yaml(grains:
  - {shape: half, material: rubber, position: ["${3.03 - 0.5*cos(angle)}", "${3.07 - 0.5*sin(angle)}"], angle: "${angle}"}
  - {shape: half, material: rubber, position: ["${3.03 + 0.5*cos(angle)}", "${3.07 + 0.5*sin(angle)}"], angle: "${angle}"}
)yaml";

/// A scene that is stepped by hand.
struct Stepped {
    Stepped(const std::string& text, const std::vector<std::string>& overrides) {
        const TempFolder folder;
        const Deck deck = read_deck(folder.write("deck.yaml", text), overrides);
        scene = make_scene<2>(deck);
        now = make_context(*scene, 0.5 * scene->stable_step());
    }
    const Vec<2>& X(int p) const { return scene->grains[0].shape->X[p]; }
    /// Breaks all bonds of grain 0 between nodes of different sides.
    template <class Side>
    void cut(Side&& side) {
        cut_bonds([&](int i, int j) { return side(X(i)) != side(X(j)); });
    }
    /// Breaks the bonds (i, j) of grain 0 that `breaks` names.
    template <class Breaks>
    void cut_bonds(Breaks&& breaks) {
        const BondBytes& bytes = scene->bond_bytes[0];
        const std::span<std::uint8_t> alive = scene->alive_of(0);
        std::visit(
            [&](const auto& model) {
                const Bonds<2>& bonds = model.bonds();
                for (int i = 0; i < bonds.n_nodes(); ++i)
                    for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b)
                        if (breaks(i, bonds.partner[b]))
                            alive[static_cast<std::size_t>(bytes.place ? bytes.place[b] : b)] &=
                                static_cast<std::uint8_t>(~(1U << bytes.bit));
            },
            scene->groups[0].model);
        scene->torn[0] = 1;
        update_fragments(*scene, now);
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) {
            kick(*scene, now);
            if (now.first) observer.start(*scene, now);
            if (now.first) observer.history(*scene, now);
            drift(*scene, now);
        }
        kick(*scene, now);
        last = observer.history(*scene, now);
    }
    double kinetic() const {
        double T = 0.0;
        for (int p = 0; p < scene->particles.size(); ++p)
            T += 0.5 * scene->particles.mass[p] * scene->particles.v[p].squaredNorm();
        return T;
    }
    /// Momentum of the particles that were on the right, over their mass.
    Vec<2> right(const Vec<2>& along) const {
        Vec<2> P = Vec<2>::Zero();
        double m = 0.0;
        for (int p = 0; p < scene->particles.size(); ++p)
            if (along.dot(scene->x_start[p] - Vec<2>(3.03, 3.07)) > 0.0) {
                P += scene->particles.mass[p] * scene->particles.v[p];
                m += scene->particles.mass[p];
            }
        return P / m;
    }
    void send(const Vec<2>& along, const Vec<2>& velocity) {
        for (int p = 0; p < scene->particles.size(); ++p)
            scene->particles.v[p] =
                along.dot(scene->x_start[p] - Vec<2>(3.03, 3.07)) > 0.0 ? velocity : Vec<2>(-velocity);
    }

    std::unique_ptr<Scene<2>> scene;
    StepContext<2> now;
    Observer<2> observer;
    HistoryRow last;
};

const auto in_two = [](const Vec<2>& X) { return X[0] > 0.0 ? 1 : 0; };
const std::vector<std::string> rules = {"contact.rule=pair", "contact.rule=surface"};

}  // namespace

TEST_CASE("Fragments: halves that separate fly on as if there were no contact, with their kinetic energy") {
    for (const std::string& rule : rules) {
        CAPTURE(rule);
        std::vector<Vec<2>> x;
        for (const std::string& contact : {rule, std::string("contact.rule=none")}) {
            Stepped bar(one_bar, {contact, "params.angle=0.3"});
            const Vec<2> along(std::cos(0.3), std::sin(0.3));
            bar.cut(in_two);
            bar.send(along, along + 0.3 * Vec<2>(-along[1], along[0]));
            const double T = bar.kinetic();
            bar.run(300);
            CHECK(bar.scene->fragments.all.size() == 2);
            CHECK(bar.kinetic() == doctest::Approx(T).epsilon(1e-12));  // measured 1e-15, bound 1e-12
            if (x.empty())
                x = bar.scene->particles.x;
            else
                CHECK(x == bar.scene->particles.x);
        }
    }
}

TEST_CASE("Fragments: halves that are sent together bounce as two grains of their shape, in any frame") {
    for (const std::string& rule : rules)
        for (const std::string angle : {"0", "0.4"}) {
            CAPTURE(rule);
            CAPTURE(angle);
            const double a = std::stod(angle);
            const Vec<2> along(std::cos(a), std::sin(a));
            double rebound[2];
            for (const bool broken : {true, false}) {
                Stepped bar(broken ? one_bar : two_halves, {rule, "params.angle=" + angle});
                if (broken) bar.cut(in_two);
                bar.send(along, -0.5 * along);
                const double T = bar.kinetic();
                bar.run(400);
                rebound[broken ? 0 : 1] = bar.right(along).dot(along) / 0.5;
                CHECK(bar.kinetic() < T);
                CHECK(std::abs(bar.last.energy.residual) < 2e-3 * T);  // measured 1e-4 of it
                CHECK(std::hypot(bar.last.momentum[0], bar.last.momentum[1]) < 1e-9);
            }
            CHECK(rebound[0] > 0.5);
            // Flat faces that hit all at once; measured 0.80 to 0.85 and 0.64 to 0.79. A piece has the bonds
            // of the whole, softer at the cut than a grain of its own, whose families know of the face: with
            // bond-based ones, alike in both, rule pair differs by 0.03 either way, not by 0.05 to 0.10. Rule
            // surface has 0.86 and 0.71 even so: there contact takes 0.11 and 0.28 of the energy.
            CHECK(std::abs(rebound[0] - rebound[1]) < 0.25);
        }
}

TEST_CASE("Fragments: the larger part stays the parent, later ones are born with parent, step and time") {
    Stepped bar(one_bar, {});
    const auto three = [](const Vec<2>& X) { return X[0] > 0.5 ? 2 : X[0] > 0.2 ? 1 : 0; };
    bar.cut([](const Vec<2>& X) { return X[0] > 0.2 ? 1 : 0; });
    bar.run(7);
    bar.cut(three);
    const std::vector<Fragment>& all = bar.scene->fragments.all;
    REQUIRE(all.size() == 3);
    CHECK(all[0].particles == 72);
    CHECK(all[1].particles == 30);  // 5 of 8 columns
    CHECK(all[2].particles == 18);
    CHECK(all[0].parent == -1);
    CHECK(all[1].parent == 0);
    CHECK(all[2].parent == 1);
    CHECK(all[1].step == 0);
    CHECK(all[2].step == 7);
    CHECK(all[2].born == doctest::Approx(7 * bar.now.dt));
    for (int p = 0; p < bar.scene->particles.size(); ++p) {
        const int expected[] = {0, 2, 1};
        CHECK(bar.scene->fragments.of_particle[p] == expected[three(bar.X(p))]);
    }
    Frame frame;
    make_frame(*bar.scene, bar.now, frame);
    const std::vector<FragmentRow> rows = fragment_rows(*bar.scene, bar.now, frame);
    CHECK(rows[1].mass == doctest::Approx(0.25 * bar.scene->grains[0].mass));
    CHECK(rows[1].position[0] == doctest::Approx(3.03 + 0.75));
    CHECK(rows[2].damage > 0.1);
    CHECK(rows[2].damage < 0.5);
}

TEST_CASE("Fragments: bonds that break a few at a time leave the fragments that a search at once finds") {
    Stepped bar(one_bar, {});
    std::mt19937 random(11);
    std::size_t most = 1;
    for (int round = 0; round < 25; ++round) {
        bar.cut_bonds([&](int, int) { return random() % 100 < 9; });
        const Fragments& fragments = bar.scene->fragments;
        std::vector<int> piece;
        int n = 0;
        std::visit(
            [&](const auto& model) { n = find_pieces<2>(model.bonds(), bar.scene->view(0).alive, piece); },
            bar.scene->groups[0].model);
        CHECK(fragments.all.size() == static_cast<std::size_t>(n));
        CHECK(fragments.broken[0] == static_cast<std::int64_t>(bar.scene->broken_bonds(0).size()));
        std::vector<int> of_piece(static_cast<std::size_t>(n), -1);
        for (std::size_t p = 0; p < piece.size(); ++p) {
            int& name = of_piece[static_cast<std::size_t>(piece[p])];
            if (name < 0) name = fragments.of_particle[p];
            CHECK(name == fragments.of_particle[p]);
        }
        most = std::max(most, fragments.all.size());
    }
    CHECK(most > 10);  // measured 24, of 120 particles
}

TEST_CASE("Fragments: a bar cut in two from the start is two at once, and does not close through itself") {
    const std::string press =
        "loads: [{region: x < 3.03, acceleration: [20, 0]}, {region: x > 3.03, acceleration: [-20, 0]}]\n";
    const auto side = [](const Vec<2>& X) { return X[0] > 0.0 ? 1.0 : -1.0; };
    for (const std::string contact : {"rule: pair", "rule: surface", "method: node_pair", "rule: none"}) {
        CAPTURE(contact);
        for (const double top : {1.0, 0.1}) {  // cut through, or to two thirds
            Stepped bar(replaced(one_bar, "contact: {", "contact: {" + contact + ", ") + press +
                            fmt::format("cracks: [{{frame: shape, from: [0, -1], to: [0, {}]}}]\n", top),
                        {});
            const bool through = top == 1.0;
            const std::vector<Fragment>& all = bar.scene->fragments.all;
            CHECK(all.size() == (through ? 2U : 1U));
            CHECK(all.back().parent == (through ? 0 : -1));
            CHECK(all.back().particles == (through ? 60 : 120));
            bar.run(150);
            CHECK(bar.last.broken_bonds == 0);
            double nearest = 1.0;  // along the bar, of what stands at the crack
            for (int p = 0; p < bar.scene->particles.size(); ++p)
                for (int q = 0; q < bar.scene->particles.size(); ++q)
                    if (side(bar.X(p)) < side(bar.X(q)) && std::abs(bar.X(p)[1] - bar.X(q)[1]) < 0.01 &&
                        bar.X(p)[1] < top)
                        nearest =
                            std::min(nearest, bar.scene->particles.x[q][0] - bar.scene->particles.x[p][0]);
            CAPTURE(nearest);
            if (contact == "rule: none")
                CHECK(nearest < 0.0);  // measured -0.61 and -0.20
            else
                CHECK(nearest > 0.08);  // measured 0.094 to 0.095, bound 0.08
        }
    }
}

TEST_CASE("Fragments: a scene that is loaded goes on with the same bits, on one thread or two") {
    const auto in_pieces = [](const Vec<2>& X) {  // halves, and a corner that is debris
        return X[0] > 0.7 && X[1] > 0.0 ? 2 : X[0] > 0.0 ? 1 : 0;
    };
    for (const std::string& rule : rules) {
        CAPTURE(rule);
        const auto begin = [&] {
            Stepped bar(one_bar, {rule, "params.friction=0.3"});
            bar.cut(in_pieces);
            bar.send({1.0, 0.0}, {-0.5, 0.2});
            for (int p = 0; p < bar.scene->particles.size(); ++p)
                if (in_pieces(bar.X(p)) == 2) bar.scene->particles.v[p] = {-2.0, -1.0};
            for (int i = 0; i < 60; ++i) {
                kick(*bar.scene, bar.now);
                drift(*bar.scene, bar.now);
            }
            return bar;
        };
        Stepped first = begin();
        CHECK(first.scene->fragments.n_debris() == 1);
        Checkpoint saved;
        pass_state(saved, *first.scene, first.now);
        Stepped second(one_bar, {rule, "params.friction=0.3"});
        second.now.dt = first.now.dt;
        Checkpoint loaded(saved.items(), "test");
        pass_state(loaded, *second.scene, second.now);
        CHECK(second.scene->fragments.of_particle == first.scene->fragments.of_particle);
        CHECK(second.scene->fragments.all.size() == 3);
        parallel::set_threads(2);
        for (int i = 0; i < 60; ++i)
            for (Stepped* bar : {&first, &second}) {
                kick(*bar->scene, bar->now);
                drift(*bar->scene, bar->now);
            }
        parallel::set_threads(1);
        CHECK(state_hash(*first.scene) == state_hash(*second.scene));
        Stepped alone = begin();
        for (int i = 0; i < 60; ++i) {
            kick(*alone.scene, alone.now);
            drift(*alone.scene, alone.now);
        }
        CHECK(state_hash(*first.scene) == state_hash(*alone.scene));
    }
}

TEST_CASE("Fragments: a loose particle that is thrown at its grain and a wall goes through neither") {
    for (const std::string& rule : {std::string("contact.rule=pair"), std::string("contact.rule=surface"),
                                    std::string("contact.coupling=flip")}) {
        CAPTURE(rule);
        const std::string walled = one_bar + "walls: [{name: roof, point: [3, 3.9], normal: [0, -1]}]\n";
        Stepped bar(walled, {rule});
        const auto loose = [](const Vec<2>& X) { return X[1] > 0.2 && std::abs(X[0] - 0.05) < 0.04 ? 1 : 0; };
        int p = 0;
        while (loose(bar.X(p)) == 0) ++p;
        bar.cut(loose);
        CHECK(bar.scene->fragments.n_debris() == 1);
        bar.scene->particles.x[p][1] += 0.2;
        bar.scene->particles.v[p] = Vec<2>(0.05, -3.0);
        const double T = bar.kinetic();
        bar.run(400);
        const double y = bar.scene->particles.x[p][1] - 3.07;
        CHECK(y > 0.2);
        CHECK(y < 0.83);
        CHECK(bar.kinetic() < 1.0001 * T);
        CHECK(bar.kinetic() > 0.01 * T);
        CHECK(std::abs(bar.last.energy.residual) < 0.02 * T);
        bar.scene->particles.v[p] = Vec<2>(0.0, 3.0);
        if (!bar.scene->arrays.drift.empty()) bar.scene->arrays.drift[p] = bar.scene->particles.v[p];
        bar.run(400);
        CHECK(bar.scene->particles.x[p][1] < 3.9);
    }
}

}  // namespace quern::test
