// Observed runs: forces that are known, stress against walls, profiles, files.
#include "src/sim/observation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "src/results/hdf5_handle.hpp"
#include "src/study/run_files.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

using Row = std::map<std::string, double>;

/// Rows of a table of one frame of a run (-1: the last), by the names of its columns.
std::vector<Row> table(const RunRecord& record, const std::string& deck, const std::string& name,
                       int frame = -1) {
    const TempFolder folder;
    const std::vector<TableLayout> layouts = observed_layouts(read_deck(folder.write("deck.yaml", deck)));
    std::vector<Row> rows;
    const auto& tables =
        frame < 0 ? record.observed.back() : record.observed[static_cast<std::size_t>(frame)];
    for (std::size_t t = 0; t < layouts.size(); ++t) {
        if (layouts[t].name != name) continue;
        const std::size_t n = layouts[t].columns.size();
        REQUIRE(tables[t].size() % n == 0);
        for (std::size_t i = 0; i < tables[t].size(); i += n) {
            rows.emplace_back();
            for (std::size_t c = 0; c < n; ++c) rows.back()[layouts[t].columns[c].name] = tables[t][i + c];
        }
    }
    return rows;
}

struct Way {
    std::string name, contact;
};
const std::vector<Way> ways = {
    {"pair", "{method: grid, rule: pair"},
    {"surface", "{method: grid, rule: surface"},
    {"pair + flip", "{method: grid, coupling: flip"},
    {"node_pair", "{method: node_pair, node_pair: {damping: nodes, restitution: 0.5}"},
};

/// Four disks in a box of 2 m under a lid that presses with 20 kN/m; `n` particles a radius.
std::string four_disks(const std::string& contact, int n) {
    return replaced(plane_deck, "n: 6", fmt::format("n: {}", n)) + "time: {end: 1, safety: 0.5}\n" +
           "damping: {mass: 20}\noutput: {interval: 0.5}\nobserve: {}\ncontact: " + contact +
           ", friction: 0.3}\n" +
           R"yaml(walls:
  - {name: left, point: [0, 0], normal: [1, 0]}
  - {name: right, point: [2, 0], normal: [-1, 0]}
  - {name: floor, point: [0, 0], normal: [0, 1]}
  - {name: lid, point: [0, 2.002], normal: [0, -1], servo: {force: 2e4, damping: 20}}
grains:
  - {shape: disk, material: rubber, array: {counts: [2, 2], origin: [0.5, 0.5], step: [1, 1]}}
)yaml";
}

}  // namespace

TEST_CASE("Observation: two disks pressed together press with the force that drives them") {
    // Body forces of 10 m/s^2 towards each other, in the plane and in space, and across a periodic face.
    for (const Way& way : ways)
        for (const bool periodic : {false, true}) {
            if (periodic && way.name == "pair + flip") continue;
            CAPTURE(way.name);
            CAPTURE(periodic);
            std::string text = plane_deck;
            if (periodic) text = replaced(text, "extent: [6, 4]", "extent: [6, 4], periodic: [x]");
            const double x0 = periodic ? 0.49 : 2.5, x1 = periodic ? 5.491 : 3.499;
            text += "time: {end: 0.4}\ndamping: {mass: 60}\noutput: {interval: 0.4}\nobserve: {}\ncontact: " +
                    way.contact + "}\n" +
                    fmt::format(
                        "loads: [{{grains: [0], acceleration: [{}, 0]}}, {{grains: [1], acceleration: "
                        "[{}, 0]}}]\n",
                        periodic ? -10 : 10, periodic ? 10 : -10) +
                    fmt::format(
                        "grains:\n  - {{shape: disk, material: rubber, position: [{}, 2]}}\n  - {{shape: "
                        "disk, material: rubber, position: [{}, 2]}}\n",
                        x0, x1);
            const RunRecord record = run_text(text);
            const std::vector<Row> contacts = table(record, text, "contacts");
            REQUIRE(contacts.size() == 1);
            Row contact = contacts[0];
            const std::vector<Row> grains = table(record, text, "grain_stress");
            const double expected = 3000.0 * grains[0].at("volume") * 10.0;
            // Measured 1.7e-5, 4.2e-4, 3.4e-5, 8.6e-4, bound 2e-3: what still moves after 0.4 s.
            CHECK(contact["fn"] == doctest::Approx(expected).epsilon(2e-3));
            CHECK(contact["first"] == 0);
            CHECK(contact["second"] == 1);
            CHECK(contact["nx"] ==
                  doctest::Approx(periodic ? -1.0 : 1.0).epsilon(1e-4));  // measured 2.7e-5, bound 1e-4
            CHECK(std::abs(contact["fty"]) < 1e-12 * expected);           // measured 1.3e-19, bound 1e-12
            const double between = periodic ? grains[1].at("x") - grains[0].at("x") - 6.0
                                            : grains[1].at("x") - grains[0].at("x");
            CHECK(contact["lx"] == doctest::Approx(between).epsilon(1e-9));
            for (const Row& grain : grains) {
                CHECK(grain.at("contacts") == 1);
                CHECK(grain.at("rattler") == 1);
                const double lever = 0.5 * std::abs(between);
                CHECK(grain.at("stress_xx") ==
                      doctest::Approx(-contact["fn"] * lever / grain.at("volume")).epsilon(1e-3));
            }
        }
}

TEST_CASE("Observation: material points press with the impulses of all rounds of contact") {
    const std::string text =
        replaced(plane_deck, "rubber: {density", "rubber: {model: material_points, density") +
        R"yaml(time: {end: 0.4}
damping: {mass: 60}
output: {interval: 0.4, history_interval: 0.1, track: all}
observe: {}
contact: {rule: pair}
loads: [{grains: [0], acceleration: [10, 0]}, {grains: [1], acceleration: [-10, 0]}]
grains:
  - {shape: disk, material: rubber, position: [2.5, 2]}
  - {shape: disk, material: rubber, position: [3.499, 2]}
)yaml";
    const RunRecord record = run_text(text);
    const std::vector<Row> contacts = table(record, text, "contacts");
    REQUIRE(contacts.size() == 1);
    const double expected = 3000.0 * table(record, text, "grain_stress")[0].at("volume") * 10.0;
    CHECK(contacts[0].at("fn") == doctest::Approx(expected).epsilon(0.02));  // measured 0.013, bound 0.02
}

TEST_CASE("Observation: the stress of a box is the pressure on its walls") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        const std::string text = four_disks(way.contact, 6);
        const RunRecord record = run_text(text);
        const std::vector<Row> contacts = table(record, text, "contacts");
        Row region = table(record, text, "regions").at(0);
        double on_lid = 0.0, on_right = 0.0, height = 0.0;
        for (const Row& contact : contacts) {
            if (contact.at("wall") == 3) on_lid += contact.at("fn"), height = contact.at("y");
            if (contact.at("wall") == 1) on_right += contact.at("fn");
        }
        const double width = 2.0;
        // Exact in equilibrium; what the last motion leaves: yy measured 7.4e-5, 1.1e-4, 1.0e-3, 5.3e-5,
        // bound 3e-3; xx measured 3.5e-5, 6.3e-3, 8.2e-4, 3.7e-4, bound 0.02.
        CHECK(region["stress_yy"] == doctest::Approx(-on_lid / width).epsilon(3e-3));
        CHECK(region["stress_xx"] == doctest::Approx(-on_right / height).epsilon(0.02));
        CHECK(on_lid == doctest::Approx(2e4).epsilon(3e-3));   // measured 6.5e-4, bound 3e-3
        CHECK(std::abs(region["stress_xy"]) < 2e-3 * on_lid);  // measured 4.1e-4, bound 2e-3
        CHECK(region["grains"] == 4);
        CHECK(region["solid_fraction"] == doctest::Approx(std::acos(-1.0) / (2.0 * height)).epsilon(1e-3));
        CHECK(region["volume"] == doctest::Approx(2.0 * height).epsilon(1e-3));
        // The lid's reaction of the last row is a mean since the row before.
        for (const ReactionRow& reaction : record.summary.reactions)
            if (reaction.name == "lid") CHECK(reaction.force[1] == doctest::Approx(on_lid).epsilon(0.02));
    }
}

TEST_CASE("Observation: stress by contacts and by particles agree the better the finer the grains") {
    double off[2];
    for (const int k : {0, 1}) {
        const std::string text = four_disks(ways[0].contact, k == 0 ? 6 : 12);
        const RunRecord record = run_text(text);
        Row region = table(record, text, "regions").at(0);
        off[k] = std::abs(region["particle_stress_yy"] / region["stress_yy"] - 1.0);
    }
    CHECK(off[0] < 0.1);           // measured 0.067, bound 0.1
    CHECK(off[1] < 0.05);          // measured 0.031, bound 0.05
    CHECK(off[1] < 0.6 * off[0]);  // first order in the spacing
}

TEST_CASE("Observation: regions count what lies in them, profiles show a linear shear") {
    // Layers of disks that move along x as fast as they are high and turn with the shear.
    std::string text = replaced(plane_deck, "extent: [6, 4]", "extent: [6, 6], periodic: [x]") +
                       R"yaml(time: {end: 1e-5}
walls: [{side: y-}, {side: y+}]
observe:
  regions:
    lower: {from: [0, 0], to: [6, 2.25]}
    round: {where: "(x - 3)^2 + (y - 3)^2 < 4"}
    slot: {from: [2, 0], to: [2.5, 6], where: "y < 3"}
  profiles:
    height: {axis: y, bins: 5, from: 0.5, to: 5.5}
    across: {axis: x, bins: 12}
grains:
)yaml";
    for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 6; ++i)
            text += fmt::format(
                "  - {{shape: disk, material: rubber, position: [{}, {}], velocity: [{}, 0], spin: "
                "-0.5}}\n",
                0.2 + i, 1.0 + j, 0.7 * (1.0 + j));
    const RunRecord record = run_text(text);
    const double disk = std::acos(-1.0) / 4.0;
    const std::vector<Row> regions = table(record, text, "regions", 0);
    REQUIRE(regions.size() == 4);
    CHECK(regions[0].at("solid_volume") == doctest::Approx(30.0 * disk).epsilon(1e-12));
    CHECK(regions[0].at("volume") == doctest::Approx(36.0));
    CHECK(regions[0].at("grains") == 30);
    CHECK(regions[1].at("grains") == 12);
    CHECK(regions[1].at("volume") == doctest::Approx(13.5));
    // Of a disk with its centre at 2, what lies below 2.25:
    const double below = disk - (0.25 * std::acos(0.5) - 0.25 * std::sqrt(0.25 - 0.0625));
    // Measured 7.9e-4, bound 5e-3.
    CHECK(regions[1].at("solid_volume") == doctest::Approx(6.0 * (disk + below)).epsilon(5e-3));
    CHECK(regions[2].at("volume") ==
          doctest::Approx(4.0 * std::acos(-1.0)).epsilon(4e-3));  // measured 2.0e-4, bound 4e-3
    CHECK(regions[3].at("volume") == doctest::Approx(1.5));

    std::vector<Row> height, across;
    for (const Row& row : table(record, text, "profiles", 0))
        (row.at("profile") == 0 ? height : across).push_back(row);
    REQUIRE(height.size() == 5);
    for (const Row& row : height) {
        const double y = 0.5 * (row.at("from") + row.at("to"));
        // Turning disks that no face cuts: measured 2.4e-15, 1.0e-15, 4.1e-15, bound 1e-12.
        CHECK(row.at("vx") == doctest::Approx(0.7 * y).epsilon(1e-12));
        CHECK(row.at("omega") == doctest::Approx(-0.5).epsilon(1e-12));
        CHECK(row.at("solid_fraction") == doctest::Approx(disk).epsilon(1e-12));
        CHECK(std::abs(row.at("uy")) < 1e-12);
    }
    REQUIRE(across.size() == 12);
    double sum = 0.0;
    for (const Row& row : across) sum += row.at("solid_fraction") * 0.5 * 6.0;
    CHECK(sum == doctest::Approx(30.0 * disk).epsilon(1e-12));  // what sticks out comes in on the other side
    const std::vector<Row> later = table(record, text, "profiles");
    for (const Row& row : later)
        if (row.at("profile") == 0) CHECK(row.at("ux") == doctest::Approx(1e-5 * row.at("vx")).epsilon(1e-3));
}

TEST_CASE("Observation: the contacts of a grain sum to its force in grains.csv, while grains break, too") {
    for (const char* contact : {"contact: {friction: 0.3}", "contact: {rule: surface, friction: 0.3}",
                                "contact: {method: node_pair, friction: 0.3}"}) {
        CAPTURE(std::string(contact));
        const std::string text =
            replaced(unequal_deck, "contact: {friction: 0.3}", contact) + "observe: {}\n";
        // A row each step: the force of a row is that of its step.
        const RunRecord record = run_text(text, {"output.track=all", "output.history_interval=1e-9"});
        CHECK(record.history.back().broken_bonds > 0);
        const std::size_t n = static_cast<std::size_t>(record.summary.n_grains);
        std::vector<std::array<double, 2>> sums(n);
        double scale = 0.0;
        for (const Row& row : table(record, text, "contacts")) {
            for (std::size_t a = 0; a < 2; ++a) {
                const std::string axis(1, "xy"[a]);
                const double force = row.at("fn") * row.at("n" + axis) + row.at("ft" + axis);
                sums[static_cast<std::size_t>(row.at("first"))][a] -= force;
                if (row.at("second") >= 0) sums[static_cast<std::size_t>(row.at("second"))][a] += force;
            }
            scale += row.at("fn");
        }
        double worst = 0.0;
        for (std::size_t k = 0; k < n; ++k) {
            const GrainRow& row = record.grains[record.grains.size() - n + k];
            const auto& sum = sums[static_cast<std::size_t>(row.grain)];
            worst = std::max(worst, std::hypot(sum[0] - row.force[0], sum[1] - row.force[1]));
        }
        CHECK(scale > 0.0);
        CHECK(worst < 1e-9 * scale);  // measured 7.3e-16, 1.3e-15, 6.3e-17, bound 1e-9
    }
}

TEST_CASE("Observation: in space a ball on the floor presses with its weight") {
    for (const char* contact :
         {"{method: grid}", "{method: node_pair, node_pair: {damping: nodes, restitution: 0.5}}"}) {
        CAPTURE(std::string(contact));
        const std::string text = space_deck + R"yaml(time: {end: 0.4}
damping: {mass: 60}
gravity: [0, 0, -9.8]
walls: [{side: z-, friction: 0.3}]
output: {interval: 0.4}
observe: {profiles: {up: {axis: z, bins: 4}}}
grains: [{shape: ball, material: rubber, position: [2, 2, 0.498]}]
contact: )yaml" + std::string(contact) +
                                 "\n";
        const RunRecord record = run_text(text);
        std::vector<Row> contacts = table(record, text, "contacts"),
                         grains = table(record, text, "grain_stress");
        REQUIRE(contacts.size() == 1);
        const double weight = 3000.0 * 9.8 * grains[0]["volume"];
        CHECK(contacts[0]["fn"] ==
              doctest::Approx(weight).epsilon(0.01));  // measured 3.5e-7, 7.7e-3, bound 0.01
        CHECK(contacts[0]["nz"] == doctest::Approx(-1.0));
        CHECK(contacts[0]["lz"] == doctest::Approx(-grains[0]["z"]).epsilon(0.02));
        CHECK(grains[0]["stress_zz"] ==
              doctest::Approx(-contacts[0]["fn"] * grains[0]["z"] / grains[0]["volume"]).epsilon(0.02));
        double solid = 0.0;
        for (const Row& row : table(record, text, "profiles")) solid += row.at("solid_fraction") * 16.0;
        // What sticks out through the floor counts for nothing: measured 0, 2.4e-4, bound 1e-3.
        CHECK(solid == doctest::Approx(grains[0]["volume"]).epsilon(1e-3));
    }
}

TEST_CASE("Observation: a run has the same bits with and without it, and on any number of threads") {
    for (const char* contact : {"contact: {friction: 0.3}", "contact: {method: node_pair, friction: 0.3}",
                                "contact: {rule: seed, friction: 0.3}"}) {
        const std::string text = replaced(unequal_deck, "contact: {friction: 0.3}", contact);
        const RunRecord plain = run_text(text), seen = run_text(text + "observe: {}\n");
        const RunRecord again = run_text(text + "observe: {}\n", {}, 2);
        CHECK(plain.summary.state_hash == seen.summary.state_hash);
        CHECK(plain.observed.empty());
        CHECK(seen.observed.size() == 3);
        CHECK(seen.observed.back()[0].size() > 100);
        CHECK(seen.observed.back()[0] == again.observed.back()[0]);
        CHECK(seen.observed.back()[1] == again.observed.back()[1]);
    }
}

TEST_CASE("Observation: results.h5 and the tables in CSV hold the same numbers") {
    const TempFolder folder;
    const std::string file = folder.write("deck.yaml", four_disks(ways[0].contact, 6) + "\n");
    RunOptions options;
    options.directory = file + ".out";
    options.threads = 1;
    RunRecord record;
    run_deck(read_deck(file), options, &record);
    REQUIRE(record.observed.size() == 3);
    const Hdf5Handle h5(H5Fopen((options.directory + "/results.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        H5Fclose);
    const std::vector<TableLayout> layouts = observed_layouts(read_deck(file));
    for (std::size_t t = 0; t < layouts.size(); ++t) {
        CAPTURE(layouts[t].name);
        TableRows all;
        std::vector<std::int64_t> ends;
        const std::size_t n = layouts[t].columns.size();
        for (const auto& tables : record.observed) {
            all.insert(all.end(), tables[t].begin(), tables[t].end());
            ends.push_back(static_cast<std::int64_t>(all.size() / n));
        }
        const std::string name = "/observed/" + layouts[t].name;
        const Hdf5Handle rows(H5Dopen2(h5, name.c_str(), H5P_DEFAULT), H5Dclose);
        const Hdf5Handle end(H5Dopen2(h5, (name + "_end").c_str(), H5P_DEFAULT), H5Dclose);
        const Hdf5Handle space(H5Dget_space(rows), H5Sclose);
        REQUIRE(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) == all.size());
        TableRows stored(all.size());
        std::vector<std::int64_t> stored_ends(ends.size());
        H5Dread(rows, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, stored.data());
        H5Dread(end, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, stored_ends.data());
        CHECK(stored_ends == ends);
        const Columns csv = read_columns(options.directory + "/" + layouts[t].name + ".csv");
        REQUIRE(csv.n_rows() * n == all.size());
        bool same = true;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const bool both_none = std::isnan(all[i]) && std::isnan(stored[i]);
            same = same && (both_none || stored[i] == all[i]);
            if (!layouts[t].columns[i % n].words.empty() || both_none) continue;
            same = same && csv.values[i % n][i / n] == all[i];
        }
        CHECK(same);
    }
}

}  // namespace quern::test
