// The background grid: where its nodes are, which cell a point is in, how an axis wraps.
//
// Nodes stand at origin + h (i, j, k). On a bounded axis nodes -margin .. n_cells + margin exist, so that
// matter pressed a little past a wall still finds nodes; on a periodic axis nodes wrap after n_cells.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "grid/vec.hpp"

namespace quern {

template <int Dim>
class CartesianGrid {
  public:
    static constexpr int margin = 3;  ///< layers of nodes beyond a bounded face

    /// origin [m], h > 0 [m], n_cells > 0 an axis, periodic an axis.
    CartesianGrid(const Vec<Dim>& origin, double h, const IntVec<Dim>& n_cells,
                  const std::array<bool, Dim>& periodic)
        : origin_(origin), h_(h), n_cells_(n_cells), periodic_(periodic) {
        for (int a = 0; a < Dim; ++a) n_nodes_[a] = periodic[a] ? n_cells[a] : n_cells[a] + 1 + 2 * margin;
    }

    double h() const { return h_; }
    const Vec<Dim>& origin() const { return origin_; }
    const IntVec<Dim>& n_cells() const { return n_cells_; }
    bool periodic(int axis) const { return periodic_[axis]; }
    const IntVec<Dim>& n_nodes() const { return n_nodes_; }
    Vec<Dim> extent() const { return h_ * n_cells_.template cast<double>(); }

    /// Point in grid units. Every cell index in the program is floor of this one expression: two roundings
    /// of the same point would visit cells twice.
    Vec<Dim> in_cells(const Vec<Dim>& x) const { return (x - origin_) / h_; }

    static IntVec<Dim> cell(const Vec<Dim>& in_cells) {
        IntVec<Dim> c;
        for (int a = 0; a < Dim; ++a) c[a] = static_cast<int>(std::floor(in_cells[a]));
        return c;
    }

    Vec<Dim> node_position(const IntVec<Dim>& node) const {
        return origin_ + h_ * node.template cast<double>();
    }

    /// True if a point has nodes around it (always, on periodic axes). False for a NaN.
    bool contains(const Vec<Dim>& x) const {
        const Vec<Dim> c = in_cells(x);
        for (int a = 0; a < Dim; ++a) {
            const double reach = periodic_[a] ? 1e9 : margin - 1.0;
            if (!(c[a] >= -reach && c[a] < n_cells_[a] + reach)) return false;
        }
        return true;
    }

    /// Index of a node on an axis after wrapping, counted from 0.
    int wrapped(int axis, int i) const {
        if (!periodic_[axis]) return i + margin;
        const int r = i % n_cells_[axis];
        return r < 0 ? r + n_cells_[axis] : r;
    }
    /// A node with these wrapped indices.
    IntVec<Dim> node(const IntVec<Dim>& wrapped) const {
        IntVec<Dim> node = wrapped;
        for (int a = 0; a < Dim; ++a)
            if (!periodic_[a]) node[a] -= margin;
        return node;
    }

  private:
    Vec<Dim> origin_;
    double h_;
    IntVec<Dim> n_cells_, n_nodes_;
    std::array<bool, Dim> periodic_;
};

}  // namespace quern
