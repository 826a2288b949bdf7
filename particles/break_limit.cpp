#include "particles/break_limit.hpp"

#include <numbers>

#include "particles/influence.hpp"
#include "particles/strain.hpp"

namespace quern {
namespace {

template <int Dim>
double critical_stretch(const Material& material, double horizon) {
    const double K = material.bulk_modulus, G = material.shear_modulus, Gc = material.fracture_energy;
    if (material.critical_stretch_formula == StretchFormula::peridem)
        return std::sqrt(Gc / ((3.0 * G + std::pow(0.75, 4) * (K - 5.0 / 3.0 * G)) * horizon));
    const double ratio = influence_moment(material.influence, Dim + 1) /
                         (influence_moment(material.influence, Dim + 2) * horizon);
    if constexpr (Dim == 3) return std::sqrt(4.0 / 9.0 * Gc / K * ratio);
    const double K2 = uses_space_constants<2>(material) ? 9.0 / 4.0 * K : dilatational_modulus<2>(material);
    return std::sqrt(std::numbers::pi / 4.0 * Gc / K2 * ratio);
}

}  // namespace

template <int Dim>
BreakLimit make_break_limit(const Material& material, double horizon) {
    BreakLimit limit;
    limit.by_energy = material.fracture_energy > 0.0;
    limit.stretch = limit.by_energy ? critical_stretch<Dim>(material, horizon) : material.critical_stretch;
    limit.in_compression = material.breaks_in == BreaksIn::both;
    return limit;
}

template BreakLimit make_break_limit<2>(const Material&, double);
template BreakLimit make_break_limit<3>(const Material&, double);

}  // namespace quern
