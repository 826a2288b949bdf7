// Points sorted into cells, for finding those near a place: the search of node-pair contact.
//
// Cells cover the box of the points; on a periodic axis of the grid they divide its period. Memory and time
// are linear in the points: where these are sparse, cells grow.
#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "grid/cartesian_grid.hpp"

namespace quern {

template <int Dim>
class PointCells {
  public:
    /// Sorts points so that all within `reach` [m] of a place lie in the cells next to it. `grid`: whose
    /// periodic axes count; null: none.
    void sort(std::span<const Vec<Dim>> points, double reach, const CartesianGrid<Dim>* grid) {
        low_ = Vec<Dim>::Constant(std::numeric_limits<double>::infinity());
        Vec<Dim> high = -low_;
        for (const Vec<Dim>& x : points) {
            low_ = low_.cwiseMin(x);
            high = high.cwiseMax(x);
        }
        const double most_cells = 2.0 * static_cast<double>(points.size()) + 64.0;
        for (double edge = reach;; edge *= 1.5) {
            double n_cells = 1.0;
            for (int a = 0; a < Dim; ++a) {
                periodic_[a] = grid != nullptr && grid->periodic(a);
                if (periodic_[a]) low_[a] = grid->origin()[a];
                length_[a] = periodic_[a] ? grid->extent()[a] : std::max(high[a] - low_[a], edge);
                const double n = std::clamp(std::floor(length_[a] / edge), 1.0, 1e6);
                n_[a] = static_cast<int>(n);
                n_cells *= n;
            }
            if (n_cells <= most_cells) break;
        }
        first_.assign(static_cast<std::size_t>(n_.prod()) + 1, 0);
        cell_of_.resize(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            cell_of_[i] = index(cell(points[i]));
            ++first_[static_cast<std::size_t>(cell_of_[i]) + 1];
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        next_.assign(first_.begin(), first_.end() - 1);
        sorted_.resize(points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            sorted_[static_cast<std::size_t>(next_[static_cast<std::size_t>(cell_of_[i])]++)] =
                static_cast<int>(i);
    }

    /// visit(index) for every point in the cells around x, cell by cell.
    template <class Visit>
    void visit_near(const Vec<Dim>& x, Visit&& visit) const {
        const IntVec<Dim> middle = cell(x);
        IntVec<Dim> from, count;
        for (int a = 0; a < Dim; ++a) {
            const bool around = periodic_[a] && n_[a] > 3;
            from[a] = around ? middle[a] - 1 : periodic_[a] ? 0 : std::max(middle[a] - 1, 0);
            count[a] = around ? 3 : periodic_[a] ? n_[a] : std::min(middle[a] + 1, n_[a] - 1) - from[a] + 1;
        }
        for (int k = 0; k < count.prod(); ++k) {
            IntVec<Dim> c = from;
            for (int a = 0, rest = k; a < Dim; rest /= count[a], ++a)
                c[a] = (c[a] + rest % count[a] + n_[a]) % n_[a];
            const int i = index(c);
            for (int s = first_[i]; s < first_[i + 1]; ++s) visit(sorted_[s]);
        }
    }

  private:
    IntVec<Dim> cell(const Vec<Dim>& x) const {
        IntVec<Dim> c;
        for (int a = 0; a < Dim; ++a) {
            double u = (x[a] - low_[a]) / length_[a];
            if (periodic_[a]) u -= std::floor(u);
            c[a] = std::clamp(static_cast<int>(u * n_[a]), 0, n_[a] - 1);
        }
        return c;
    }
    int index(const IntVec<Dim>& c) const {
        int i = 0;
        for (int a = Dim - 1; a >= 0; --a) i = i * n_[a] + c[a];
        return i;
    }

    Vec<Dim> low_, length_;
    IntVec<Dim> n_;
    std::array<bool, Dim> periodic_{};
    std::vector<int> first_, next_, sorted_;  // points of each cell
    std::vector<int> cell_of_;                // [n_points]
};

/// The vector from one point to the nearest image of another.
template <int Dim>
class NearestImage {
  public:
    explicit NearestImage(const CartesianGrid<Dim>& grid) {
        for (int a = 0; a < Dim; ++a) {
            length_[a] = grid.periodic(a) ? grid.extent()[a] : 0.0;
            any_ = any_ || grid.periodic(a);
        }
    }
    Vec<Dim> operator()(const Vec<Dim>& from, const Vec<Dim>& to) const {
        Vec<Dim> d = to - from;
        if (any_)
            for (int a = 0; a < Dim; ++a)
                if (length_[a] > 0.0) d[a] -= length_[a] * std::rint(d[a] / length_[a]);
        return d;
    }

  private:
    Vec<Dim> length_;
    bool any_ = false;
};

}  // namespace quern
