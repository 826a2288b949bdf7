// What a material is made of: elastic constants, peridynamic options, damping.
#pragma once

#include <limits>
#include <optional>
#include <string>

namespace quern {

enum class ForceModel {
    lps,
    bond_based,
    peridem,  ///< lps as set by `set_peridem_options`
    correspondence,
    material_points
};
enum class PlaneState { strain, stress };
enum class Constants { plane, three_dimensional };  ///< of lps in 2D
enum class Influence {
    constant,
    inverse,
    conical,
    gaussian
};  ///< 1, 1/r, 1 - r, exp(-(2 r)^2); r = xi/horizon
enum class Calibration { none, discrete };
enum class SurfaceCorrection { none, volume };
enum class VolumeCorrection { none, linear };
enum class HorizonRim { included, excluded };  ///< bonds exactly as long as the horizon
enum class BreaksIn { tension, both };
enum class BreaksBy { stretch, energy };
enum class StretchFormula { energy_balance, peridem };

/// Strength that differs from grain to grain, see weibull.hpp.
struct StrengthScatter {
    double weibull_modulus = 0.0;
    int seed = 0;
};

/// One material of the deck. SI units; 2D quantities are per metre of thickness.
struct Material {
    std::string name;
    ForceModel model = ForceModel::lps;
    PlaneState plane = PlaneState::strain;  ///< read in 2D only
    double density = 0.0;                   ///< [kg/m^3]
    double bulk_modulus = 0.0;              ///< K, three-dimensional [Pa]
    double shear_modulus = 0.0;             ///< G [Pa]
    Constants constants = Constants::plane;
    double horizon_ratio = 3.015;  ///< horizon / Shape::dx
    double horizon = 0.0;          ///< of a grain of scale 1, in the place of the ratio; 0: the ratio [m]
    HorizonRim horizon_rim = HorizonRim::included;
    Influence influence = Influence::conical;
    Calibration calibration = Calibration::discrete;
    VolumeCorrection volume_correction = VolumeCorrection::none;
    SurfaceCorrection surface_correction = SurfaceCorrection::none;
    double yield_stress = std::numeric_limits<double>::infinity();  ///< in tension; infinite: elastic [Pa]
    double hardening_modulus = 0.0;                                 ///< linear, isotropic [Pa]
    double stabilization = 0.5;  ///< of correspondence: stiffness against what is not uniform in a family
    double bond_damping =
        0.0;  ///< Kelvin-Voigt time: stress of the strain rate = bond_damping * stiffness [s]
    double critical_stretch = std::numeric_limits<double>::infinity();  ///< bonds break above it
    double fracture_energy = 0.0;  ///< Gc, from which the critical stretch follows; 0: it is given [J/m^2]
    StretchFormula critical_stretch_formula = StretchFormula::energy_balance;
    BreaksIn breaks_in = BreaksIn::tension;
    BreaksBy breaks_by = BreaksBy::stretch;   ///< energy: at its work (bond_energy.hpp)
    std::optional<StrengthScatter> strength;  ///< none: all grains alike

    double horizon_of(double dx) const { return horizon > 0.0 ? horizon : horizon_ratio * dx; }  ///< [m]
    bool can_yield() const { return yield_stress < std::numeric_limits<double>::infinity(); }
    bool can_break() const {
        return fracture_energy > 0.0 || critical_stretch < std::numeric_limits<double>::infinity();
    }
};

/// The options in which the LPS of the public PeriDEM code 0.1.0 (J. Open Source Softw. 9 (2024) 6710; Jha et
/// al., J. Mech. Phys. Solids 151 (2021) 104376) differs from ours: constants of space in the plane, volumes
/// at the rim of a family cut, no bond as long as the horizon, bonds that break in compression as well, and
/// its own critical stretch. Each may be set back.
inline void set_peridem_options(Material& material) {
    material.model = ForceModel::peridem;
    material.constants = Constants::three_dimensional;
    material.volume_correction = VolumeCorrection::linear;
    material.horizon_rim = HorizonRim::excluded;
    material.breaks_in = BreaksIn::both;
    material.critical_stretch_formula = StretchFormula::peridem;
}

}  // namespace quern
