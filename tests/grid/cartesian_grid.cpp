// Cells and wrapping of the background grid.
#include "grid/cartesian_grid.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

namespace quern {

namespace {

template <int Dim>
CartesianGrid<Dim> make_grid(int n, bool periodic) {
    std::array<bool, Dim> axes{};
    axes.fill(periodic);
    return CartesianGrid<Dim>(Vec<Dim>::Constant(-1.0), 0.25, IntVec<Dim>::Constant(n), axes);
}

/// Nodes of a grid, each once, not wrapped.
template <int Dim>
std::vector<IntVec<Dim>> all_nodes(const CartesianGrid<Dim>& grid) {
    std::vector<IntVec<Dim>> nodes;
    for (int k = 0; k < grid.n_nodes().prod(); ++k) {
        IntVec<Dim> node;
        for (int a = 0, rest = k; a < Dim; rest /= grid.n_nodes()[a], ++a)
            node[a] = rest % grid.n_nodes()[a] - (grid.periodic(a) ? 0 : grid.margin);
        nodes.push_back(node);
    }
    return nodes;
}

template <int Dim>
void check_wrapping(bool periodic) {
    const CartesianGrid<Dim> grid = make_grid<Dim>(5, periodic);
    for (const IntVec<Dim>& node : all_nodes<Dim>(grid)) {
        IntVec<Dim> wrapped;
        for (int a = 0; a < Dim; ++a) {
            wrapped[a] = grid.wrapped(a, node[a]);
            CHECK(wrapped[a] >= 0);
            CHECK(wrapped[a] < grid.n_nodes()[a]);
            if (periodic) CHECK(grid.wrapped(a, node[a] - 10) == wrapped[a]);
        }
        CHECK(grid.node(wrapped) == node);
    }
}

}  // namespace

TEST_CASE("CartesianGrid: a node and its wrapped indices belong together") {
    for (const bool periodic : {false, true}) {
        check_wrapping<2>(periodic);
        check_wrapping<3>(periodic);
    }
}

TEST_CASE("CartesianGrid: nodes stand where the origin and h put them") {
    const CartesianGrid<3> grid({1.0, 2.0, 3.0}, 0.5, {4, 6, 8}, {false, true, false});
    CHECK(grid.node_position({2, -1, 0}) == Vec<3>(2.0, 1.5, 3.0));
    CHECK(grid.extent() == Vec<3>(2.0, 3.0, 4.0));
    CHECK(grid.n_nodes() == IntVec<3>(11, 6, 15));
    CHECK(grid.in_cells({2.0, 1.5, 3.25}) == Vec<3>(2.0, -1.0, 0.5));
    CHECK(grid.cell(grid.in_cells({1.99, 1.51, 2.99})) == IntVec<3>(1, -1, -1));
    CHECK(grid.cell({-0.0, -1e-300, 0.0}) == IntVec<3>(0, -1, 0));
}

TEST_CASE("CartesianGrid: an axis wraps both ways, or counts from its margin") {
    const CartesianGrid<2> grid({0.0, 0.0}, 1.0, {5, 5}, {true, false});
    for (int i = -12; i < 12; ++i) {
        CHECK(grid.wrapped(0, i) == ((i % 5) + 5) % 5);
        CHECK(grid.wrapped(1, i) == i + 3);
    }
}

TEST_CASE("CartesianGrid: contains just what has nodes all around") {
    const CartesianGrid<2> grid({0.0, 0.0}, 1.0, {5, 5}, {true, false});
    CHECK(grid.contains({1e6, 2.0}));
    CHECK(grid.contains({-1e6, 2.0}));
    CHECK_FALSE(grid.contains({1e10, 2.0}));
    CHECK(grid.contains({0.0, -2.0}));
    CHECK_FALSE(grid.contains({0.0, std::nextafter(-2.0, -3.0)}));
    CHECK(grid.contains({0.0, std::nextafter(7.0, 0.0)}));
    CHECK_FALSE(grid.contains({0.0, 7.0}));  // nodes a skin beyond its cell would lie past the margin
    const double no_number = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(grid.contains({no_number, 1.0}));
    CHECK_FALSE(grid.contains({1.0, no_number}));
    // Two cells to each side of the outermost points are nodes of the grid.
    for (const double x : {-2.0, std::nextafter(7.0, 0.0)}) {
        const int cell = grid.cell(grid.in_cells({0.0, x}))[1];
        CHECK(grid.wrapped(1, cell - 1) >= 0);
        CHECK(grid.wrapped(1, cell + 2) < grid.n_nodes()[1]);
    }
}

}  // namespace quern
