#include "particles/bond_energy.hpp"

#include <algorithm>
#include <vector>

namespace quern {
namespace {

/// Arrays of one thread.
struct Scratch {
    std::vector<double> extension, share;  // [n_bonds] e, d = k xi e
    std::vector<double> coupling, lost;    // [n] g D, and what breaking takes of it
    std::vector<int> broken, ends;         // bonds, and their nodes by twos
};

/// e and d of all bonds, g D of all nodes.
template <int Dim>
void evaluate(const Bonds<Dim>& bonds, const BondStiffness& stiffness, const GrainView<Dim>& grain,
              Scratch& s) {
    s.coupling.assign(bonds.X.size(), 0.0);
    s.extension.resize(bonds.length.size());
    s.share.resize(bonds.length.size());
    const double inverse = 1.0 / grain.scale;
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        const Vec<Dim> x_i = grain.x[i];
        double own = 0.0;
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            const int j = bonds.partner[b];
            const double e = inverse * (grain.x[j] - x_i).norm() - bonds.length[b];
            const double d = bonds.weight[b] * bonds.volume[i] * bonds.volume[j] * bonds.length[b] * e;
            s.extension[b] = e;
            s.share[b] = d;
            if (!grain.alive[b]) continue;
            own += d;
            s.coupling[j] += d;
        }
        s.coupling[i] += own;
    }
    for (int i = 0; i < bonds.n_nodes(); ++i) s.coupling[i] *= stiffness.node[i];
}

/// Without the broken bonds the dilatation pulls less at the others of the same nodes.
template <int Dim>
void relieve_neighbors(const Bonds<Dim>& bonds, const BondStiffness& stiffness, const GrainView<Dim>& grain,
                       std::span<BondWork> works, Scratch& s) {
    s.lost.assign(bonds.X.size(), 0.0);
    for (std::size_t k = 0; k < s.ends.size(); ++k)
        s.lost[s.ends[k]] += stiffness.node[s.ends[k]] * s.share[s.broken[k / 2]];
    std::sort(s.ends.begin(), s.ends.end());
    s.ends.erase(std::unique(s.ends.begin(), s.ends.end()), s.ends.end());
    for (const int i : s.ends)
        for (const auto [j, b] : bonds.family_of(i)) {
            const double k_xi = bonds.weight[b] * bonds.volume[i] * bonds.volume[j] * bonds.length[b];
            if (grain.alive[b]) works[b].force -= k_xi * s.lost[i];
        }
}

}  // namespace

template <int Dim>
int break_by_energy(const Bonds<Dim>& bonds, const BondStiffness& stiffness, const BreakLimit& limit,
                    const GrainView<Dim>& grain, std::span<BondWork> works, std::span<std::uint8_t> alive) {
    thread_local Scratch s;
    evaluate(bonds, stiffness, grain, s);
    s.broken.clear();
    s.ends.clear();
    const double stretch = limit.stretch_of(grain.scale, grain.strength);
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            if (!grain.alive[b]) continue;
            const int j = bonds.partner[b];
            const double e = s.extension[b], c = stiffness.bond[b], xi = bonds.length[b];
            const double k_xi = bonds.weight[b] * bonds.volume[i] * bonds.volume[j] * xi;
            const double force = c * e + k_xi * (s.coupling[i] + s.coupling[j]);
            BondWork& now = works[b];
            now.work += 0.5 * (now.force + force) * (e - now.extension);
            now.extension = e;
            now.force = force;
            if (now.work < critical_work(c, xi, stretch) || (e <= 0.0 && !limit.in_compression)) continue;
            if (!grain.kept.empty() && grain.kept[b]) continue;
            s.broken.push_back(b);
            s.ends.push_back(i);
            s.ends.push_back(j);
        }
    if (s.broken.empty()) return 0;
    for (const int b : s.broken) grain.alive.clear_in(alive, b);
    relieve_neighbors(bonds, stiffness, grain, works, s);
    return static_cast<int>(s.broken.size());
}

template int break_by_energy(const Bonds<2>&, const BondStiffness&, const BreakLimit&, const GrainView<2>&,
                             std::span<BondWork>, std::span<std::uint8_t>);
template int break_by_energy(const Bonds<3>&, const BondStiffness&, const BreakLimit&, const GrainView<3>&,
                             std::span<BondWork>, std::span<std::uint8_t>);

}  // namespace quern
