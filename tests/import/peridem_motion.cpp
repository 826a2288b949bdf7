// Displacements and forces of PeriDEM against what the deck that is written does.
#include <cmath>
#include <numbers>

#include "src/deck/expression.hpp"
#include "src/deck/parameters.hpp"
#include "tests/import/peridem_files.hpp"

namespace quern::test {

namespace {

constexpr double pi = std::numbers::pi;

/// The deck with one set of displacements.
std::string with_displacement(const std::string& lines) {
    return peridem_deck + "Displacement_BC:\n  Sets: 1\n  Set_1:\n" + lines;
}
std::string with_force(const std::string& lines) {
    return replaced(peridem_deck, "Force_BC:\n", "Force_BC:\n  Sets: 1\n  Set_1:\n" + lines);
}

/// A formula of the deck; its ${...} see the deck's params.
Expression formula_at(const Node& deck, const std::string& path) {
    static const std::string file = "deck";
    const Cursor root(deck, file);
    const Node* params = deck.find("params");
    const Parameters parameters = params ? Parameters(Cursor(root, *params, "params")) : Parameters();
    return Expression(parameters.resolve_formula(at(deck, path).text, path), path);
}

/// The set follows the wall's zero velocity, All_Dofs_Constrained.
const std::string set = "constraints.1.";

using Motion = double (*)(double X, double t);

/// Largest difference of the velocity formula along y from (u(t + h) - u(t - h))/2h, over the largest of
/// both.
double velocity_error(const Node& deck, Motion u, bool along_y) {
    const Expression v = formula_at(deck, set + "velocity.1");
    double error = 0.0, largest = 0.0;
    for (const double X : {-0.004, 0.001, 0.0075})
        for (const double t : {0.0, 0.0013, 0.004, 0.0087}) {
            constexpr double h = 1e-6;
            const double rate = (u(X, t + h) - u(X, t - h)) / (2.0 * h);
            const double y = along_y ? X + u(X, t) : X;
            largest = std::max(largest, std::abs(rate));
            error = std::max(error, std::abs(v(0.3, y, 0.0, t) - rate));
        }
    return error / largest;
}

std::string function_lines(const std::string& direction, const std::string& time, const std::string& space) {
    return "    Particle_List: [0, 2]\n    Direction: " + direction + "\n    Time_Function: " + time +
           "\n    Spatial_Function: " + space + "\n";
}

}  // namespace

TEST_CASE("Imported displacement: velocities are its rates of change, in time and place") {
    const PeridemFiles files;
    struct Case {
        const char *direction, *time, *space;
        Motion u;
    };
    const Case cases[] = {
        {"[2]", "{Type: linear, Parameters: [-0.06]}", "{Type: constant}",
         [](double, double t) { return -0.06 * t; }},
        {"[2]", "{Type: quadratic, Parameters: [0.1, -3.0]}", "{Type: constant}",
         [](double, double t) { return 0.1 * t - 3.0 * t * t; }},
        {"[2]", "{Type: sin, Parameters: [1.0e-3, 50.0]}", "{Type: constant}",
         [](double, double t) { return 1e-3 * std::sin(pi * 50.0 * t); }},
        {"[2]", "{Type: linear, Parameters: [0.5]}", "{Type: linear_y, Parameters: [-20.0]}",
         [](double X, double t) { return 0.5 * -20.0 * X * t; }},
        {"[1, 2]", "{Type: quadratic, Parameters: [0.5, 2.0]}", "{Type: linear_y, Parameters: [20.0]}",
         [](double X, double t) { return 0.5 * 20.0 * X * t + 2.0 * t * t; }},
        {"[2]", "{Type: sin, Parameters: [0.01, 30.0]}", "{Type: linear_y, Parameters: [20.0]}",
         [](double X, double t) { return 0.01 * 20.0 * X * std::sin(pi * 30.0 * t); }},
    };
    for (const Case& c : cases) {
        CAPTURE(c.time);
        CAPTURE(c.space);
        const Node deck = files.tree(with_displacement(function_lines(c.direction, c.time, c.space)));
        CHECK(velocity_error(deck, c.u, true) <
              1e-7);  // measured 4.1e-9, bound 1e-7: the difference quotient
        CHECK(at(deck, set + "grains.1").text == "2");
        const bool both = std::string(c.direction) == "[1, 2]";
        CHECK((at(deck, set + "velocity.0").text == "free") != both);
    }
}

TEST_CASE("Imported displacement: across the axis that it depends on, the current place stands in") {
    const PeridemFiles files;
    const Node deck = files.tree(with_displacement(
        function_lines("[2]", "{Type: linear, Parameters: [0.5]}", "{Type: sin_x, Parameters: [100.0]}")));
    const Expression v = formula_at(deck, set + "velocity.1");
    CHECK(v(0.003, 9.0, 0.0, 0.004) == doctest::Approx(0.5 * std::sin(pi * 100.0 * 0.003)).epsilon(1e-14));
    CHECK(contains(files.text(),
                   "# - Displacement_BC.Set_1: depends on the current x, where PeriDEM takes that at t = 0"));
}

TEST_CASE("Imported displacement: none, by a constant 0 or a flag") {
    const PeridemFiles files;
    for (const char* lines :
         {"    Particle_List: [0]\n    Direction: [1, 2, 3]\n    Zero_Displacement: true\n",
          "    Particle_List: [0]\n    Direction: [1, 2]\n    Time_Function: {Type: constant, Parameters: "
          "[0.0]}\n"}) {
        const Node deck = files.tree(with_displacement(lines));
        CHECK(at(deck, set + "velocity").items.size() == 2);
        CHECK(at(deck, set + "velocity.0").text == "0");
        CHECK(at(deck, set + "velocity.1").text == "0");
    }
    // A wall that such a set holds is not held twice.
    const Node deck = files.tree(
        with_displacement("    Particle_List: [3]\n    Direction: [1, 2]\n    Zero_Displacement: true\n"));
    CHECK(at(deck, "constraints").items.size() == 1);
}

TEST_CASE("Imported displacement: a rotation keeps the distance and turns by omega dt a step") {
    const PeridemFiles files;
    const Node deck = files.tree(with_displacement(
        "    Particle_List: [3]\n    Direction: [1, 2]\n"
        "    Time_Function: {Type: rotation, Parameters: [-94.24778, 5.8875e-03, -7.3875e-03, 0.0]}\n"
        "    Spatial_Function: {Type: rotation}\n"));
    CHECK(number_at(deck, "params.dt") == 1e-7);
    const Expression vx = formula_at(deck, "constraints.0.velocity.0");
    const Expression vy = formula_at(deck, "constraints.0.velocity.1");
    const double x0 = 5.8875e-3, y0 = -7.3875e-3, dt = 1e-7;
    double x = 0.02, y = 0.001;
    const double radius = std::hypot(x - x0, y - y0), start = std::atan2(y - y0, x - x0);
    constexpr int n = 20000;
    for (int step = 0; step < n; ++step) {
        const double u = vx(x, y, 0.0, 0.0), v = vy(x, y, 0.0, 0.0);
        x += dt * u;
        y += dt * v;
    }
    const double turned = std::atan2(y - y0, x - x0) - start;
    CHECK(std::abs(std::hypot(x - x0, y - y0) / radius - 1.0) <
          1e-10);                                         // measured 6.1e-13, bound 1e-10; tangent 8.9e-7
    CHECK(std::abs(turned + 94.24778 * n * dt) < 1e-10);  // measured 2.7e-15, bound 1e-10 [rad]
}

TEST_CASE("Imported force: per volume, in time and place") {
    const PeridemFiles files;
    struct Case {
        const char *time, *space;
        Motion f;  ///< of y and t
    };
    const Case cases[] = {
        {"{Type: constant, Parameters: [3.0]}", "{Type: constant}", [](double, double) { return 3.0; }},
        {"{Type: linear, Parameters: [-3.0]}", "{Type: linear_y, Parameters: [-2.0]}",
         [](double y, double t) { return -3.0 * t * 4.0 * y; }},
        {"{Type: sin, Parameters: [3.0, 40.0]}", "{Type: sin_y, Parameters: [200.0]}",
         [](double y, double t) { return 3.0 * std::sin(pi * 40.0 * t) * 200.0 * std::sin(pi * 200.0 * y); }},
        {"{Type: linear_slow_fast, Parameters: [2.0, 0.003, 5.0, 11.0]}", "{Type: constant}",
         [](double, double t) { return 2.0 * t * (t > 0.003 ? 11.0 : 5.0); }},
        // Grows over 1 ms, rests over 2 ms, and again.
        {"{Type: linear_step, Parameters: [2.0, 0.001, 0.002]}", "{Type: constant}",
         [](double, double t) {
             const double whole = std::floor(t / 0.003), part = t - 0.003 * whole;
             return 2.0 * (0.001 * whole + std::min(part, 0.001));
         }},
        {"{Type: constant, Parameters: [3.0]}", "{Type: hat_y, Parameters: [7.0]}",
         [](double y, double) { return 21.0 * (1.0 - std::abs(y - 0.005) / 0.005); }},
    };
    double error = 0.0;
    for (const Case& c : cases) {
        const Node deck = files.tree(with_force(function_lines("[2]", c.time, c.space) +
                                                "    Region: {Rectangle: [0, 0, 0, 0.02, 0.01, 0]}\n"));
        CHECK(at(deck, "loads.0.force_density.0").text == "0");
        const Expression f = formula_at(deck, "loads.0.force_density.1");
        for (const double y : {0.0013, 0.005, 0.0072})
            for (const double t : {0.0002, 0.0017, 0.0034, 0.0077})
                error = std::max(error, std::abs(f(0.3, y, 0.0, t) - c.f(y, t)) / 3.0);
    }
    CHECK(error < 1e-12);  // measured below 1e-16, bound 1e-12
}

TEST_CASE("Imported region: rectangles and circles, with their sides") {
    const PeridemFiles files;
    const auto region = [&](const std::string& shape) {
        return formula_at(files.tree(with_displacement("    Region: " + shape +
                                                       "\n    Particle_Exclude_List: [0]\n"
                                                       "    Direction: [1]\n    Zero_Displacement: true\n")),
                          set + "region");
    };
    const Expression box = region("{Rectangle: [1.0e-3, -2.0e-3, 0, 4.0e-3, 5.0e-3, 0]}");
    for (const double x : {0.9999e-3, 1e-3, 4e-3, 4.0001e-3})
        for (const double y : {-2.0001e-3, -2e-3, 5e-3, 5.0001e-3})
            CHECK((box(x, y, 0.0, 0.0) != 0.0) == (x >= 1e-3 && x <= 4e-3 && y >= -2e-3 && y <= 5e-3));
    for (const char* text : {"{Circle: [2.0e-3, 1.0e-3, -1.0e-3, 0.0]}",
                             "{Geometry: {Type: circle, Parameters: [2.0e-3, 1.0e-3, -1.0e-3, 0.0]}}"}) {
        const Expression circle = region(text);
        CHECK(circle(3e-3, -1e-3, 0.0, 0.0) != 0.0);
        CHECK(circle(3.0001e-3, -1e-3, 0.0, 0.0) == 0.0);
        CHECK(circle(2.4e-3, 0.4e-3, 0.0, 0.0) != 0.0);
        CHECK(circle(2.5e-3, 0.5e-3, 0.0, 0.0) == 0.0);
    }
    // Edge lengths and centre are another way to give a rectangle.
    CHECK(region("{Geometry: {Type: rectangle, Parameters: [2, 4, 1, 1, 0]}}")(1.9, 2.9, 0, 0) != 0.0);
    CHECK(region("{Geometry: {Type: rectangle, Parameters: [2, 4, 1, 1, 0]}}")(1.9, 3.1, 0, 0) == 0.0);
    const Node deck = read_tree(files.output.string());
    CHECK(at(deck, set + "grains").items.size() == 3);
    CHECK(at(deck, set + "grains.0").text == "1");
}

TEST_CASE("Imported displacement: what has no velocity is refused") {
    const PeridemFiles files;
    const auto error = [&](const char* direction, const char* time, const char* space) {
        return files.error(with_displacement(function_lines(direction, time, space)));
    };
    const std::string where = "input_0.yaml:109: Displacement_BC.Set_1";
    const std::string jump = error("[2]", "{Type: constant, Parameters: [1.0e-3]}", "{Type: constant}");
    CHECK(contains(jump, where + ": got a constant displacement of 0.001 m"));
    CHECK(contains(error("[2]", "{Type: linear, Parameters: [1]}", "{Type: sin_y, Parameters: [1]}"),
                   where + ": got sin_y of a motion along y"));
    CHECK(contains(error("[1]", "{Type: rotation, Parameters: [1, 0, 0, 0]}", "{Type: rotation}"),
                   where + ": got a rotation that does not hold both x and y"));
    CHECK(
        contains(error("[2]", "{Type: linear_step, Parameters: [1, 1, 1]}", "{Type: constant}"),
                 "Set_1.Time_Function.Type: got 'linear_step', expected one of constant, linear, quadratic"));
    CHECK(contains(error("[2]", "{Type: quadratic, Parameters: [1]}", "{Type: constant}"),
                   "Set_1.Time_Function.Parameters: got a list, expected 2 numbers or more"));
    CHECK(contains(error("[4]", "{Type: linear, Parameters: [1]}", "{Type: constant}"),
                   "Set_1.Direction: got a list, expected axes among 1, 2, 3"));
    CHECK(contains(files.error(with_displacement("    Direction: [1]\n    Zero_Displacement: true\n")),
                   "neither Particle_List nor Region"));
    CHECK(contains(files.error(with_displacement("    Particle_List: [0]\n    Direction: [1]\n")),
                   "no Time_Function"));
    CHECK(contains(files.error(with_displacement(
                       "    Particle_List: [4]\n    Direction: [1]\n    Zero_Displacement: true\n")),
                   "got body 4, expected a number from 0 to 3"));
    CHECK(contains(files.error(with_force(function_lines("[2]", "{Type: constant, Parameters: [1]}",
                                                         "{Type: hat_x, Parameters: [1]}"))),
                   "got a hat without a Region"));
}

}  // namespace quern::test
