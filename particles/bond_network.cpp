#include "particles/bond_network.hpp"

#include <fmt/format.h>

#include <cmath>

#include "grid/error.hpp"
#include "particles/bond_energy.hpp"
#include "particles/stable_step.hpp"
#include "particles/strain.hpp"

namespace quern {

template <int Dim>
BondNetwork<Dim>::BondNetwork(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel)
    : material_(material),
      kernel_(kernel),
      bonds_(make_bonds(shape, material)),
      limit_(make_break_limit<Dim>(material, bonds_)) {
    const auto check = [&](const char* key, double value) {
        if (!(value > 0.0))
            throw InputError(fmt::format("material '{}': {}", material.name, key),
                             fmt::format("{:.6g}", value), "a positive number");
    };
    check("density", material.density);
    check("bulk_modulus", material.bulk_modulus);
    check("shear_modulus", material.shear_modulus);
}

template <int Dim>
void BondNetwork<Dim>::set_stiffness(BondStiffness stiffness) {
    stiffness_ = std::move(stiffness);
    fast_ = BondKernel<Dim>(bonds_, stiffness_);
    if (kernel_.kernel == Kernel::fast && kernel_.batches)
        batch_ = BondBatch<Dim>(bonds_, stiffness_, kernel_.instructions);

    const std::size_t n = bonds_.X.size();
    std::vector<double> mass(n * Dim);
    for (std::size_t k = 0; k < mass.size(); ++k) mass[k] = material_.density * bonds_.volume[k / Dim];
    max_frequency_ = quern::max_frequency(mass, [&](const std::vector<double>& u, std::vector<double>& f) {
        // [n * Dim] numbers and [n] vectors are the same memory: Vec<Dim> is Dim packed doubles.
        static_assert(sizeof(Vec<Dim>) == Dim * sizeof(double));
        add_linear_forces({reinterpret_cast<const Vec<Dim>*>(u.data()), n},
                          {reinterpret_cast<Vec<Dim>*>(f.data()), n});
    });
}

template <int Dim>
void BondNetwork<Dim>::add_damping_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const {
    if (material_.bond_damping > 0.0) fast_.add_viscous_forces(grain, material_.bond_damping, f);
}

template <int Dim>
void BondNetwork<Dim>::add_linear_forces(std::span<const Vec<Dim>> u, std::span<Vec<Dim>> f) const {
    fast_.add_linear_forces(bonds_.X, u, f);
}

template <int Dim>
double BondNetwork<Dim>::elastic_energy(const GrainView<Dim>& grain) const {
    if (kernel_.kernel == Kernel::fast) return fast_.elastic_energy(grain);
    double energy = 0.0;
    for (int i = 0; i < bonds_.n_nodes(); ++i) {
        double dilatation = 0.0;
        for (const auto [j, b] : bonds_.family_of(i)) {
            if (!is_alive(grain, b)) continue;
            const double xi = bonds_.length[b], e = bond_vector(grain, i, j).norm() - xi;
            energy += 0.25 * stiffness_.bond[b] * e * e;  // half of the bond's; its other end adds the rest
            dilatation += bonds_.weight[b] * bonds_.volume[i] * bonds_.volume[j] * xi * e;
        }
        if (!stiffness_.node.empty()) energy += 0.5 * stiffness_.node[i] * dilatation * dilatation;
    }
    return std::pow(grain.scale, Dim) * energy;
}

template <int Dim>
int BondNetwork<Dim>::break_bonds(const GrainView<Dim>& grain, std::span<std::uint8_t> alive) const {
    if (!limit_.bounds_stretch()) return 0;
    const double up_to = grain.scale * limit_.longest(grain.scale, grain.strength);
    const double down_to = grain.scale * limit_.shortest(grain.scale, grain.strength);
    int n_broken = 0;
    for (int i = 0; i < bonds_.n_nodes(); ++i)
        for (int b = bonds_.first[i]; b < bonds_.first[i + 1]; ++b) {
            const double longest = up_to * bonds_.length[b], shortest = down_to * bonds_.length[b];
            const double squared = (grain.x[bonds_.partner[b]] - grain.x[i]).squaredNorm();
            if ((alive[b] & 1) == 0 || (squared <= longest * longest && squared >= shortest * shortest))
                continue;
            if (never_breaks(grain, b)) continue;
            alive[b] = 0;
            ++n_broken;
        }
    return n_broken;
}

template <int Dim>
int BondNetwork<Dim>::break_by_energy(const GrainView<Dim>& grain, std::span<BondWork> works,
                                      std::span<std::uint8_t> alive) const {
    return quern::break_by_energy(bonds_, stiffness_, limit_, grain, works, alive);
}

template <int Dim>
void BondNetwork<Dim>::compute_damage(const GrainView<Dim>& grain, std::span<double> damage) const {
    for (int i = 0; i < bonds_.n_nodes(); ++i) {
        double whole = 0.0, broken = 0.0;
        for (const auto [j, b] : bonds_.family_of(i)) {
            if (!was_whole(grain, b)) continue;
            whole += bonds_.volume[j];
            if (!is_alive(grain, b)) broken += bonds_.volume[j];
        }
        damage[i] = broken > 0.0 ? broken / whole : 0.0;
    }
}

template <int Dim>
void BondNetwork<Dim>::compute_relative_stretch(const GrainView<Dim>& grain,
                                                std::span<double> stretch) const {
    std::fill(stretch.begin(), stretch.end(), 0.0);
    const double critical = limit_.stretch_of(grain.scale, grain.strength);
    for (int i = 0; i < bonds_.n_nodes(); ++i)
        for (int b = bonds_.first[i]; b < bonds_.first[i + 1]; ++b) {
            if (!was_whole(grain, b) || never_breaks(grain, b)) continue;
            const int j = bonds_.partner[b];
            double s = bond_vector(grain, i, j).norm() / bonds_.length[b] - 1.0;
            if (limit_.in_compression) s = std::abs(s);
            s /= critical;
            if (!grain.works.empty() && is_alive(grain, b) && s > 0.0)
                s = std::sqrt(std::max(0.0, grain.works[b].work) /
                              critical_work(stiffness_.bond[b], bonds_.length[b], critical));
            stretch[i] = std::max(stretch[i], s);
            stretch[j] = std::max(stretch[j], s);
        }
}

template <int Dim>
void BondNetwork<Dim>::compute_stress(const GrainView<Dim>& grain, std::span<double> stress) const {
    for (int i = 0; i < bonds_.n_nodes(); ++i) {
        // By hand: the outer products of Eigen go through memory here and cost three times as much.
        double shape_sum[Dim][Dim] = {}, stretched_sum[Dim][Dim] = {};
        for (const auto [j, b] : bonds_.family_of(i)) {
            if (!is_alive(grain, b)) continue;
            const double w = bonds_.weight[b] * bonds_.volume[j];
            for (int c = 0; c < Dim; ++c) {
                const double weighted = w * (bonds_.X[j][c] - bonds_.X[i][c]);
                for (int a = 0; a < Dim; ++a) {
                    shape_sum[c][a] += weighted * (bonds_.X[j][a] - bonds_.X[i][a]);
                    stretched_sum[c][a] += weighted * (grain.x[j][a] - grain.x[i][a]);
                }
            }
        }
        const Mat<Dim> shape = Eigen::Map<const Mat<Dim>>(shape_sum[0]);
        const Mat<Dim> stretched = Eigen::Map<const Mat<Dim>>(stretched_sum[0]) / grain.scale;
        double* const out = stress.data() + static_cast<std::size_t>(i) * n_stress<Dim>;
        std::fill_n(out, n_stress<Dim>, 0.0);
        if (shape.determinant() <= 1e-6 * std::pow(shape.trace() / Dim, Dim)) continue;
        const Mat<Dim> F = stretched * shape.inverse();
        compute_cauchy_stress<Dim>(F, material_, out);
    }
}

template class BondNetwork<2>;
template class BondNetwork<3>;

}  // namespace quern
