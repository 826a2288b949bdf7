#include "particles/weibull.hpp"

#include <cmath>
#include <cstdint>

namespace quern {

double weibull_factor(double modulus, int seed, int grain) {
    std::uint64_t z = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(seed)) << 32) +
                      static_cast<std::uint64_t>(static_cast<std::uint32_t>(grain));
    // Two rounds: one leaves neighbouring numbers of a grain alike in their first bits.
    for (int round = 0; round < 2; ++round) {
        z += 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        z ^= z >> 31;
    }
    const double u = (static_cast<double>(z >> 11) + 0.5) * 0x1.0p-53;
    return std::pow(-std::log1p(-u), 1.0 / modulus) / std::tgamma(1.0 + 1.0 / modulus);
}

}  // namespace quern
