#include "particles/bond_based.hpp"

#include <fmt/format.h>

#include "grid/error.hpp"
#include "particles/influence.hpp"
#include "particles/strain.hpp"

namespace quern {
namespace {

/// The material with the shear modulus that springs of its bulk modulus have.
template <int Dim>
Material made_of_springs(const Material& material) {
    const bool thin = Dim == 2 && material.plane == PlaneState::stress;
    Material springs = material;
    springs.shear_modulus = (thin ? 3.0 / 8.0 : 3.0 / 5.0) * material.bulk_modulus;
    if (!(std::abs(material.shear_modulus / springs.shear_modulus - 1.0) < 0.01))
        throw InputError(
            fmt::format("material '{}': shear_modulus", material.name),
            fmt::format("{:.6g} Pa", material.shear_modulus),
            fmt::format("{:.6g} Pa, {} of the bulk modulus", springs.shear_modulus, thin ? "3/8" : "3/5"),
            fmt::format("bond_based has a Poisson ratio of {}; lps takes any", thin ? "1/3" : "1/4"));
    return springs;
}

}  // namespace

template <int Dim>
BondBased<Dim>::BondBased(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel)
    : BondNetwork<Dim>(shape, made_of_springs<Dim>(material), kernel) {
    const Bonds<Dim>& bonds = this->bonds_;
    const double m = material.calibration == Calibration::discrete
                         ? bonds.bulk_moment
                         : weighted_ball_volume<Dim>(material.influence, bonds.horizon);
    C_ = (Dim == 2 ? 8.0 : 18.0) * dilatational_modulus<Dim>(this->material_) / m;

    BondStiffness stiffness;
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (int k = bonds.first[i]; k < bonds.first[i + 1]; ++k)
            stiffness.bond.push_back(C_ * bonds.weight[k] * bonds.volume[i] * bonds.volume[bonds.partner[k]]);
    this->set_stiffness(std::move(stiffness));
}

template <int Dim>
void BondBased<Dim>::add_internal_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const {
    if (this->kernel_.kernel == Kernel::fast) return this->fast_.add_elastic_forces(grain, f);
    const Bonds<Dim>& bonds = this->bonds_;
    this->add_reference_forces(grain, f, [&](int, int, int k, double now) {
        return C_ * bonds.weight[k] * (now - bonds.length[k]);
    });
}

template class BondBased<2>;
template class BondBased<3>;

}  // namespace quern
