// What a material is made of: elastic constants, peridynamic options, damping.
#pragma once

#include <limits>
#include <string>

namespace quern {

enum class ForceModel { lps, bond_based };
enum class PlaneState { strain, stress };
enum class Influence {
    constant,
    inverse,
    conical,
    gaussian
};  ///< 1, 1/r, 1 - r, exp(-(2 r)^2); r = xi/horizon
enum class Calibration { none, discrete };
enum class SurfaceCorrection { none, volume };

/// One material of the deck. SI units; 2D quantities are per metre of thickness.
struct Material {
    std::string name;
    ForceModel model = ForceModel::lps;
    PlaneState plane = PlaneState::strain;  ///< read in 2D only
    double density = 0.0;                   ///< [kg/m^3]
    double bulk_modulus = 0.0;              ///< K, three-dimensional [Pa]
    double shear_modulus = 0.0;             ///< G [Pa]
    double horizon_ratio = 3.015;           ///< horizon / Shape::dx
    Influence influence = Influence::conical;
    Calibration calibration = Calibration::discrete;
    SurfaceCorrection surface_correction = SurfaceCorrection::none;
    double bond_damping =
        0.0;  ///< Kelvin-Voigt time: stress of the strain rate = bond_damping * stiffness [s]
    double critical_stretch = std::numeric_limits<double>::infinity();  ///< bonds break above it, in tension
};

}  // namespace quern
