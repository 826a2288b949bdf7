#include "particles/break_limit.hpp"

#include <numbers>

#include "particles/influence.hpp"
#include "particles/strain.hpp"

namespace quern {
namespace {

/// int w xi^(Dim + 1) / int w xi^(Dim + 2) [1/m]
template <int Dim>
double ratio_of_integrals(const Material& material, double horizon) {
    return influence_moment(material.influence, Dim + 1) /
           (influence_moment(material.influence, Dim + 2) * horizon);
}

/// The same of the sums over full families; 0 if there is none.
template <int Dim>
double ratio_of_sums(const Bonds<Dim>& bonds) {
    double second = 0.0, third = 0.0;
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        if (bonds.moment[i] < 0.999 * bonds.bulk_moment) continue;
        second += bonds.moment[i];
        for (const auto [j, b] : bonds.family_of(i))
            third += bonds.weight[b] * std::pow(bonds.length[b], 3) * bonds.volume[j];
    }
    return third > 0.0 ? second / third : 0.0;
}

template <int Dim>
double critical_stretch(const Material& material, double horizon, double ratio) {
    const bool as_springs = material.breaks_by == BreaksBy::energy;
    const double G = material.shear_modulus, Gc = material.fracture_energy;
    const double K = as_springs ? 5.0 / 3.0 * G : material.bulk_modulus;
    if (material.critical_stretch_formula == StretchFormula::peridem)
        return std::sqrt(Gc / ((3.0 * G + std::pow(0.75, 4) * (K - 5.0 / 3.0 * G)) * horizon));
    if constexpr (Dim == 3) return std::sqrt(4.0 / 9.0 * Gc / K * ratio);
    const double K2 = uses_space_constants<2>(material) ? 9.0 / 4.0 * K
                      : as_springs                      ? 2.0 * G
                                                        : dilatational_modulus<2>(material);
    return std::sqrt(std::numbers::pi / 4.0 * Gc / K2 * ratio);
}

template <int Dim>
BreakLimit make_limit(const Material& material, double horizon, double ratio) {
    BreakLimit limit;
    limit.by_energy = material.fracture_energy > 0.0;
    limit.stretch =
        limit.by_energy ? critical_stretch<Dim>(material, horizon, ratio) : material.critical_stretch;
    limit.in_compression = material.breaks_in == BreaksIn::both;
    limit.by_work = material.breaks_by == BreaksBy::energy && material.model != ForceModel::bond_based;
    return limit;
}

}  // namespace

template <int Dim>
BreakLimit make_break_limit(const Material& material, double horizon) {
    return make_limit<Dim>(material, horizon, ratio_of_integrals<Dim>(material, horizon));
}

template <int Dim>
BreakLimit make_break_limit(const Material& material, const Bonds<Dim>& bonds) {
    const double ratio = material.calibration == Calibration::discrete ? ratio_of_sums(bonds) : 0.0;
    if (ratio == 0.0) return make_break_limit<Dim>(material, bonds.horizon);
    return make_limit<Dim>(material, bonds.horizon, ratio);
}

template BreakLimit make_break_limit<2>(const Material&, double);
template BreakLimit make_break_limit<3>(const Material&, double);
template BreakLimit make_break_limit(const Material&, const Bonds<2>&);
template BreakLimit make_break_limit(const Material&, const Bonds<3>&);

}  // namespace quern
