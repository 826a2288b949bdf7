#include "contact/fill_slot.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

#include "grid/shape_functions.hpp"

namespace quern {

namespace {

/// Below this least moment of inertia [m length^2] particles are a point or a line and do not turn.
constexpr double degenerate_inertia = 1e-3;

/// Particles near a node, component by component: what is done with them needs no branch.
template <int Dim>
struct Bunch {
    static constexpr int size = 64;
    using Packs = std::array<Pack, size / pack_size>;
    std::array<Packs, Dim> d;  ///< x_p - x_a [m]
    Packs V, m, q;             ///< volume, mass, factor of the weight
    Packs N, w, mw;            ///< linear function, weight in the slot, m w
    std::array<int, size> particle, surface;
    int count = 0;

    static double& at(Packs& packs, int k) { return packs[k / pack_size][k % pack_size]; }

    /// Takes candidates that are in reach of the quadratic functions, until it is full; returns what is left.
    /// Others must not take a lane: lists differ with the time of the search, sums may not.
    std::span<const Candidate> load(const ContactScene<Dim>& scene, const Grain<Dim>& grain,
                                    const Vec<Dim>& x_node, double h, double inside,
                                    std::span<const Candidate> candidates) {
        const double reach = 1.5 * h;
        std::size_t next = 0;
        for (count = 0; next < candidates.size() && count < size; ++next) {
            const bool on_surface = candidates[next] < 0;
            const int i = on_surface ? grain.shape->surface[-1 - candidates[next]].node : candidates[next];
            const int p = grain.first + i;
            const Vec<Dim> r = scene.x[p] - x_node;
            particle[count] = p;
            surface[count] = on_surface ? -1 - candidates[next] : -1;
            for (int a = 0; a < Dim; ++a) at(d[a], count) = r[a];
            at(V, count) = scene.volume[p];
            at(m, count) = scene.mass[p];
            at(q, count) = on_surface ? 1.0 : inside;
            count += r.cwiseAbs().maxCoeff() < reach ? 1 : 0;
        }
        for (int k = count; k % pack_size != 0; ++k) {  // nothing stands on the node
            for (int a = 0; a < Dim; ++a) at(d[a], k) = 0.0;
            at(V, k) = at(m, k) = at(q, k) = 0.0;
        }
        return candidates.subspan(next);
    }
};

/// Sums over the particles of a slot.
template <int Dim>
struct SlotSums {
    Pack volume = Pack::Zero(), m = Pack::Zero();
    std::array<Pack, Dim> slope, md;             ///< V times gradient, m w d
    std::array<std::array<Pack, Dim>, Dim> mdd;  ///< m w d d^T, upper half

    SlotSums() {
        slope.fill(Pack::Zero());
        md.fill(Pack::Zero());
        for (std::array<Pack, Dim>& row : mdd) row.fill(Pack::Zero());
    }

    /// Weighs four particles and adds them.
    void add(Bunch<Dim>& bunch, int k, double per_h, bool nodal) {
        std::array<Pack, Dim> B, dB;
        Pack N = Pack::Ones();
        for (int a = 0; a < Dim; ++a) {
            const Pack t = bunch.d[a][k] * per_h;
            B[a] = quadratic_shape(t);
            dB[a] = quadratic_slope(t);
            N *= linear_shape(t);
        }
        const Pack w = bunch.q[k] * (nodal ? N : Pack(N * N));
        const Pack mw = bunch.m[k] * w;
        bunch.N[k] = N;
        bunch.w[k] = w;
        bunch.mw[k] = mw;
        volume += N * bunch.V[k];
        m += mw;
        for (int a = 0; a < Dim; ++a) {
            Pack product = bunch.V[k] * dB[a];
            for (int b = 0; b < Dim; ++b)
                if (b != a) product *= B[b];
            slope[a] += product;
            const Pack first = mw * bunch.d[a][k];
            md[a] += first;
            for (int b = a; b < Dim; ++b) mdd[a][b] += first * bunch.d[b][k];
        }
    }
};

}  // namespace

bool invert_inertia(const Mat<2>& second, double m, double length, Eigen::Matrix<double, 1, 1>& Y) {
    const double inertia = second.trace();
    const bool usable = m > 0.0 && inertia >= degenerate_inertia * m * length * length;
    Y(0, 0) = usable ? 1.0 / inertia : 0.0;
    return usable;
}

bool invert_inertia(const Mat<3>& second, double m, double length, Mat<3>& Y) {
    const Mat<3> inertia = second.trace() * Mat<3>::Identity() - second;
    Eigen::SelfAdjointEigenSolver<Mat<3>> eigen;
    eigen.computeDirect(inertia, Eigen::EigenvaluesOnly);
    const bool usable = m > 0.0 && eigen.eigenvalues()[0] >= degenerate_inertia * m * length * length;
    Y = usable ? Mat<3>(inertia.inverse()) : Mat<3>(Mat<3>::Zero());
    return usable;
}

template <int Dim>
void fill_slot(const ContactScene<Dim>& scene, const CartesianGrid<Dim>& grid, const SlotWeights& weights,
               std::span<const Candidate> candidates, Slot<Dim>& slot, Support<Dim>* support) {
    const double per_h = 1.0 / grid.h();
    const Grain<Dim>& grain = scene.grains[slot.grain];
    const Vec<Dim> x_node = grid.node_position(slot.index);
    Bunch<Dim> bunch;
    SlotSums<Dim> sums;
    int n = 0;
    while (!candidates.empty()) {
        candidates = bunch.load(scene, grain, x_node, grid.h(), weights.nodal ? 1.0 : weights.interior_weight,
                                candidates);
        for (int k = 0; k * pack_size < bunch.count; ++k) sums.add(bunch, k, per_h, weights.nodal);
        for (int k = 0; k < bunch.count; ++k) {
            Support<Dim>& e =
                support[n];  // written over by the next one, unless it has the node in its reach
            e.particle = bunch.particle[k];
            e.surface = bunch.surface[k];
            e.N = bunch.at(bunch.N, k);
            e.w = bunch.at(bunch.w, k);
            e.mw = bunch.at(bunch.mw, k);
            for (int a = 0; a < Dim; ++a) e.d[a] = bunch.at(bunch.d[a], k);
            n += e.N > 0.0 ? 1 : 0;
        }
    }
    slot.support = support;
    slot.n_support = n;
    slot.volume = sum(sums.volume);
    slot.m = sum(sums.m);
    for (int a = 0; a < Dim; ++a) {
        slot.gradient[a] = -per_h * sum(sums.slope[a]);  // by the node: minus by the point
        slot.xb[a] = slot.m > 0.0 ? sum(sums.md[a]) / slot.m : 0.0;
    }
    Mat<Dim> second;
    for (int a = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b)
            second(a, b) = second(b, a) = sum(sums.mdd[a][b]) - slot.m * slot.xb[a] * slot.xb[b];
    slot.rotates = weights.rotation && invert_inertia(second, slot.m, grid.h(), slot.Y);
}

template void fill_slot<2>(const ContactScene<2>&, const CartesianGrid<2>&, const SlotWeights&,
                           std::span<const Candidate>, Slot<2>&, Support<2>*);
template void fill_slot<3>(const ContactScene<3>&, const CartesianGrid<3>&, const SlotWeights&,
                           std::span<const Candidate>, Slot<3>&, Support<3>*);

}  // namespace quern
