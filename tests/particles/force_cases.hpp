// The table of internal-force models: every law, plane state and influence function, each tested for the same
// properties.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "particles/peridynamic_model.hpp"
#include "tests/particles/lattice.hpp"

namespace quern::test {

template <int Dim>
using Field = std::vector<Vec<Dim>>;

inline Material make_material(ForceModel model, PlaneState plane, int dim) {
    Material material;
    material.name = "test";
    material.model = model;
    material.plane = plane;
    material.density = 3000.0;
    material.bulk_modulus = 10e6;
    const double springs = dim == 2 && plane == PlaneState::stress ? 3.0 / 8.0 : 3.0 / 5.0;
    material.shear_modulus = (model == ForceModel::bond_based ? springs : 0.25) * material.bulk_modulus;
    material.horizon_ratio = dim == 2 ? 3.015 : 2.2;
    if (model == ForceModel::peridem) set_peridem_options(material);
    return material;
}

/// visit(material) for all models of this dimension and all influence functions.
template <int Dim, class Visit>
void for_each_material(Visit&& visit) {
    static const char* const influences[] = {"1", "1/r", "1 - r", "Gaussian"};
    static const char* const laws[] = {"LPS", "bond-based", "PeriDEM"};
    for (const ForceModel model : {ForceModel::lps, ForceModel::bond_based, ForceModel::peridem})
        for (const PlaneState plane : {PlaneState::strain, PlaneState::stress}) {
            if (plane == PlaneState::stress && (Dim == 3 || model == ForceModel::peridem)) continue;
            for (const Influence influence :
                 {Influence::constant, Influence::inverse, Influence::conical, Influence::gaussian}) {
                Material material = make_material(model, plane, Dim);
                material.influence = influence;
                CAPTURE(Dim);
                const std::string law = laws[static_cast<int>(model)];
                CAPTURE(law);
                const std::string state = plane == PlaneState::strain ? "plane strain" : "plane stress";
                CAPTURE(state);
                const std::string weight = influences[static_cast<int>(influence)];
                CAPTURE(weight);
                visit(material);
            }
        }
}

/// visit(material) over both dimensions: visit is called with std::integral_constant<int, Dim> and the
/// material.
template <class Visit>
void for_each_case(Visit&& visit) {
    for_each_material<2>([&](const Material& m) { visit(std::integral_constant<int, 2>{}, m); });
    for_each_material<3>([&](const Material& m) { visit(std::integral_constant<int, 3>{}, m); });
}

template <int Dim>
Shape<Dim> make_test_shape() {
    if constexpr (Dim == 2)
        return make_shaken<2>(make_lattice<2>({7, 6}, 0.01), 0.15);
    else
        return make_shaken<3>(make_lattice<3>({5, 4, 4}, 0.01), 0.15);
}

template <int Dim>
Mat<Dim> make_rotation(double angle) {
    if constexpr (Dim == 2)
        return rotation_matrix(Spin<2>(angle));
    else
        return rotation_matrix(Spin<3>(angle * Spin<3>(0.48, -0.6, 0.64)));
}

/// A deformation that is neither small nor uniform: strains of about 5 %.
template <int Dim>
Field<Dim> make_deformed(const Shape<Dim>& shape, double scale) {
    Field<Dim> x;
    const double k = 40.0;
    for (const Vec<Dim>& X : shape.X) {
        Vec<Dim> u;
        for (int d = 0; d < Dim; ++d)
            u[d] = 0.0015 * std::sin(k * X[(d + 1) % Dim] + d) + 0.02 * X[d] - 0.01 * X[(d + 1) % Dim];
        x.push_back(scale * (X + u));
    }
    return x;
}

/// Each bond broken with a chance of one in five; the seed is fixed.
inline std::vector<std::uint8_t> make_broken(int n_bonds) {
    std::mt19937 random(3);
    std::vector<std::uint8_t> alive(n_bonds);
    for (std::uint8_t& bit : alive) bit = random() % 5 != 0;
    return alive;
}

template <int Dim>
Field<Dim> forces(const PeridynamicModel<Dim>& model, const GrainView<Dim>& grain) {
    Field<Dim> f(grain.x.size(), Vec<Dim>::Zero());
    std::visit([&](const auto& law) { law.add_internal_forces(grain, f); }, model);
    return f;
}

template <int Dim>
double energy(const PeridynamicModel<Dim>& model, const GrainView<Dim>& grain) {
    return std::visit([&](const auto& law) { return law.elastic_energy(grain); }, model);
}

template <int Dim>
int count_bonds(const PeridynamicModel<Dim>& model) {
    return std::visit([](const auto& law) { return law.n_bonds(); }, model);
}

/// Linearised forces of displacements u at scale 1.
template <int Dim>
Field<Dim> linear_forces(const PeridynamicModel<Dim>& model, const Field<Dim>& u) {
    Field<Dim> f(u.size(), Vec<Dim>::Zero());
    std::visit([&](const auto& law) { law.add_linear_forces(u, f); }, model);
    return f;
}

/// most = max(most, value), for good infinite once a value is no number.
inline void raise(double& most, double value) {
    if (!(value <= most)) most = std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
}

template <int Dim>
double largest(const Field<Dim>& a) {
    double most = 0.0;
    for (const Vec<Dim>& value : a) raise(most, value.norm());
    return most;
}

template <int Dim>
double largest_difference(const Field<Dim>& a, const Field<Dim>& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) raise(most, (a[i] - b[i]).norm());
    return most;
}

template <int Dim>
double dot(const Field<Dim>& a, const Field<Dim>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

}  // namespace quern::test
