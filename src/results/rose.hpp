// Rose diagram of directions that have no sign, such as contact normals.
#pragma once

#include <string>
#include <vector>

namespace quern {

struct Rose {
    std::string title;
    std::vector<double> angles;  ///< [rad], each counted in both directions
    /// Second-order fit beside it, E = (1 + 2 D cos 2(angle - along))/(2 pi), D the difference of the
    /// principal values of the fabric (Rothenburg and Bathurst, Geotechnique 39 (1989) 601, eq 11, with a = 2
    /// D).
    double difference = 0.0, along = 0.0;
};

/// Petals of ten degrees, as long as the density of directions; the circle is that of all directions alike.
void draw_rose(const Rose& rose, const std::string& file);

/// Density [1/rad] of n_petals petals of the full circle, the first centred on 0.
std::vector<double> petals(const std::vector<double>& angles, int n_petals);

}  // namespace quern
