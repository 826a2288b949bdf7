#include "particles/pieces.hpp"

#include <algorithm>

namespace quern {

template <int Dim>
int find_pieces(const Bonds<Dim>& bonds, const BondBits& alive, std::vector<int>& piece) {
    const int n = bonds.n_nodes();
    piece.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) piece[i] = i;
    const auto root = [&](int i) {
        while (piece[i] != i) i = piece[i] = piece[piece[i]];
        return i;
    };
    for (int i = 0; i < n; ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            if (!alive.empty() && !alive[b]) continue;
            const int r = root(i), s = root(bonds.partner[b]);
            piece[std::max(r, s)] = std::min(r, s);
        }
    // A root is the lowest node of its piece, so it has got its number before any other asks for it.
    int n_pieces = 0;
    for (int i = 0; i < n; ++i) piece[i] = piece[i] == i ? n_pieces++ : piece[piece[i]];
    return n_pieces;
}

template <int Dim>
bool joined_by_two(const Bonds<Dim>& bonds, const BondBits& alive, int i, int j) {
    if (alive.empty()) return true;
    const std::span<const Neighbor> of_i = bonds.family_of(i), of_j = bonds.family_of(j);
    // Families are sorted by node.
    std::size_t a = 0, b = 0;
    while (a < of_i.size() && b < of_j.size()) {
        if (of_i[a].node < of_j[b].node) {
            ++a;
        } else if (of_i[a].node > of_j[b].node) {
            ++b;
        } else {
            if (alive[of_i[a].bond] && alive[of_j[b].bond]) return true;
            ++a, ++b;
        }
    }
    return false;
}

template int find_pieces<2>(const Bonds<2>&, const BondBits&, std::vector<int>&);
template int find_pieces<3>(const Bonds<3>&, const BondBits&, std::vector<int>&);
template bool joined_by_two<2>(const Bonds<2>&, const BondBits&, int, int);
template bool joined_by_two<3>(const Bonds<3>&, const BondBits&, int, int);

}  // namespace quern
