#include "src/import/peridem_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grid/error.hpp"

namespace quern {
namespace {

/// A factor or a term: in brackets if negative.
std::string number(double value) {
    return value < 0.0 ? fmt::format("({})", number_text(value)) : number_text(value);
}

/// The axis that the spatial function depends on; -1: none.
int axis_of(SpatialFunction function) {
    switch (function) {
        case SpatialFunction::hat_x:
        case SpatialFunction::sin_x:
        case SpatialFunction::linear_x:
            return 0;
        case SpatialFunction::hat_y:
        case SpatialFunction::sin_y:
        case SpatialFunction::linear_y:
            return 1;
        case SpatialFunction::constant:
        case SpatialFunction::rotation:
            return -1;
    }
    return -1;
}

bool is_linear(SpatialFunction function) {
    return function == SpatialFunction::linear_x || function == SpatialFunction::linear_y;
}

std::string axis_name(int axis) {
    return {"xyz"[axis]};
}

bool holds(const PeridemSet& set, int axis) {
    return std::find(set.direction.begin(), set.direction.end(), axis) != set.direction.end();
}

std::vector<std::string> rotation_formulas(const PeridemSet& set, int dimension, bool fixed_step) {
    if (!holds(set, 0) || !holds(set, 1))
        throw InputError(set.where, "a rotation that does not hold both x and y", "Direction: [1, 2]");
    const std::string w = number(set.time_parameters[0]);
    const std::string x = fmt::format("(x - {})", number(set.time_parameters[1]));
    const std::string y = fmt::format("(y - {})", number(set.time_parameters[2]));
    std::vector<std::string> v(static_cast<std::size_t>(dimension), "free");
    if (fixed_step) {
        const std::string radial = fmt::format("${{(cos({0}*dt) - 1)/dt}}", w);
        const std::string tangential = fmt::format("${{sin({0}*dt)/dt}}", w);
        v[0] = fmt::format("{}*{} - {}*{}", radial, x, tangential, y);
        v[1] = fmt::format("{}*{} + {}*{}", tangential, x, radial, y);
    } else {
        v[0] = fmt::format("-{}*{}", w, y);
        v[1] = fmt::format("{}*{}", w, x);
    }
    if (dimension == 3 && holds(set, 2)) v[2] = number_text(0.0);
    return v;
}

/// A(t), A'(t), B(t), B'(t) as texts; "" for what is 0.
struct Growth {
    std::string a, a_rate, b, b_rate;
};

Growth growth(const PeridemSet& set) {
    const std::vector<double>& p = set.time_parameters;
    switch (set.time) {
        case TimeFunction::linear:
            return {fmt::format("{}*t", number(p[0])), number(p[0]), "", ""};
        case TimeFunction::quadratic:
            return {fmt::format("{}*t", number(p[0])), number(p[0]), fmt::format("{}*t^2", number(p[1])),
                    fmt::format("{}*t", number(2.0 * p[1]))};
        case TimeFunction::sine:
            return {fmt::format("{}*sin(pi*{}*t)", number(p[0]), number(p[1])),
                    fmt::format("{}*pi*{}*cos(pi*{}*t)", number(p[0]), number(p[1]), number(p[1])), "", ""};
        default:
            throw InputError(set.where, fmt::format("a constant displacement of {} m", p[0]),
                             "0, or a displacement that grows with time", "it would jump in the first step");
    }
}

/// g at the current place.
std::string shape_formula(const PeridemSet& set, const Growth& grown, ImportNotes& notes) {
    const int axis = axis_of(set.space);
    if (axis < 0) return "";
    const std::string s = number(set.space_parameters[0]), x = axis_name(axis);
    if (!holds(set, axis)) {
        notes.add_difference(
            fmt::format("{}: depends on the current {}, where PeriDEM takes that at t = 0", set.key, x));
        return is_linear(set.space) ? fmt::format("{}*{}", s, x) : fmt::format("sin(pi*{}*{})", s, x);
    }
    if (!is_linear(set.space))
        throw InputError(set.where, fmt::format("sin_{} of a motion along {}", x, x),
                         fmt::format("linear_{}, or a motion across {}", x, x),
                         "its velocity is no formula of the current place");
    const std::string moved = grown.b.empty() ? x : fmt::format("({} - {})", x, grown.b);
    return fmt::format("{}*{}/(1 + {}*{})", s, moved, s, grown.a);
}

double shape_value(const PeridemSet& set, const Numbers3& X) {
    const int axis = axis_of(set.space);
    if (axis < 0) return 1.0;
    const double s = set.space_parameters[0], x = X[static_cast<std::size_t>(axis)];
    return is_linear(set.space) ? s * x : std::sin(std::numbers::pi * s * x);
}

std::string force_in_time(const PeridemSet& set) {
    const std::vector<double>& p = set.time_parameters;
    switch (set.time) {
        case TimeFunction::linear:
            return {"*t"};
        case TimeFunction::sine:
            return fmt::format("*sin(pi*{}*t)", number(p[1]));
        case TimeFunction::linear_step: {
            // rint(q - 0.5) is the number of whole periods.
            const std::string period = fmt::format("rint(t/{} - 0.5)", number(p[1] + p[2]));
            return fmt::format("*min(t - {}*{}, ({} + 1)*{})", period, number(p[2]), period, number(p[1]));
        }
        case TimeFunction::linear_slow_fast:
            return fmt::format("*t*if(t > {}, {}, {})", number(p[1]), number(p[3]), number(p[2]));
        default:
            return "";
    }
}

std::array<Numbers3, 2> box_of(const PeridemGeometry& region, int dimension) {
    if (const auto box = bounding_box(region, dimension)) return *box;
    throw InputError(region.where, fmt::format("a region of type '{}'", region.type),
                     "a rectangle, circle, cuboid or sphere with its parameters");
}

std::string force_in_space(const PeridemSet& set, int dimension) {
    const int axis = axis_of(set.space);
    if (axis < 0) return "";
    const double s = set.space_parameters[0];
    const std::string x = axis_name(axis);
    if (set.space == SpatialFunction::hat_x || set.space == SpatialFunction::hat_y) {
        const auto [lower, upper] = box_of(*set.region, dimension);
        const double low = lower[static_cast<std::size_t>(axis)],
                     high = upper[static_cast<std::size_t>(axis)];
        return fmt::format("*{}*max(0, 1 - abs(2*{} - {})/{})", number(s), x, number(low + high),
                           number(high - low));
    }
    if (is_linear(set.space)) return fmt::format("*{}*{}", number(s * s), x);
    return fmt::format("*{}*sin(pi*{}*{})", number(s), number(s), x);
}

}  // namespace

std::vector<std::string> velocity_formulas(const PeridemSet& set, int dimension, bool fixed_step,
                                           ImportNotes& notes) {
    const bool still = set.zero || (set.time == TimeFunction::constant && set.time_parameters[0] == 0.0);
    if (!still && set.time == TimeFunction::rotation) return rotation_formulas(set, dimension, fixed_step);
    std::string velocity = number_text(0.0);
    if (!still) {
        const Growth grown = growth(set);
        const std::string shape = shape_formula(set, grown, notes);
        velocity = shape.empty() ? grown.a_rate : fmt::format("{}*{}", grown.a_rate, shape);
        if (!grown.b_rate.empty()) velocity += fmt::format(" + {}", grown.b_rate);
        if (shape.empty() && set.time == TimeFunction::linear) velocity = number_text(set.time_parameters[0]);
    }
    std::vector<std::string> v(static_cast<std::size_t>(dimension), "free");
    for (const int axis : set.direction) v[static_cast<std::size_t>(axis)] = velocity;
    return v;
}

Numbers3 displacement(const PeridemSet& set, const Numbers3& X, double t) {
    Numbers3 u{};
    if (set.zero) return u;
    const std::vector<double>& p = set.time_parameters;
    if (set.time == TimeFunction::rotation) {
        const double c = std::cos(p[0] * t) - 1.0, s = std::sin(p[0] * t);
        const double x = X[0] - p[1], y = X[1] - p[2];
        return {c * x - s * y, s * x + c * y, 0.0};
    }
    double value = p[0] * shape_value(set, X);
    if (set.time == TimeFunction::linear || set.time == TimeFunction::quadratic) value *= t;
    if (set.time == TimeFunction::sine) value *= std::sin(std::numbers::pi * p[1] * t);
    if (set.time == TimeFunction::quadratic) value += p[1] * t * t;
    for (const int axis : set.direction) u[static_cast<std::size_t>(axis)] = value;
    return u;
}

std::vector<std::string> force_formulas(const PeridemSet& set, int dimension) {
    const std::string force =
        number_text(set.time_parameters[0]) + force_in_time(set) + force_in_space(set, dimension);
    std::vector<std::string> f(static_cast<std::size_t>(dimension), "0");
    for (const int axis : set.direction) f[static_cast<std::size_t>(axis)] = force;
    return f;
}

std::string region_formula(const PeridemGeometry& region, int dimension) {
    const auto [low, high] = box_of(region, dimension);
    const bool round = region.type == "circle" || region.type == "sphere";
    const std::size_t n = static_cast<std::size_t>(dimension);
    double size = 0.0;
    for (std::size_t a = 0; a < n; ++a) size = std::max(size, high[a] - low[a]);
    const std::string slack = fmt::format("{:.0e}", 1e-9 * size);
    std::string formula;
    for (std::size_t a = 0; a < n; ++a) {
        const char x = "xyz"[a];
        formula += a == 0 ? "" : round ? " + " : " && ";
        if (round)
            formula += fmt::format("({} - {})^2", x, number(region.parameters[a + 1]));
        else
            formula += fmt::format("{} >= {} - {} && {} <= {} + {}", x, number(low[a]), slack, x,
                                   number(high[a]), slack);
    }
    if (round) formula += fmt::format(" <= ({} + {})^2", number(region.parameters[0]), slack);
    return formula;
}

std::optional<std::array<Numbers3, 2>> bounding_box(const PeridemGeometry& geometry, int dimension) {
    const std::vector<double>& p = geometry.parameters;
    std::array<Numbers3, 2> box{};
    const bool flat = geometry.type == "rectangle", solid = geometry.type == "cuboid";
    if ((flat && dimension == 2 && p.size() >= 6) || (solid && p.size() == 6)) {
        for (std::size_t a = 0; a < 3; ++a) {
            box[0][a] = std::min(p[a], p[a + 3]);
            box[1][a] = std::max(p[a], p[a + 3]);
        }
        return box;
    }
    const bool round = geometry.type == "circle" || geometry.type == "sphere";
    std::size_t n_edges = round ? 1 : flat ? 2 : solid ? 3 : 0;
    if (n_edges == 0 || p.size() < n_edges + 3 || (flat && dimension == 3)) return std::nullopt;
    for (std::size_t a = 0; a < 3; ++a) {
        const double half = round ? p[0] : a < n_edges ? 0.5 * p[a] : 0.0;
        box[0][a] = p[n_edges + a] - half;
        box[1][a] = p[n_edges + a] + half;
    }
    return box;
}

}  // namespace quern
