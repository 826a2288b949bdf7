// Morton's curve: every cell once, halves of the box in halves of the curve.
#include "grid/z_order.hpp"

#include <doctest/doctest.h>

#include <set>

namespace quern {

TEST_CASE("Z order: a cell, the one to its right, above, behind") {
    CHECK(z_order<2>({0, 0}) == 0);
    CHECK(z_order<2>({1, 0}) == 1);
    CHECK(z_order<2>({0, 1}) == 2);
    CHECK(z_order<2>({3, 5}) == 39);  // 101 over 011: 1 0 0 1 1 1
    CHECK(z_order<3>({0, 0, 1}) == 4);
    CHECK(z_order<3>({1, 1, 1}) == 7);
    CHECK(z_order<2>({-3, 2000000}) == z_order<2>({0, (1 << 20) - 1}));
}

TEST_CASE("Z order: a square of cells is a stretch of the curve") {
    for (const int side : {2, 4, 8}) {
        CAPTURE(side);
        std::set<std::uint64_t> places;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) places.insert(z_order<2>({3 * side + i, 5 * side + j}));
        CHECK(places.size() == static_cast<std::size_t>(side * side));
        CHECK(*places.rbegin() - *places.begin() == static_cast<std::uint64_t>(side * side - 1));
    }
}

}  // namespace quern
