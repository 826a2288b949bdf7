// Pieces of a grain against a search from node to node.
#include "particles/pieces.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "particles/shape_builders.hpp"
#include "tests/particles/force_cases.hpp"

namespace quern::test {

namespace {

template <int Dim>
Shape<Dim> block() {
    if constexpr (Dim == 2)
        return make_lattice_shape<2>(Polygon({{-0.6, -0.3}, {0.6, -0.3}, {0.6, 0.3}, {-0.6, 0.3}}),
                                     Vec<2>::Constant(0.1));
    else
        return make_lattice_shape<3>(Cuboid({0.6, 0.4, 0.4}), Vec<3>::Constant(0.1));
}

/// The same by walking along intact bonds.
template <int Dim>
std::vector<int> walk(const Bonds<Dim>& bonds, const std::vector<std::uint8_t>& alive) {
    std::vector<int> piece(bonds.X.size(), -1);
    int n = 0;
    for (int start = 0; start < bonds.n_nodes(); ++start) {
        if (piece[start] >= 0) continue;
        std::vector<int> reached{start};
        piece[start] = n;
        while (!reached.empty()) {
            const int i = reached.back();
            reached.pop_back();
            for (const Neighbor& j : bonds.family_of(i))
                if (alive[j.bond] && piece[j.node] < 0) {
                    piece[j.node] = n;
                    reached.push_back(j.node);
                }
        }
        ++n;
    }
    return piece;
}

template <int Dim>
void check_pieces() {
    const Bonds<Dim> bonds = make_bonds<Dim>(block<Dim>(), Material{});
    std::vector<std::uint8_t> alive(static_cast<std::size_t>(bonds.n_bonds()), 1);
    std::vector<int> piece;
    CHECK(find_pieces<Dim>(bonds, {}, piece) == 1);
    CHECK(find_pieces<Dim>(bonds, alive, piece) == 1);
    std::mt19937 random(5);
    for (const unsigned left : {40U, 15U, 6U, 2U, 0U}) {  // bonds of a hundred
        for (std::uint8_t& bit : alive) bit = random() % 100 < left ? 1 : 0;
        const std::vector<int> expected = walk(bonds, alive);
        const int n = find_pieces<Dim>(bonds, alive, piece);
        CHECK(piece == expected);
        CHECK(n == *std::max_element(expected.begin(), expected.end()) + 1);
    }
    CHECK(piece.back() == bonds.n_nodes() - 1);  // without bonds every node is one
}

}  // namespace

TEST_CASE("Pieces: what intact bonds hold together, numbered by the lowest node") {
    check_pieces<2>();
    check_pieces<3>();
}

TEST_CASE("Pieces: as long as every broken bond has a detour over a third node, pieces stay as they were") {
    const Bonds<2> bonds = make_bonds<2>(block<2>(), Material{});
    std::vector<std::uint8_t> alive(static_cast<std::size_t>(bonds.n_bonds()), 1);
    std::vector<int> order(alive.size()), first(alive.size()), piece, before;
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) first[static_cast<std::size_t>(b)] = i;
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    int detours = 0, others = 0, parted = 0;
    find_pieces<2>(bonds, alive, before);
    for (std::size_t k = 0; k < order.size(); k += 3) {
        bool joined = true;
        const std::size_t end = std::min(order.size(), k + 3);
        for (std::size_t m = k; m < end; ++m) alive[static_cast<std::size_t>(order[m])] = 0;
        for (std::size_t m = k; m < end; ++m)
            joined = joined && joined_by_two<2>(bonds, alive, first[static_cast<std::size_t>(order[m])],
                                                bonds.partner[static_cast<std::size_t>(order[m])]);
        find_pieces<2>(bonds, alive, piece);
        if (joined) CHECK(piece == before);
        ++(joined ? detours : others);
        parted += piece == before ? 0 : 1;
        before = piece;
    }
    CHECK(detours > others / 2);  // measured 145 to 44 of them
    CHECK(parted > 20);           // measured 35
}

}  // namespace quern::test
