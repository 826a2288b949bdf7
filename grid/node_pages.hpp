// One value per grid node, stored only where something is: a directory of small pages.
//
// Memory follows the matter, not the box: a page of 16^2 or 8^3 nodes is made when first asked for.
#pragma once

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
            n *= static_cast<std::size_t>(n_pages_[a]);
        }
        directory_.assign(n, -1);
    }

    /// Makes the page of a node (given by its wrapped indices). Not thread-safe.
    void require(const IntVec<Dim>& wrapped) {
        std::int32_t& page = directory_[directory_index(wrapped)];
        if (page >= 0) return;
        page = static_cast<std::int32_t>(values_.size() / page_size);
        values_.resize(values_.size() + page_size, empty_);
    }

    /// Value of a node whose page exists.
    T& operator[](const IntVec<Dim>& wrapped) {
        std::size_t offset = 0;
        for (int a = Dim - 1; a >= 0; --a)
            offset = offset << shift | static_cast<std::size_t>(wrapped[a] & (side - 1));
        return values_[static_cast<std::size_t>(directory_[directory_index(wrapped)]) * page_size + offset];
    }

    std::size_t n_pages() const { return values_.size() / page_size; }

  private:
    std::size_t directory_index(const IntVec<Dim>& wrapped) const {
        std::size_t i = 0;
        for (int a = Dim - 1; a >= 0; --a)
            i = i * static_cast<std::size_t>(n_pages_[a]) + static_cast<std::size_t>(wrapped[a] >> shift);
        return i;
    }

    T empty_;
    IntVec<Dim> n_pages_;
    std::vector<std::int32_t> directory_;
    std::vector<T> values_;
};

}  // namespace quern
