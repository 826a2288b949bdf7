// Grains and their particles: what every force and every contact method reads.
//
// A grain is an id and a contiguous range of particles. Grains of one shape and one material stand next to
// each other (a group), so that a kernel that serves many grains of one topology finds them in a row.
#pragma once

#include <span>
#include <vector>

#include "particles/shape.hpp"

namespace quern {

template <int Dim>
struct Grain {
    const Shape<Dim>* shape = nullptr;
    double scale = 1.0;
    int first = 0, count = 0;  ///< range of particles
    int material = 0;
    double mass = 0.0;      ///< [kg; 2D: kg/m]
    double volume = 0.0;    ///< [m^3; 2D: m^2]
    double strength = 1.0;  ///< critical stretch over that of its material
    int id = 0;             ///< number in the deck
    bool wall = false;      ///< stands for a wall: no contact between two of them (node pairs)
};

/// State of all particles, grain after grain.
template <int Dim>
struct Particles {
    std::vector<Vec<Dim>> x;     ///< current position, not wrapped on periodic axes [m]
    std::vector<Vec<Dim>> v;     ///< velocity, half a step behind x [m/s]
    std::vector<double> mass;    ///< [kg; 2D: kg/m]
    std::vector<double> volume;  ///< reference [m^3; 2D: m^2]

    int size() const { return static_cast<int>(x.size()); }
};

/// Rigid motion of a grain: from its particles, with its discrete inertia.
template <int Dim>
struct GrainMotion {
    Vec<Dim> centre, velocity;  ///< centre of mass [m], its velocity [m/s]
    Spin<Dim> omega;            ///< inverse inertia times angular momentum [rad/s]
    Mat<Dim> rotation;          ///< best-fit rotation from the reference to now
};

/// Best-fit rotation of a grain: the R that maximises sum m x.(R X) (2D: closed form; 3D: polar part of
/// sum m x X^T by singular values, det R = 1).
template <int Dim>
Mat<Dim> best_fit_rotation(const Grain<Dim>& grain, std::span<const Vec<Dim>> x,
                           std::span<const double> mass);

/// Best-fit rotation of the surface of a grain, all n points alike: the R that maximises
/// sum (x - x_m).(R (X - X_m)), x_m and X_m their means; found as above from
/// A = sum x X^T - (sum x)(sum X)^T/n. It turns the reference normals of the surface; of a grain of a hundred
/// particles it reads a third.
template <int Dim>
Mat<Dim> surface_rotation(const Grain<Dim>& grain, std::span<const Vec<Dim>> x);

template <int Dim>
GrainMotion<Dim> grain_motion(const Grain<Dim>& grain, const Particles<Dim>& particles);

}  // namespace quern
