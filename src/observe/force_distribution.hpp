// How the normal forces of a packing are distributed about their mean.
//
//     f = F_n / <F_n>,   P(f) = n_k / (N w)            bins of width w
//     f > 1:   P(f) ~ exp(-beta f)
//     beta = n_1 / sum (f - 1),   its standard error beta / sqrt(n_1)           sums over the n_1 forces f >
//     1
//
// beta is the maximum-likelihood estimate, free of bins. Source: Radjai, Jean, Moreau, Roux, Phys. Rev. Lett.
// 77 (1996) 274 (exponential above the mean; beta 1.4 in their packings); Mueth, Jaeger, Nagel, Phys. Rev. E
// 57 (1998) 3164 (1.5 at walls); the estimate: e.g. Clauset, Shalizi, Newman, SIAM Rev. 51 (2009) 661,
// table 1.
#pragma once

#include <vector>

namespace quern {

struct ForceDistribution {
    double mean = 0.0;                      ///< <F_n>, unit of the forces
    double width = 0.0;                     ///< w
    std::vector<int> counts;                ///< n_k of the bins [k w, (k + 1) w)
    std::vector<double> density;            ///< P(f)
    double slope = 0.0, slope_error = 0.0;  ///< beta; 0 if no force is above the mean
    int n_tail = 0;
};

/// `forces` all > 0.
ForceDistribution force_distribution(const std::vector<double>& forces, double width);

}  // namespace quern
