#include "particles/lps.hpp"

#include "particles/influence.hpp"
#include "particles/strain.hpp"

namespace quern {

template <int Dim>
Lps<Dim>::Lps(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel)
    : BondNetwork<Dim>(shape, material, kernel) {
    const Bonds<Dim>& bonds = this->bonds_;
    const bool space = uses_space_constants<Dim>(material);
    n_ = space ? 3.0 : 2.0;
    a_ = (space ? 15.0 : 8.0) * material.shear_modulus;
    b_ = n_ * (space ? material.bulk_modulus : dilatational_modulus<Dim>(material)) - a_ / n_;
    m_ = bonds.moment;
    if (material.calibration == Calibration::none)
        m_.assign(m_.size(), weighted_ball_volume<Dim>(material.influence, bonds.horizon));

    BondStiffness stiffness;
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        stiffness.node.push_back(n_ * b_ / (m_[i] * m_[i] * bonds.volume[i]));
        stiffness.end.push_back(a_ / m_[i]);
        for (int k = bonds.first[i]; k < bonds.first[i + 1]; ++k) {
            const int j = bonds.partner[k];
            stiffness.bond.push_back(bonds.weight[k] * bonds.volume[i] * bonds.volume[j] *
                                     (a_ / m_[i] + a_ / m_[j]));
        }
    }
    this->set_stiffness(std::move(stiffness));
}

template <int Dim>
void Lps<Dim>::add_internal_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const {
    if (this->kernel_.kernel == Kernel::reference) return add_printed_forces(grain, f);
    this->fast_.add_elastic_forces(grain, f);
}

template <int Dim>
void Lps<Dim>::add_printed_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const {
    const Bonds<Dim>& bonds = this->bonds_;
    std::vector<double> theta(bonds.X.size(), 0.0);
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (const auto [j, k] : bonds.family_of(i)) {
            if (!this->is_alive(grain, k)) continue;
            const double xi = bonds.length[k], e = this->bond_vector(grain, i, j).norm() - xi;
            theta[i] += n_ / m_[i] * bonds.weight[k] * xi * e * bonds.volume[j];
        }
    this->add_reference_forces(grain, f, [&](int i, int j, int k, double now) {
        const double w = bonds.weight[k], xi = bonds.length[k], e = now - xi;
        const double t_ij = w / m_[i] * (b_ * theta[i] * xi + a_ * e);
        const double t_ji = w / m_[j] * (b_ * theta[j] * xi + a_ * e);
        return t_ij + t_ji;
    });
}

template class Lps<2>;
template class Lps<3>;

}  // namespace quern
