// One value per grid node, stored only where something is: a directory of small pages.
//
// Memory follows the matter, not the box: a page of 16^2 or 8^3 nodes is made when first asked for. Pages
// have colours: two pages of one colour are half a page apart or more.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "grid/cartesian_grid.hpp"

namespace quern {

template <int Dim, class T>
class NodePages {
  public:
    static constexpr int shift = Dim == 2 ? 4 : 3;
    static constexpr int side = 1 << shift;
    static constexpr int page_size = Dim == 2 ? side * side : side * side * side;

    NodePages(const CartesianGrid<Dim>& grid, const T& empty) : empty_(empty) {
        std::size_t n = 1;
        for (int a = 0; a < Dim; ++a) {
            n_pages_[a] = (grid.n_nodes()[a] + side - 1) >> shift;
            periodic_[a] = grid.periodic(a);
            narrow_[a] = periodic_[a] && grid.n_nodes()[a] - ((n_pages_[a] - 1) << shift) < side / 2;
            n *= static_cast<std::size_t>(n_pages_[a]);
        }
        directory_.assign(n, -1);
    }

    /// Makes the page of a node (given by its wrapped indices). Not thread-safe.
    void require(const IntVec<Dim>& wrapped) {
        std::int32_t& page = directory_[directory_index(wrapped)];
        if (page >= 0) return;
        page = static_cast<std::int32_t>(first_.size());
        IntVec<Dim> first;
        for (int a = 0; a < Dim; ++a) first[a] = wrapped[a] >> shift << shift;
        first_.push_back(first);
        values_.resize(values_.size() + page_size, empty_);
    }
    /// Forgets all pages.
    void clear() {
        for (const IntVec<Dim>& first : first_) directory_[directory_index(first)] = -1;
        first_.clear();
        values_.clear();
    }

    /// Value of a node whose page exists.
    T& operator[](const IntVec<Dim>& wrapped) {
        std::size_t offset = 0;
        for (int a = Dim - 1; a >= 0; --a)
            offset = offset << shift | static_cast<std::size_t>(wrapped[a] & (side - 1));
        return values_[static_cast<std::size_t>(directory_[directory_index(wrapped)]) * page_size + offset];
    }

    /// Pages are numbered in the order in which they were made.
    int n_pages() const { return static_cast<int>(first_.size()); }
    /// Wrapped indices of the first node of a page.
    const IntVec<Dim>& first(int page) const { return first_[page]; }
    /// Wrapped indices of node i of a page; those of a page that is cut lie beyond the grid.
    IntVec<Dim> node(int page, int i) const {
        IntVec<Dim> node = first_[page];
        for (int a = 0; a < Dim; ++a) node[a] += i >> (a * shift) & (side - 1);
        return node;
    }
    /// Bit a: whether the index of node i of a page is odd on axis a. Nodes of one parity share no cell.
    static int parity(int i) {
        int bits = 0;
        for (int a = 0; a < Dim; ++a) bits |= (i >> (a * shift) & 1) << a;
        return bits;
    }
    std::span<T> values(int page) {
        return {values_.data() + static_cast<std::size_t>(page) * page_size, page_size};
    }
    /// Where a page stands in the grid: pages in ascending order are independent of how they were made.
    std::size_t place(int page) const { return directory_index(first_[page]); }

    /// Two values an axis; three where a periodic axis has an odd number of pages, or an even one of which
    /// the last is too narrow to part its neighbours.
    int colour(int page) const {
        int c = 0;
        for (int a = Dim - 1; a >= 0; --a) {
            const int i = first_[page][a] >> shift;
            const bool odd = n_pages_[a] % 2 == 1;
            const bool seam =
                (periodic_[a] && odd && i == n_pages_[a] - 1) || (narrow_[a] && !odd && i == n_pages_[a] - 2);
            c = 3 * c + (seam ? 2 : i % 2);
        }
        return c;
    }
    static constexpr int n_colours = Dim == 2 ? 9 : 27;

  private:
    std::size_t directory_index(const IntVec<Dim>& wrapped) const {
        std::size_t i = 0;
        for (int a = Dim - 1; a >= 0; --a)
            i = i * static_cast<std::size_t>(n_pages_[a]) + static_cast<std::size_t>(wrapped[a] >> shift);
        return i;
    }

    T empty_;
    IntVec<Dim> n_pages_;
    std::array<bool, Dim> periodic_, narrow_;  ///< narrow: the last page is less than half a page
    std::vector<std::int32_t> directory_;
    std::vector<IntVec<Dim>> first_;
    std::vector<T> values_;
};

}  // namespace quern
