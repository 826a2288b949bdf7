// Random numbers and elementary functions with the same bits on every machine.
//
// A packing is chaotic: one bit in one size moves every grain. Additions, products, quotients and square
// roots are the same everywhere (this folder is compiled without fused multiply-add), those of the
// mathematics library are not, so they are made of the former.
#pragma once

#include <cstdint>
#include <random>

namespace quern::portable {

double exp(double x);
double log(double x);  ///< x > 0

/// Cosine and sine of an angle, |angle| up to some turns [rad].
struct Direction {
    double cos = 1.0, sin = 0.0;
};
Direction direction(double angle);

/// Angle of a vector, in [-pi, pi] [rad].
double angle_of(double x, double y);

/// Numbers from a seed; std::mt19937_64 is the same everywhere, the distributions of the library are not.
class Random {
  public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}
    double uniform() { return static_cast<double>(bits_() >> 11) * 0x1.0p-53; }  ///< in [0, 1)
    /// In [0, n).
    int below(int n) { return static_cast<int>(uniform() * n); }

  private:
    std::mt19937_64 bits_;
};

}  // namespace quern::portable
