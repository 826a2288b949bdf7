#include "particles/bonds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "grid/error.hpp"
#include "particles/influence.hpp"

namespace quern {
namespace {

/// Nodes sorted into cells at least one horizon wide: partners lie in the 3^Dim cells around a node.
template <int Dim>
class Cells {
  public:
    Cells(const std::vector<Vec<Dim>>& X, double reach) : edge_(reach) {
        Vec<Dim> top = X.front();
        origin_ = X.front();
        for (const Vec<Dim>& point : X) {
            origin_ = origin_.cwiseMin(point);
            top = top.cwiseMax(point);
        }
        // A few stray nodes far away must not ask for a huge empty grid.
        const double most = 4.0 * static_cast<double>(X.size()) + 64.0;
        while (((top - origin_) / edge_ + Vec<Dim>::Ones()).prod() > most) edge_ *= 2.0;
        for (int d = 0; d < Dim; ++d) count_[d] = static_cast<int>((top[d] - origin_[d]) / edge_) + 1;

        first_.assign(static_cast<std::size_t>(count_.prod()) + 1, 0);
        for (const Vec<Dim>& point : X) ++first_[index(cell(point)) + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        node_.resize(X.size());
        std::vector<int> next(first_.begin(), first_.end() - 1);
        for (std::size_t i = 0; i < X.size(); ++i) node_[next[index(cell(X[i]))]++] = static_cast<int>(i);
    }

    /// visit(j) for every node in the cells around `point`.
    template <class Visit>
    void for_each_near(const Vec<Dim>& point, Visit&& visit) const {
        const IntVec<Dim> home = cell(point);
        IntVec<Dim> low, high;
        for (int d = 0; d < Dim; ++d) {
            low[d] = std::max(0, home[d] - 1);
            high[d] = std::min(count_[d] - 1, home[d] + 1);
        }
        IntVec<Dim> at = low;
        for (;;) {
            const int c = index(at);
            for (int k = first_[c]; k < first_[c + 1]; ++k) visit(node_[k]);
            int d = 0;
            while (d < Dim && ++at[d] > high[d]) {
                at[d] = low[d];
                ++d;
            }
            if (d == Dim) return;
        }
    }

  private:
    IntVec<Dim> cell(const Vec<Dim>& point) const {
        IntVec<Dim> c;
        for (int d = 0; d < Dim; ++d)
            c[d] = std::min(count_[d] - 1, static_cast<int>((point[d] - origin_[d]) / edge_));
        return c;
    }
    int index(const IntVec<Dim>& c) const {
        int k = c[Dim - 1];
        for (int d = Dim - 2; d >= 0; --d) k = k * count_[d] + c[d];
        return k;
    }

    double edge_;
    Vec<Dim> origin_;
    IntVec<Dim> count_;
    std::vector<int> first_, node_;
};

template <int Dim>
void join(Bonds<Dim>& bonds, const Material& material, double closest, const std::string& where) {
    const int n = bonds.n_nodes();
    // A lattice distance equal to the horizon is on one side of it, whatever its last bits.
    const double reach =
        bonds.horizon * (material.horizon_rim == HorizonRim::included ? 1.0 + 1e-9 : 1.0 - 1e-9);
    const Cells<Dim> cells(bonds.X, reach);
    std::vector<int> row;
    bonds.first.assign(1, 0);
    for (int i = 0; i < n; ++i) {
        row.clear();
        cells.for_each_near(bonds.X[i], [&](int j) {
            if (j > i && (bonds.X[j] - bonds.X[i]).squaredNorm() <= reach * reach) row.push_back(j);
        });
        std::sort(row.begin(), row.end());
        for (const int j : row) {
            const double xi = (bonds.X[j] - bonds.X[i]).norm();
            if (xi < closest)
                throw InputError(where, fmt::format("nodes {} and {} at one place", i, j), "distinct nodes");
            const double w = influence(material.influence, std::min(1.0, xi / bonds.horizon));
            if (w < 1e-9) continue;  // the rim of the cone: no force, so no bond to count or to break
            bonds.partner.push_back(j);
            bonds.length.push_back(xi);
            bonds.weight.push_back(w);
        }
        bonds.first.push_back(bonds.n_bonds());
    }
}

/// beta of bonds.hpp.
template <int Dim>
void cut_volumes(Bonds<Dim>& bonds) {
    if (bonds.length.empty()) return;
    const double h = *std::min_element(bonds.length.begin(), bonds.length.end());
    for (int b = 0; b < bonds.n_bonds(); ++b)
        bonds.weight[b] *= std::min(1.0, (bonds.horizon + 0.5 * h - bonds.length[b]) / h);
}

template <int Dim>
void list_families(Bonds<Dim>& bonds) {
    const int n = bonds.n_nodes();
    bonds.family_first.assign(n + 1, 0);
    for (int i = 0; i < n; ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            ++bonds.family_first[i + 1];
            ++bonds.family_first[bonds.partner[b] + 1];
        }
    std::partial_sum(bonds.family_first.begin(), bonds.family_first.end(), bonds.family_first.begin());
    bonds.family.resize(2 * bonds.partner.size());
    std::vector<int> next(bonds.family_first.begin(), bonds.family_first.end() - 1);
    for (int i = 0; i < n; ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            const int j = bonds.partner[b];
            bonds.family[next[i]++] = {j, b};
            bonds.family[next[j]++] = {i, b};
        }
}

template <int Dim>
void check_families(const Bonds<Dim>& bonds, const Material& material, const std::string& where) {
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        Mat<Dim> spread = Mat<Dim>::Zero();  // of the directions: 1/Dim times identity when they are even
        const std::span<const Neighbor> family = bonds.family_of(i);
        for (const auto [j, b] : family) {
            const Vec<Dim> direction = (bonds.X[j] - bonds.X[i]) / bonds.length[b];
            spread += direction * direction.transpose() / static_cast<double>(family.size());
        }
        if (family.size() > Dim && spread.determinant() > 1e-6) continue;
        throw InputError(
            where,
            fmt::format("node {} with {} neighbours within the horizon {:.4g} m", i, family.size(),
                        bonds.horizon),
            fmt::format("at least {} that are not all on one {}", Dim + 1, Dim == 2 ? "line" : "plane"),
            material.horizon > 0.0
                ? fmt::format("raise horizon, now {:.4g} m, or use more nodes", material.horizon)
                : fmt::format("raise horizon_ratio, now {:.4g}, or use more nodes", material.horizon_ratio));
    }
}

/// Distance of every node from the true surface, exact up to one horizon and at least that beyond [m].
template <int Dim>
std::vector<double> make_depths(const Bonds<Dim>& bonds, const std::vector<SurfacePoint<Dim>>& surface) {
    std::vector<double> depth(bonds.X.size(), bonds.horizon);
    for (const SurfacePoint<Dim>& point : surface) {
        depth[point.node] = std::min(depth[point.node], point.delta);
        for (const auto [j, b] : bonds.family_of(point.node))
            depth[j] = std::min(depth[j], point.delta + bonds.length[b]);
    }
    return depth;
}

template <int Dim>
void measure_bulk(Bonds<Dim>& bonds, Influence kind, const std::vector<double>& family_volume,
                  const std::vector<double>& depth) {
    double n_bulk = 0.0, moment = 0.0, volume = 0.0, mean_volume = 0.0;
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        mean_volume += bonds.volume[i] / bonds.n_nodes();
        if (depth[i] < bonds.horizon) continue;
        n_bulk += 1.0;
        volume += family_volume[i];
        moment += bonds.moment[i];
    }
    const bool found = n_bulk > 0.0;
    bonds.bulk_moment = found ? moment / n_bulk : weighted_ball_volume<Dim>(kind, bonds.horizon);
    bonds.bulk_family_volume = found ? volume / n_bulk : ball_volume<Dim>(bonds.horizon) - mean_volume;
}

template <int Dim>
void sum_moments(Bonds<Dim>& bonds) {
    bonds.moment.assign(bonds.X.size(), 0.0);
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (const auto [j, b] : bonds.family_of(i))
            bonds.moment[i] += bonds.weight[b] * bonds.length[b] * bonds.length[b] * bonds.volume[j];
}

}  // namespace

template <int Dim>
Bonds<Dim> make_bonds(const Shape<Dim>& shape, const Material& material) {
    const std::string where = fmt::format("material '{}' on shape '{}'", material.name, shape.name);
    if (!(material.horizon_of(shape.dx) > 0.0) || !(shape.dx > 0.0) || shape.X.empty())
        throw InputError(where,
                         fmt::format("horizon {} m, spacing {} m, {} nodes", material.horizon_of(shape.dx),
                                     shape.dx, shape.X.size()),
                         "a positive horizon and spacing, and nodes");
    Bonds<Dim> bonds;
    bonds.horizon = material.horizon_of(shape.dx);
    bonds.X = shape.X;
    bonds.volume = shape.volume;
    join(bonds, material, 1e-6 * shape.dx, where);
    if (material.volume_correction == VolumeCorrection::linear) cut_volumes(bonds);
    list_families(bonds);
    check_families(bonds, material, where);

    const int n = bonds.n_nodes();
    std::vector<double> family_volume(n, 0.0);
    for (int i = 0; i < n; ++i)
        for (const auto [j, b] : bonds.family_of(i)) family_volume[i] += bonds.volume[j];
    sum_moments(bonds);
    measure_bulk(bonds, material.influence, family_volume, make_depths(bonds, shape.surface));

    if (material.surface_correction == SurfaceCorrection::volume) {
        for (int i = 0; i < n; ++i)
            for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b)
                bonds.weight[b] *=
                    2.0 * bonds.bulk_family_volume / (family_volume[i] + family_volume[bonds.partner[b]]);
        sum_moments(bonds);
    }
    return bonds;
}

template Bonds<2> make_bonds(const Shape<2>&, const Material&);
template Bonds<3> make_bonds(const Shape<3>&, const Material&);

}  // namespace quern
