// Strength that differs from grain to grain.
#pragma once

namespace quern {

/// Critical stretch of a grain over that of its material:
///
///     f = (-ln(1 - u))^(1/m) / Gamma(1 + 1/m)
///
///     m Weibull modulus [-], u in (0, 1) from the seed and the number of the grain in the deck
///
/// The mean of f is 1, its coefficient of variation about 1.2/m for m > 3. The bits of u are the same on
/// every machine (splitmix64, one number a grain), whatever the order of the grains; those of f up to the
/// last digit of log and pow.
///
/// Source: W. Weibull, J. Appl. Mech. 18 (1951) 293. Differs: scaled to a mean of 1; no effect of size (with
/// `fracture_energy` a larger grain is weaker by its horizon already, break_limit.hpp).
double weibull_factor(double modulus, int seed, int grain);

}  // namespace quern
