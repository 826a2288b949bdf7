// Colours that people with any eyes can tell apart.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "src/results/fields.hpp"

namespace quern {

using Rgb = std::array<unsigned char, 3>;

/// Values to colours. Sequential: viridis (N. Smith and S. van der Walt, matplotlib), even steps look even
/// and brightness alone carries the order. Diverging: blue to red through grey (K. Moreland, "Diverging
/// color maps for scientific visualization", ISVC 2009). Categorical: hues a golden angle apart, in three
/// brightnesses, so that any run of consecutive numbers differs. Glowing: black to yellow over violet and
/// orange, brightness alone carries the order.
class ColorMap {
  public:
    ColorMap(ColorScale scale, double low, double high);  ///< high > low; both unused if categorical
    Rgb color(double value) const;                        ///< clamped; grey for what is not a number
    double low() const { return low_; }
    double high() const { return high_; }

  private:
    ColorScale scale_;
    double low_, high_;
    std::vector<Rgb> table_;
};

/// The colours of Okabe and Ito (2008), black last: cycle of the lines of a chart.
Rgb cycle_color(int index);

}  // namespace quern
