#include "src/results/fields.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "grid/error.hpp"
#include "src/results/colors.hpp"
#include "src/results/ticks.hpp"

using namespace quern;

namespace {

/// One particle under a stress: in 2D xx, yy, xy, zz; in 3D xx, yy, zz, xy, yz, xz.
Frame make_frame(const std::vector<float>& stress) {
    Frame frame;
    frame.dimension = stress.size() == 4 ? 2 : 3;
    frame.position = {3.0, 4.0, 0.0};
    frame.velocity = {3.0, -4.0, 12.0};
    frame.position.resize(static_cast<std::size_t>(frame.dimension));
    frame.velocity.resize(static_cast<std::size_t>(frame.dimension));
    frame.damage = {0.25};
    frame.stress = stress;
    frame.grain = {5};
    frame.volume = {1.0};
    return frame;
}

double value(const std::string& name, const Frame& frame) {
    Frame first = frame;
    first.position.assign(first.position.size(), 0.0);
    return make_field_values(find_field(name, frame.dimension), frame, first).at(0);
}

}  // namespace

TEST_CASE("Fields: motion") {
    const Frame plane = make_frame({0, 0, 0, 0}), space = make_frame({0, 0, 0, 0, 0, 0});
    CHECK(value("speed", plane) == 5.0);
    CHECK(value("speed", space) == 13.0);
    CHECK(value("velocity_y", plane) == -4.0);
    CHECK(value("velocity_z", space) == 12.0);
    CHECK(value("displacement", plane) == 5.0);
    CHECK(value("damage", plane) == 0.25);
    CHECK(value("grain", plane) == 5.0);
}

TEST_CASE("Fields: the stretch over the critical one, where there is one") {
    Frame frame = make_frame({0, 0, 0, 0});
    CHECK_THROWS_WITH_AS(value("damage_z", frame), doctest::Contains("no material of this run can break"),
                         InputError);
    frame.damage_z = {1.5};
    CHECK(value("damage_z", frame) == 1.5);
}

TEST_CASE("Fields: plastic strain, where something can yield") {
    Frame frame = make_frame({0, 0, 0, 0});
    CHECK_THROWS_WITH_AS(value("plastic_strain", frame),
                         doctest::Contains("no material of this run can yield"), InputError);
    frame.plastic_strain = {0.25};
    CHECK(value("plastic_strain", frame) == 0.25);
}

TEST_CASE("Fields: von Mises stress of tension, shear and pressure") {
    const auto near = [](double expected) { return doctest::Approx(expected).epsilon(1e-14); };
    CHECK(value("von_mises", make_frame({7, 0, 0, 0})) == near(7.0));
    CHECK(value("von_mises", make_frame({0, 0, 7, 0})) == near(7.0 * std::sqrt(3.0)));
    CHECK(value("von_mises", make_frame({0, 0, 0, 7})) == near(7.0));
    CHECK(value("von_mises", make_frame({-7, -7, 0, -7})) == doctest::Approx(0.0));
    CHECK(value("von_mises", make_frame({0, 0, 0, 0, 7, 0})) == near(7.0 * std::sqrt(3.0)));
    CHECK(value("von_mises", make_frame({0, 0, 7, 0, 0, 0})) == near(7.0));
}

TEST_CASE("Fields: pressure is positive in compression") {
    CHECK(value("pressure", make_frame({-3, -6, 100, -9})) == doctest::Approx(6.0));
    CHECK(value("pressure", make_frame({-3, -6, -9, 100, 100, 100})) == doctest::Approx(6.0));
}

TEST_CASE(
    "Fields: principal difference in the plane ignores the out-of-plane stress, in space it is the largest") {
    CHECK(value("principal_difference", make_frame({3, -1, 1.5, 50})) == doctest::Approx(5.0));
    CHECK(value("principal_difference", make_frame({3, -1, 50, 0, 0, 0})) == doctest::Approx(51.0));
    CHECK(value("principal_difference", make_frame({0, 0, 0, 0, 4, 0})) == doctest::Approx(8.0));
}

TEST_CASE("Fields: stress components keep their names in both orders of storage") {
    const Frame plane = make_frame({1, 2, 3, 4}), space = make_frame({1, 2, 3, 4, 5, 6});
    CHECK(value("stress_xy", plane) == 3.0);
    CHECK(value("stress_zz", plane) == 4.0);
    CHECK(value("stress_zz", space) == 3.0);
    CHECK(value("stress_xz", space) == 6.0);
    CHECK_THROWS_AS(find_field("stress_yz", 2), InputError);
    CHECK_THROWS_WITH_AS(find_field("vonmises", 3), doctest::Contains("did you mean 'von_mises'?"),
                         InputError);
}

TEST_CASE("ColorMap: ends, middle, what is outside and what is no number") {
    const ColorMap map(ColorScale::sequential, 0.0, 2.0);
    CHECK(map.color(-1.0) == map.color(0.0));
    CHECK(map.color(9.0) == map.color(2.0));
    CHECK(map.color(std::nan("")) == Rgb{128, 128, 128});
    const Rgb middle = ColorMap(ColorScale::diverging, -1.0, 1.0).color(0.0);
    CHECK(std::abs(middle[0] - middle[2]) <= 6);  // grey: measured 1, bound 6
}

TEST_CASE("ColorMap: consecutive grains differ") {
    const ColorMap map(ColorScale::categorical, 0.0, 1.0);
    for (int grain = 0; grain < 200; ++grain)
        for (int next = grain + 1; next < grain + 12; ++next) {
            int distance = 0;
            for (std::size_t c = 0; c < 3; ++c)
                distance += std::abs(map.color(grain)[c] - map.color(next)[c]);
            CHECK(distance > 30);
        }
}

TEST_CASE("Ticks: round numbers inside the range, labelled without noise") {
    const auto labels = [](const std::vector<Tick>& ticks) {
        std::string all;
        for (const Tick& tick : ticks) all += tick.label + " ";
        return all;
    };
    CHECK(labels(make_ticks(0.0, 1.0, 6)) == "0 0.2 0.4 0.6 0.8 1.0 ");
    CHECK(labels(make_ticks(-0.31, 0.29, 5)) == "-0.2 0 0.2 ");
    CHECK(labels(make_ticks(0.0, 3e-7, 4)) == "0 1e-7 2e-7 3e-7 ");
    CHECK(labels(make_ticks(0.0, 2.5e6, 6)) == "0 0.5e6 1.0e6 1.5e6 2.0e6 2.5e6 ");
    CHECK(labels(make_log_ticks(-6.1, -2.9, 6)) == "1e-6 1e-5 1e-4 0.001 ");
    CHECK(labels(make_log_ticks(0.0, 1.05, 6)) == "1 2 5 10 ");
    CHECK(round_down(0.7) == doctest::Approx(0.5));
    CHECK(round_down(1.0) == 1.0);
}

TEST_CASE("Ticks: units take the prefix that makes numbers readable") {
    CHECK(make_scaled_unit("Pa", 2.5e7).name == "MPa");
    CHECK(make_scaled_unit("Pa", 2.5e7).factor == doctest::Approx(1e-6));
    CHECK(make_scaled_unit("m", 0.02).name == "mm");
    CHECK(make_scaled_unit("m", 0.5).name == "m");
    CHECK(make_scaled_unit("m", 0.0).name == "m");
    CHECK(make_scaled_unit("", 1e9).name.empty());
}
