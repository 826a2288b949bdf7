#include "particles/bond_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace quern {

struct BondSlots {
    int n, n_slots, longest_row;
    const int* row;
    const int* first;
    const int* partner;
    const double* length;
    const double* weight;
    const double* bond;
    const double* node;
};

namespace {

constexpr int lanes = 4;  // doubles in an AVX2 vector

/// Arrays of one thread, grown to the largest grain it has met and then kept.
template <int Dim>
struct Scratch {
    std::vector<double> x[Dim], v[Dim], f[Dim];  // [n]
    std::vector<double> dilatation;              // [n] D, then P
    std::vector<double> shortness;               // [n_slots] q = xi/|y|
    std::vector<double> rate;                    // [n_slots] rate of extension over |y|
    std::vector<double> mask;                    // [n_slots] 1 or 0
    std::vector<double> row[Dim];                // [longest row] what a row gives to its partners

    void fit(std::size_t n, std::size_t n_slots, std::size_t longest, bool with_rate, bool with_mask) {
        for (int d = 0; d < Dim; ++d) {
            grow(x[d], n);
            grow(f[d], n);
            if (with_rate) grow(v[d], n);
            grow(row[d], longest);
        }
        grow(dilatation, n);
        grow(shortness, n_slots);
        if (with_rate) grow(rate, n_slots);
        if (with_mask) grow(mask, n_slots);
    }
    static void grow(std::vector<double>& a, std::size_t size) {
        if (a.size() < size) a.resize(size);
    }
};

/// A grain over its scale, and which of its slots are intact, into the arrays of the thread.
template <int Dim, bool with_rate>
void load(const GrainView<Dim>& grain, const BondSlots& s, Scratch<Dim>& scratch) {
    const bool masked = !grain.alive.empty();
    scratch.fit(s.n, s.n_slots, s.longest_row, with_rate, masked);
    // From the first node: differences of nearby numbers are exact, so a grain far from the origin loses
    // no digits in the division by its scale.
    const Vec<Dim> base = grain.x[0];
    const double inverse = 1.0 / grain.scale;
    for (int i = 0; i < s.n; ++i)
        for (int d = 0; d < Dim; ++d) {
            scratch.x[d][i] = (grain.x[i][d] - base[d]) * inverse;
            if constexpr (with_rate) scratch.v[d][i] = grain.v[i][d] * inverse;
        }
    if (!masked) return;
    for (int i = 0; i < s.n; ++i) {
        const int bond = s.first[i], size = s.first[i + 1] - bond;
        for (int k = 0; k < size; ++k) scratch.mask[s.row[i] + k] = grain.alive[bond + k] ? 1.0 : 0.0;
        for (int slot = s.row[i] + size; slot < s.row[i + 1]; ++slot) scratch.mask[slot] = 0.0;
    }
}

/// Pass 1: q (and the rate) of every slot, D at both ends of every bond.
template <int Dim, bool with_rate, bool masked>
void compute_dilatation(const BondSlots& s, Scratch<Dim>& scratch) {
    const int* const __restrict partner = s.partner;
    const double* const __restrict length = s.length;
    const double* const __restrict weight = s.weight;
    const double* const __restrict mask = scratch.mask.data();
    const double* const __restrict x = scratch.x[0].data();
    const double* const __restrict y = scratch.x[1].data();
    const double* const __restrict z = scratch.x[Dim - 1].data();
    const double* const __restrict vx = scratch.v[0].data();
    const double* const __restrict vy = scratch.v[1].data();
    const double* const __restrict vz = scratch.v[Dim - 1].data();
    double* const __restrict shortness = scratch.shortness.data();
    double* const __restrict rate = scratch.rate.data();
    double* const __restrict given = scratch.row[0].data();
    double* const __restrict D = scratch.dilatation.data();

    std::fill_n(D, s.n, 0.0);
    for (int i = 0; i < s.n; ++i) {
        const int begin = s.row[i], size = (s.row[i + 1] - begin) / lanes * lanes;
        const double xi = x[i], yi = y[i], zi = z[i];
        double own = 0.0;
#pragma omp simd reduction(+ : own)
        for (int k = 0; k < size; ++k) {
            const int b = begin + k, j = partner[b];
            const double dx = x[j] - xi, dy = y[j] - yi, dz = Dim == 3 ? z[j] - zi : 0.0;
            const double now = std::sqrt(Dim == 3 ? dx * dx + dy * dy + dz * dz : dx * dx + dy * dy);
            const double q = length[b] / now;
            shortness[b] = q;
            double e = now - length[b];
            if constexpr (with_rate) {
                const double opening =
                    dx * (vx[j] - vx[i]) + dy * (vy[j] - vy[i]) + (Dim == 3 ? dz * (vz[j] - vz[i]) : 0.0);
                rate[b] = opening / (now * now);
                e = opening / now;
            }
            double term = weight[b] * length[b] * e;
            if constexpr (masked) term *= mask[b];
            given[k] = term;
            own += term;
        }
        for (int k = 0; k < size; ++k) D[partner[begin + k]] += given[k];
        D[i] += own;
    }
}

/// Pass 2: force at both ends. Without dilatation it needs no first pass and finds q itself.
template <int Dim, bool with_rate, bool masked, bool dilating>
void compute_forces(const BondSlots& s, Scratch<Dim>& scratch) {
    const int* const __restrict partner = s.partner;
    const double* const __restrict length = s.length;
    const double* const __restrict weight = s.weight;
    const double* const __restrict bond = s.bond;
    const double* const __restrict mask = scratch.mask.data();
    const double* const __restrict x = scratch.x[0].data();
    const double* const __restrict y = scratch.x[1].data();
    const double* const __restrict z = scratch.x[Dim - 1].data();
    const double* const __restrict vx = scratch.v[0].data();
    const double* const __restrict vy = scratch.v[1].data();
    const double* const __restrict vz = scratch.v[Dim - 1].data();
    const double* const __restrict shortness = scratch.shortness.data();
    const double* const __restrict rate = scratch.rate.data();
    const double* const __restrict P = scratch.dilatation.data();
    double* const __restrict given_x = scratch.row[0].data();
    double* const __restrict given_y = scratch.row[1].data();
    double* const __restrict given_z = scratch.row[Dim - 1].data();
    double* const __restrict fx = scratch.f[0].data();
    double* const __restrict fy = scratch.f[1].data();
    double* const __restrict fz = scratch.f[Dim - 1].data();

    for (int d = 0; d < Dim; ++d) std::fill_n(scratch.f[d].data(), s.n, 0.0);
    for (int i = 0; i < s.n; ++i) {
        const int begin = s.row[i], size = (s.row[i + 1] - begin) / lanes * lanes;
        const double xi = x[i], yi = y[i], zi = z[i], Pi = dilating ? P[i] : 0.0;
        double own_x = 0.0, own_y = 0.0, own_z = 0.0;
#pragma omp simd reduction(+ : own_x, own_y, own_z)
        for (int k = 0; k < size; ++k) {
            const int b = begin + k, j = partner[b];
            const double dx = x[j] - xi, dy = y[j] - yi, dz = Dim == 3 ? z[j] - zi : 0.0;
            double pull;  // force over |y|
            if constexpr (dilating) {
                const double q = shortness[b];
                pull = weight[b] * q * (Pi + P[j]) + bond[b] * (with_rate ? rate[b] : 1.0 - q);
            } else {
                const double now2 = Dim == 3 ? dx * dx + dy * dy + dz * dz : dx * dx + dy * dy;
                if constexpr (with_rate) {
                    const double opening =
                        dx * (vx[j] - vx[i]) + dy * (vy[j] - vy[i]) + (Dim == 3 ? dz * (vz[j] - vz[i]) : 0.0);
                    pull = bond[b] * opening / now2;
                } else {
                    pull = bond[b] * (1.0 - length[b] / std::sqrt(now2));
                }
            }
            if constexpr (masked) pull *= mask[b];
            own_x += pull * dx;
            own_y += pull * dy;
            given_x[k] = pull * dx;
            given_y[k] = pull * dy;
            if constexpr (Dim == 3) {
                own_z += pull * dz;
                given_z[k] = pull * dz;
            }
        }
        for (int k = 0; k < size; ++k) {
            const int j = partner[begin + k];
            fx[j] -= given_x[k];
            fy[j] -= given_y[k];
            if constexpr (Dim == 3) fz[j] -= given_z[k];
        }
        fx[i] += own_x;
        fy[i] += own_y;
        if constexpr (Dim == 3) fz[i] += own_z;
    }
}

template <int Dim, bool with_rate, bool masked>
void evaluate(const BondSlots& s, Scratch<Dim>& scratch) {
    if (s.node == nullptr) return compute_forces<Dim, with_rate, masked, false>(s, scratch);
    compute_dilatation<Dim, with_rate, masked>(s, scratch);
    for (int i = 0; i < s.n; ++i) scratch.dilatation[i] *= s.node[i];
    compute_forces<Dim, with_rate, masked, true>(s, scratch);
}

/// E of a grain of scale 1. A row finds its own D complete at its end: partners come later in the list.
template <int Dim, bool masked>
double sum_energy(const BondSlots& s, Scratch<Dim>& scratch) {
    const int* const __restrict partner = s.partner;
    const double* const __restrict length = s.length;
    const double* const __restrict weight = s.weight;
    const double* const __restrict bond = s.bond;
    const double* const __restrict mask = scratch.mask.data();
    const double* const __restrict x = scratch.x[0].data();
    const double* const __restrict y = scratch.x[1].data();
    const double* const __restrict z = scratch.x[Dim - 1].data();
    double* const __restrict given = scratch.row[0].data();
    double* const __restrict D = scratch.dilatation.data();

    std::fill_n(D, s.n, 0.0);
    double twice = 0.0;
    for (int i = 0; i < s.n; ++i) {
        const int begin = s.row[i], size = (s.row[i + 1] - begin) / lanes * lanes;
        const double xi = x[i], yi = y[i], zi = z[i];
        double own = 0.0, stretched = 0.0;
#pragma omp simd reduction(+ : own, stretched)
        for (int k = 0; k < size; ++k) {
            const int b = begin + k, j = partner[b];
            const double dx = x[j] - xi, dy = y[j] - yi, dz = Dim == 3 ? z[j] - zi : 0.0;
            double e = std::sqrt(Dim == 3 ? dx * dx + dy * dy + dz * dz : dx * dx + dy * dy) - length[b];
            if constexpr (masked) e *= mask[b];
            const double term = weight[b] * length[b] * e;
            given[k] = term;
            own += term;
            stretched += bond[b] * e * e;
        }
        twice += stretched;
        if (s.node == nullptr) continue;
        for (int k = 0; k < size; ++k) D[partner[begin + k]] += given[k];
        own += D[i];
        twice += s.node[i] * own * own;
    }
    return 0.5 * twice;
}

template <int Dim>
Scratch<Dim>& scratch_of_thread() {
    thread_local Scratch<Dim> scratch;
    return scratch;
}

}  // namespace

template <int Dim>
BondKernel<Dim>::BondKernel(const Bonds<Dim>& bonds, const BondStiffness& stiffness)
    : first_(bonds.first), node_(stiffness.node) {
    const int n = bonds.n_nodes();
    row_.assign(1, 0);
    for (int i = 0; i < n; ++i) {
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            partner_.push_back(bonds.partner[b]);
            length_.push_back(bonds.length[b]);
            weight_.push_back(bonds.weight[b] * bonds.volume[i] * bonds.volume[bonds.partner[b]]);
            bond_.push_back(stiffness.bond[b]);
        }
        // Padding points at a true partner, so that its length never vanishes, and carries no stiffness.
        while (partner_.size() % lanes != 0) {
            partner_.push_back(partner_.back());
            length_.push_back(length_.back());
            weight_.push_back(0.0);
            bond_.push_back(0.0);
        }
        row_.push_back(static_cast<int>(partner_.size()));
        longest_row_ = std::max(longest_row_, row_[i + 1] - row_[i]);
    }
}

template <int Dim>
BondSlots BondKernel<Dim>::slots() const {
    return {static_cast<int>(row_.size()) - 1,
            static_cast<int>(partner_.size()),
            longest_row_,
            row_.data(),
            first_.data(),
            partner_.data(),
            length_.data(),
            weight_.data(),
            bond_.data(),
            node_.empty() ? nullptr : node_.data()};
}

template <int Dim>
template <bool rate>
void BondKernel<Dim>::add_forces(const GrainView<Dim>& grain, double factor, std::span<Vec<Dim>> f) const {
    Scratch<Dim>& scratch = scratch_of_thread<Dim>();
    const BondSlots all = slots();
    load<Dim, rate>(grain, all, scratch);
    if (grain.alive.empty())
        evaluate<Dim, rate, false>(all, scratch);
    else
        evaluate<Dim, rate, true>(all, scratch);
    const double back = factor * std::pow(grain.scale, Dim - 1);
    for (int i = 0; i < all.n; ++i)
        for (int d = 0; d < Dim; ++d) f[i][d] += back * scratch.f[d][i];
}

template <int Dim>
double BondKernel<Dim>::elastic_energy(const GrainView<Dim>& grain) const {
    Scratch<Dim>& scratch = scratch_of_thread<Dim>();
    const BondSlots all = slots();
    load<Dim, false>(grain, all, scratch);
    const double energy =
        grain.alive.empty() ? sum_energy<Dim, false>(all, scratch) : sum_energy<Dim, true>(all, scratch);
    return std::pow(grain.scale, Dim) * energy;
}

template <int Dim>
void BondKernel<Dim>::add_elastic_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const {
    add_forces<false>(grain, 1.0, f);
}

template <int Dim>
void BondKernel<Dim>::add_viscous_forces(const GrainView<Dim>& grain, double time,
                                         std::span<Vec<Dim>> f) const {
    add_forces<true>(grain, time, f);
}

template <int Dim>
void BondKernel<Dim>::add_linear_forces(std::span<const Vec<Dim>> X, std::span<const Vec<Dim>> u,
                                        std::span<Vec<Dim>> f) const {
    add_forces<true>({.scale = 1.0, .x = X, .v = u, .alive = {}}, 1.0, f);
}

template class BondKernel<2>;
template class BondKernel<3>;

}  // namespace quern
