// Numbers of one run of granular shear, from the files that it left behind.
#pragma once

#include <string>
#include <vector>

namespace quern::granular_shear {

/// Time goes by the average shear, gamma = way of the right edge over the width of the sample. Means and
/// deviations are over gamma from 0.1 to the end, where the packing has long forgotten how it began.
struct ShearNumbers {
    double diameter = 0;                                   ///< mean of all grains [m]
    std::vector<double> shear;                             ///< of each row of reactions
    std::vector<double> pressure, traction;                ///< on the right edge, at those [Pa]
    double pressure_mean = 0, pressure_deviation = 0;      ///< [Pa], deviation over mean
    double traction_mean = 0, traction_deviation = 0;      ///< [Pa], deviation over mean
    std::vector<double> column;                            ///< middles of columns of the sample [m]
    std::vector<double> shears_shown;                      ///< gamma of `way`
    std::vector<std::vector<double>> way;                  ///< mean vertical displacement of each column [m]
    double band = 0;                                       ///< 2 int u dx / u_edge, over the mean diameter
    double band_tenth = 0;                                 ///< from the edge to u = u_edge/10, likewise
    double half_load = 0, tail_slope = 0, tail_error = 0;  ///< means over the frames
    double flowed = 0;  ///< share of the volume whose plastic strain is above a tenth, at the last of `way`
    double flowed_third =
        0;  ///< share of the plastic strain in the third next to the moving edge, at the same
    double coordination = 0;    ///< pairs a grain, rattlers left out
    double rotation = 0;        ///< root mean square of the turns of free grains [rad]
    double rotation_large = 0;  ///< of those above the mean diameter [rad]
    double work = 0, plastic = 0, friction = 0, contact = 0, transfer = 0;  ///< energies at the end [J/m]
    double stored = 0;                                                      ///< kinetic and elastic [J/m]
    double residual = 0;  ///< of the budget, over the throughput
    double steps = 0, wall_seconds = 0, ns_per_particle_step = 0;
};

/// Reads DIR of a run of shear.yaml. Throws InputError if something is missing.
ShearNumbers measure_shear(const std::string& directory);

}  // namespace quern::granular_shear
