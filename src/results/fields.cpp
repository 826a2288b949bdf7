#include "src/results/fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "grid/error.hpp"
#include "grid/vec.hpp"

namespace quern {

namespace {

/// Position of a component in Frame::stress; -1 if the dimension has none.
int stress_index(std::string_view component, int dimension) {
    constexpr std::string_view plane[] = {"xx", "yy", "xy", "zz"};
    constexpr std::string_view space[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
    const auto position = [&](const auto& names) {
        const auto* found = std::find(std::begin(names), std::end(names), component);
        return found == std::end(names) ? -1 : static_cast<int>(found - std::begin(names));
    };
    return dimension == 2 ? position(plane) : position(space);
}

Mat<3> stress_of(const Frame& frame, std::size_t i) {
    const bool plane = frame.dimension == 2;
    const float* s = &frame.stress[i * (plane ? 4 : 6)];
    const double zz = plane ? s[3] : s[2], xy = plane ? s[2] : s[3];
    const double yz = plane ? 0.0 : s[4], xz = plane ? 0.0 : s[5];
    Mat<3> stress;
    stress << s[0], xy, xz, xy, s[1], yz, xz, yz, zz;
    return stress;
}

double von_mises(const Mat<3>& stress) {
    const Mat<3> deviator = stress - stress.trace() / 3.0 * Mat<3>::Identity();
    return std::sqrt(1.5) * deviator.norm();
}

double principal_difference(const Mat<3>& stress, int dimension) {
    if (dimension == 2) return std::hypot(stress(0, 0) - stress(1, 1), 2.0 * stress(0, 1));
    const Eigen::SelfAdjointEigenSolver<Mat<3>> principal(stress, Eigen::EigenvaluesOnly);
    return principal.eigenvalues()[2] - principal.eigenvalues()[0];
}

/// Length of particle i's part of the difference of two vector arrays.
double distance(const std::vector<double>& a, const std::vector<double>& b, std::size_t i, std::size_t d) {
    double squared = 0.0;
    for (std::size_t k = i * d; k < (i + 1) * d; ++k) squared += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(squared);
}

double length(const std::vector<float>& a, std::size_t i, std::size_t d) {
    double squared = 0.0;
    for (std::size_t k = i * d; k < (i + 1) * d; ++k) squared += static_cast<double>(a[k]) * a[k];
    return std::sqrt(squared);
}

/// Levenshtein distance.
std::size_t n_edits(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

std::vector<Field> all_fields(int dimension) {
    std::vector<Field> fields = {{"speed", "m/s", "speed"}, {"displacement", "m", "displacement"}};
    for (const char* axis : {"x", "y", "z"})
        if (dimension == 3 || *axis != 'z')
            fields.push_back({fmt::format("velocity_{}", axis), "m/s", fmt::format("velocity {}", axis),
                              ColorScale::diverging});
    fields.push_back({"damage", "", "damage"});
    fields.push_back({"damage_z", "", "largest stretch over critical"});
    fields.push_back({"plastic_strain", "", "equivalent plastic strain"});
    fields.push_back({"grain", "", "grain", ColorScale::categorical});
    fields.push_back({"fragment", "", "fragment", ColorScale::categorical});
    fields.push_back({"von_mises", "Pa", "von Mises stress"});
    fields.push_back({"pressure", "Pa", "pressure", ColorScale::diverging});
    fields.push_back({"principal_difference", "Pa", "principal stress difference"});
    for (const char* component : {"xx", "yy", "zz", "xy", "yz", "xz"})
        if (stress_index(component, dimension) >= 0)
            fields.push_back({fmt::format("stress_{}", component), "Pa", fmt::format("stress {}", component),
                              ColorScale::diverging});
    return fields;
}

}  // namespace

std::vector<std::string> field_names(int dimension) {
    std::vector<std::string> names;
    for (const Field& field : all_fields(dimension)) names.push_back(field.name);
    return names;
}

Field find_field(const std::string& name, int dimension) {
    const std::vector<Field> fields = all_fields(dimension);
    const auto found =
        std::find_if(fields.begin(), fields.end(), [&](const Field& field) { return field.name == name; });
    if (found != fields.end()) return *found;
    const auto nearest = std::min_element(fields.begin(), fields.end(), [&](const Field& a, const Field& b) {
        return n_edits(name, a.name) < n_edits(name, b.name);
    });
    throw InputError("field", fmt::format("'{}'", name),
                     fmt::format("one of {}", fmt::join(field_names(dimension), ", ")),
                     fmt::format("did you mean '{}'?", nearest->name));
}

std::vector<double> make_field_values(const Field& field, const Frame& frame, const Frame& first) {
    const std::size_t n = frame.n(), d = static_cast<std::size_t>(frame.dimension);
    const std::string& name = field.name;
    std::vector<double> values(n);
    const auto fill = [&](auto&& value_of) {
        for (std::size_t i = 0; i < n; ++i) values[i] = value_of(i);
    };
    if (name == "speed") {
        fill([&](std::size_t i) { return length(frame.velocity, i, d); });
    } else if (name == "displacement") {
        fill([&](std::size_t i) { return distance(frame.position, first.position, i, d); });
    } else if (name.starts_with("velocity_")) {
        const auto axis = static_cast<std::size_t>(name.back() - 'x');
        fill([&](std::size_t i) { return frame.velocity[i * d + axis]; });
    } else if (name == "damage") {
        values.assign(frame.damage.begin(), frame.damage.end());
    } else if (name == "damage_z") {
        if (frame.damage_z.size() != n)
            throw InputError("field", "'damage_z'", "another field", "no material of this run can break");
        values.assign(frame.damage_z.begin(), frame.damage_z.end());
    } else if (name == "plastic_strain") {
        if (frame.plastic_strain.size() != n)
            throw InputError("field", "'plastic_strain'", "another field",
                             "no material of this run can yield");
        values.assign(frame.plastic_strain.begin(), frame.plastic_strain.end());
    } else if (name == "grain") {
        fill([&](std::size_t i) { return frame.grain[i]; });
    } else if (name == "fragment") {
        if (frame.fragment.size() != n)
            throw InputError("field", "'fragment'", "another field", "no material of this run can break");
        values.assign(frame.fragment.begin(), frame.fragment.end());
    } else if (name == "von_mises") {
        fill([&](std::size_t i) { return von_mises(stress_of(frame, i)); });
    } else if (name == "pressure") {
        fill([&](std::size_t i) { return -stress_of(frame, i).trace() / 3.0; });
    } else if (name == "principal_difference") {
        fill([&](std::size_t i) { return principal_difference(stress_of(frame, i), frame.dimension); });
    } else {
        const auto k =
            static_cast<std::size_t>(stress_index(name.substr(name.find('_') + 1), frame.dimension));
        fill([&](std::size_t i) { return frame.stress[i * (d == 2 ? 4 : 6) + k]; });
    }
    return values;
}

}  // namespace quern
