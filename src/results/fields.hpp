// Numbers to colour particles by, from the arrays of a frame.
//
//   speed                  |v|                                                       [m/s]
//   velocity_x, _y, _z     components of v                                           [m/s]
//   displacement           |x - x(first frame)|                                      [m]
//   damage                 fraction of broken bonds                                  [1]
//   damage_z               largest bond stretch over the critical one                [1]
//   plastic_strain         equivalent plastic strain                                 [1]
//   grain                  number of the grain                                       [1]
//   fragment               number of the piece                                       [1]
//   von_mises              sqrt(3/2 s:s), s the deviator of the full 3D stress       [Pa]
//   pressure               -(xx + yy + zz) / 3, compression positive                 [Pa]
//   principal_difference   2D: in the plane, sqrt((xx - yy)^2 + 4 xy^2), what photoelastic fringes count;
//                          3D: largest minus smallest principal stress               [Pa]
//   stress_xx, ...         components, tension positive; zz also in 2D               [Pa]
#pragma once

#include <string>
#include <vector>

#include "src/results/records.hpp"

namespace quern {

enum class ColorScale {
    sequential,   ///< from zero up
    diverging,    ///< either sign; zero in the middle
    categorical,  ///< a name, not a size
    glowing,      ///< from zero up, zero is black
    uniform       ///< one grey
};

struct Field {
    std::string name, unit, label;  ///< unit may be empty; label: for people
    ColorScale scale = ColorScale::sequential;
};

/// Names of all fields that frames of this dimension have.
std::vector<std::string> field_names(int dimension);

/// Throws InputError naming the nearest and all valid names.
Field find_field(const std::string& name, int dimension);

/// One value a particle [n]. `first` is the first frame of the run. Throws InputError for a field that the
/// frames of this run lack.
std::vector<double> make_field_values(const Field& field, const Frame& frame, const Frame& first);

}  // namespace quern
