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

template int find_pieces<2>(const Bonds<2>&, const BondBits&, std::vector<int>&);
template int find_pieces<3>(const Bonds<3>&, const BondBits&, std::vector<int>&);

}  // namespace quern
