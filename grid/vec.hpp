// Small fixed-size vectors and matrices: the one vocabulary of all rooms.
//
// Eigen types, double precision. Never bind an Eigen expression to `auto`: name the type.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdint>

namespace quern {

template <int Dim>
using Vec = Eigen::Matrix<double, Dim, 1>;

template <int Dim>
using Mat = Eigen::Matrix<double, Dim, Dim>;

template <int Dim>
using IntVec = Eigen::Matrix<int, Dim, 1>;

/// Number of components of a rotation: 1 in the plane (about z), 3 in space.
template <int Dim>
inline constexpr int n_spin = Dim == 2 ? 1 : 3;

/// Angular velocity [rad/s], moment [N m] or rotation vector [rad]: one component in 2D, three in 3D.
template <int Dim>
using Spin = Eigen::Matrix<double, n_spin<Dim>, 1>;

/// omega x r: velocity [m/s] at lever r [m] of a rotation omega [rad/s].
inline Vec<2> cross(const Spin<2>& omega, const Vec<2>& r) {
    return {-omega[0] * r[1], omega[0] * r[0]};
}
inline Vec<3> cross(const Spin<3>& omega, const Vec<3>& r) {
    return omega.cross(r);
}

/// r x f: moment [N m] of a force f [N] at lever r [m].
inline Spin<2> moment(const Vec<2>& r, const Vec<2>& f) {
    return Spin<2>(r[0] * f[1] - r[1] * f[0]);
}
inline Spin<3> moment(const Vec<3>& r, const Vec<3>& f) {
    return r.cross(f);
}

/// Rotation matrix of a rotation vector (2D: angle about z; 3D: axis times angle) [rad].
inline Mat<2> rotation_matrix(const Spin<2>& angle) {
    const double c = std::cos(angle[0]), s = std::sin(angle[0]);
    Mat<2> R;
    R << c, -s, s, c;
    return R;
}
inline Mat<3> rotation_matrix(const Spin<3>& rotation) {
    const double angle = rotation.norm();
    if (angle == 0.0) return Mat<3>::Identity();
    const Vec<3> k = rotation / angle;
    Mat<3> K;
    K << 0, -k[2], k[1], k[2], 0, -k[0], -k[1], k[0], 0;
    return Mat<3>::Identity() + std::sin(angle) * K + (1.0 - std::cos(angle)) * (K * K);
}

template <class T>
constexpr T power(T base, int exponent) {
    return exponent == 0 ? T{1} : base * power(base, exponent - 1);
}

}  // namespace quern
