// Sizes of grains from a distribution.
#pragma once

#include <vector>

#include "src/pack/pack_spec.hpp"
#include "src/pack/portable_math.hpp"

namespace quern {

/// The share of all grains below a size, and its inverse.
///
///     uniform    p(d) = const
///     lognormal  p(d) ~ 1/d exp(-(ln d - m)^2/(2 s^2))     s: deviation
///     power law  p(d) ~ d^-a                               a: exponent
///     Weibull    p(d) ~ d^(k-1) exp(-(d/b)^k)              k: modulus
///
/// between min and max, d: size [m], p: number of grains per size. Where the mean is given, m, a or b follow
/// from it, so that it is the mean of what lies within the limits. Tabulated in 4096 steps of ln d.
class SizeDistribution {
  public:
    /// Throws InputError for a mean that no such distribution has.
    explicit SizeDistribution(const SizeSpec& spec);

    double quantile(double share) const;  ///< share in [0, 1)
    double largest() const { return sizes_.back(); }
    double smallest() const { return sizes_.front(); }
    /// Means of d and of d^2 [m, m^2].
    double mean() const { return mean_; }
    double mean_square() const { return mean_square_; }

    /// n sizes in random order, one from each n-th part of the distribution: their mean and largest come near
    /// those of the distribution however few they are. A list of n sizes gives each of them once.
    std::vector<double> draw(int n, portable::Random& random) const;

  private:
    void tabulate(const SizeSpec& spec, double parameter);

    bool discrete_ = false;
    std::vector<double> sizes_;  ///< of a list in order; of a distribution the ends of the steps
    std::vector<double> share_;  ///< below sizes_[i]
    double mean_ = 0.0, mean_square_ = 0.0;
};

}  // namespace quern
