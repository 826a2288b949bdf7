// Particles as discs (2D) or shaded balls (3D), with all that a picture needs to be read.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "src/results/fields.hpp"

namespace quern {

/// A line over the particles.
struct PictureLink {
    std::array<double, 3> from{}, to{};  ///< [m]
    double width = 0.0;                  ///< [m]; drawn half a pixel wide at least
};

struct PictureOptions {
    int width = 1200, height = 900;  ///< [pixel]
    std::string title = {};
    Field field = {};
    double low = 0.0, high = 1.0;     ///< of the colours; high > low
    std::vector<double> region = {};  ///< shown: lower, then upper corner [m]
    std::vector<double> domain = {};  ///< outlined: lower, then upper corner [m], or empty
    /// Of each axis [m], 0: it does not repeat; empty: none does. Particles and links are drawn in the
    /// domain, and again where a copy of them shows in the region.
    std::vector<double> periods = {};
    int dimension = 2;
    bool dark = false;                    ///< the plot is black where no particle is
    std::vector<PictureLink> links = {};  ///< in this order; what has its middle outside is left out
};

/// A camera for any number of frames of one run: same region, same colours.
class ParticlePicture {
  public:
    explicit ParticlePicture(const PictureOptions& options);
    ~ParticlePicture();

    /// values: one a particle [n], coloured by; particles whose position is not a number are left out.
    void write_png(const Frame& frame, const std::vector<double>& values, const std::string& file);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Radius of the disc or ball that has the volume of the particle [m].
double particle_radius(double volume, int dimension);

}  // namespace quern
