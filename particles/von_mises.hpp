// Plastic solids: finite strain, von Mises yield, linear isotropic hardening. Small functions for inner
// loops.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "particles/strain.hpp"

namespace quern {

/// Finite-strain J2 plasticity with the multiplicative split F = Fe Fp. Per reference volume:
///
///     W      = K/2 ((J^2 - 1)/2 - ln J) + G/2 (tr be - 3)            elastic energy [J/m^3]
///     tau    = K/2 (J^2 - 1) 1 + s,   s = G dev be                   Kirchhoff stress, J sigma [Pa]
///     |s|   <= R(alpha) = sqrt(2/3) (sigma_y + H alpha)              yield
///
/// and for an increment F -> f F
///
///     be_tr  = det(f)^(-2/3) f be f^T,   s_tr = G dev be_tr          trial
///     dgamma = (|s_tr| - R(alpha)) / (2 Gb (1 + H/(3 Gb))),  Gb = G tr(be_tr)/3     if positive, else 0
///     s      = (1 - 2 Gb dgamma/|s_tr|) s_tr                         radial return
///     alpha += sqrt(2/3) dgamma
///     be     = s/G + I 1,   I from  det be = 1
///
///     J       det F, volume over reference volume                    [-]
///     be      J^(-2/3) Fe Fe^T, isochoric elastic left Cauchy-Green tensor, det be = 1 [-]
///     K, G    bulk and shear modulus; sigma_y yield stress in tension; H hardening modulus [Pa]
///     alpha   equivalent plastic strain                              [-]
///
/// 2D is plane strain: f_zz = 1, but be_zz changes with plastic flow and is part of the state.
/// sigma_y infinite: hyperelastic, no history.
///
/// Source: Simo & Hughes, Computational Inelasticity (1998), box 9.1; Simo, Comput. Methods Appl. Mech.
/// Engrg. 66 (1988) 199. Differs: the book keeps tr be_tr in the place of I. Its det be then grows without
/// limit in continued flow, and the return costs no elastic energy; it names the restored determinant as the
/// remedy (remark 9.3.5), which is taken here.
///
/// Plastic work of an increment [J/m^3]: what the stress does beyond the change of W. At fixed F the return
/// from trial to yield takes W_tr - W = G/2 (tr be_tr - tr be) at the mean stress (|s_tr| + |s|)/2; the same
/// strain at the stress of the flow itself, the mean of R before and after, takes
///
///     dWp = G/2 (tr be_tr - tr be) (R(alpha_n) + R(alpha_n+1)) / (|s_tr| + |s|)
///
/// so that dW + dWp is the work of the stress to second order in the increment (sum over many: first order
/// squared). What hardening stores is counted as plastic work. For elastic strains that are small,
/// sum dWp = sigma_y alpha + H alpha^2/2.
struct VonMises {
    double bulk_modulus = 0.0;       ///< [Pa]
    double shear_modulus = 0.0;      ///< [Pa]
    double yield_stress = 0.0;       ///< [Pa]
    double hardening_modulus = 0.0;  ///< [Pa]

    /// Radius of the yield surface [Pa].
    double radius(double alpha) const {
        return std::sqrt(2.0 / 3.0) * (yield_stress + hardening_modulus * alpha);
    }
};

/// Symmetric tensor in the order of stresses: 2D xx, yy, xy, zz; 3D xx, yy, zz, xy, yz, xz.
template <int Dim>
using SymTensor = std::array<double, n_stress<Dim>>;

template <int Dim>
constexpr SymTensor<Dim> sym_identity() {
    if constexpr (Dim == 2)
        return {1.0, 1.0, 0.0, 1.0};
    else
        return {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
}

/// State of a material point.
template <int Dim>
struct PlasticState {
    SymTensor<Dim> be = sym_identity<Dim>();
    double alpha = 0.0;
    double J = 1.0;
};

/// The same history without the deformation, for bodies that know F: the elastic part of any F is
/// be = J^(-2/3) F C_p^-1 F^T, so the state changes in plastic flow only and elastic motion is exactly
/// reversible.
template <int Dim>
struct PlasticStrain {
    SymTensor<Dim> inverse = sym_identity<Dim>();  ///< C_p^-1 = (Fp^T Fp)^-1, of determinant 1 [-]
    double alpha = 0.0;
    double uneven = 0.0;  ///< sum_j w |z|^2 V_i V_j of the last force, see correspondence.hpp [m^6 | m^8]
};

/// Components along the axes of the simulation; 2D without zz.
template <int Dim>
Mat<Dim> to_matrix(const SymTensor<Dim>& a) {
    Mat<Dim> m;
    if constexpr (Dim == 2)
        m << a[0], a[2], a[2], a[1];
    else
        m << a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2];
    return m;
}

template <int Dim>
SymTensor<Dim> to_sym(const Mat<Dim>& m, double zz) {
    if constexpr (Dim == 2)
        return {m(0, 0), m(1, 1), m(0, 1), zz};
    else
        return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2)};
}

/// f a f^T; 2D: f_zz = 1.
template <int Dim>
SymTensor<Dim> push_forward(const Mat<Dim>& f, const SymTensor<Dim>& a) {
    const Mat<Dim> m = f * to_matrix<Dim>(a) * f.transpose();
    return to_sym<Dim>(m, a[3]);
}

template <int Dim>
double mean_of(const SymTensor<Dim>& a) {
    return (a[0] + a[1] + a[Dim == 2 ? 3 : 2]) / 3.0;
}

template <int Dim>
SymTensor<Dim> plus_identity(SymTensor<Dim> a, double c) {
    a[0] += c;
    a[1] += c;
    a[Dim == 2 ? 3 : 2] += c;
    return a;
}

/// a : a / 2
template <int Dim>
double half_square(const SymTensor<Dim>& a) {
    if constexpr (Dim == 2)
        return 0.5 * (a[0] * a[0] + a[1] * a[1] + a[3] * a[3]) + a[2] * a[2];
    else
        return 0.5 * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) + a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
}

template <int Dim>
double determinant(const SymTensor<Dim>& a) {
    if constexpr (Dim == 2)
        return (a[0] * a[1] - a[2] * a[2]) * a[3];
    else
        return a[0] * (a[1] * a[2] - a[4] * a[4]) - a[3] * (a[3] * a[2] - a[4] * a[5]) +
               a[5] * (a[3] * a[4] - a[1] * a[5]);
}

/// I - 1 of the tensor d + I 1 of determinant 1, d a deviator with d:d/2 = j2 and det d = j3: the largest
/// root x of (1 + x)^3 - j2 (1 + x) + j3 = 1, by Newton's method from `x` at or above it, or next to it. As
/// exact for small deviators as they are themselves, which tr be - 3 is not.
inline double isochoric_mean(double j2, double j3, double x) {
    for (int round = 0; round < 50; ++round) {
        const double value = x * (3.0 + x * (3.0 + x)) - j2 * (1.0 + x) + j3;
        const double change = value / (3.0 * (1.0 + x) * (1.0 + x) - j2);
        x -= change;
        if (std::abs(change) <= 1e-10 * std::abs(x)) break;
    }
    return x;
}

/// What an increment leaves: be and its share in W, and what it has taken.
template <int Dim>
struct PlasticReturn {
    SymTensor<Dim> be;          ///< on or within the yield surface, det be = 1
    SymTensor<Dim> s;           ///< G dev be [Pa]
    double alpha = 0.0;         ///< [-]
    double shear_energy = 0.0;  ///< G/2 (tr be - 3) [J/m^3]
    double work = 0.0;          ///< plastic work of the increment [J/m^3]
};

/// Radial return of a trial state with det be_tr = 1.
template <int Dim>
PlasticReturn<Dim> return_to_yield(const SymTensor<Dim>& be_tr, double alpha, const VonMises& law) {
    const double G = law.shear_modulus;
    const double mean_tr = mean_of<Dim>(be_tr);
    SymTensor<Dim> d = plus_identity<Dim>(be_tr, -mean_tr);
    const double j2 = half_square<Dim>(d), j3 = determinant<Dim>(d);
    const double x_tr = isochoric_mean(j2, j3, mean_tr - 1.0);
    PlasticReturn<Dim> result;
    result.alpha = alpha;
    result.shear_energy = 1.5 * G * x_tr;
    result.be = plus_identity<Dim>(d, 1.0 + x_tr);
    const double size = G * std::sqrt(2.0 * j2), R = law.radius(alpha);
    if (size > R) {
        const double stiffness = 2.0 * G * (1.0 + x_tr);
        const double dgamma = (size - R) / (stiffness + 2.0 / 3.0 * law.hardening_modulus);
        const double left = 1.0 - stiffness * dgamma / size;
        const double x = isochoric_mean(left * left * j2, left * left * left * j3, x_tr);
        for (double& component : d) component *= left;
        result.alpha += std::sqrt(2.0 / 3.0) * dgamma;
        result.be = plus_identity<Dim>(d, 1.0 + x);
        result.shear_energy = 1.5 * G * x;
        result.work = 1.5 * G * (x_tr - x) * (R + law.radius(result.alpha)) / (size * (1.0 + left));
    }
    for (std::size_t c = 0; c < d.size(); ++c) result.s[c] = G * d[c];
    return result;
}

/// tau of the volume ratio J and the deviator s [Pa].
template <int Dim>
SymTensor<Dim> kirchhoff_stress(double J, const SymTensor<Dim>& s, const VonMises& law) {
    return plus_identity<Dim>(s, 0.5 * law.bulk_modulus * (J - 1.0) * (J + 1.0));
}

/// K/2 ((J^2 - 1)/2 - ln J) [J/m^3]
inline double volume_energy(double J, const VonMises& law) {
    const double j = J - 1.0;
    return 0.5 * law.bulk_modulus * (j - std::log1p(j) + 0.5 * j * j);
}

/// tau of a state [Pa].
template <int Dim>
SymTensor<Dim> kirchhoff_stress(const PlasticState<Dim>& state, const VonMises& law) {
    SymTensor<Dim> s = plus_identity<Dim>(state.be, -mean_of<Dim>(state.be));
    for (double& component : s) component *= law.shear_modulus;
    return kirchhoff_stress<Dim>(state.J, s, law);
}

/// ratio^(-2/3); the series is exact to round-off where it is used, and saves the root.
inline double isochoric_factor(double ratio) {
    const double e = ratio - 1.0;
    if (std::abs(e) > 1e-3) return 1.0 / std::cbrt(ratio * ratio);
    return 1.0 -
           e * (2.0 / 3.0 - e * (5.0 / 9.0 - e * (40.0 / 81.0 - e * (110.0 / 243.0 - e * (308.0 / 729.0)))));
}

/// Takes the state through the relative gradient f = F_n+1 F_n^-1. `work` grows by the plastic work [J/m^3].
/// Kirchhoff stress [Pa].
template <int Dim>
SymTensor<Dim> update(PlasticState<Dim>& state, const Mat<Dim>& f, const VonMises& law, double& work) {
    const double ratio = f.determinant();
    const double shrink = isochoric_factor(ratio);
    state.be = push_forward<Dim>(f, state.be);
    for (double& component : state.be) component *= shrink;
    state.J *= ratio;
    if (law.yield_stress == std::numeric_limits<double>::infinity()) return kirchhoff_stress<Dim>(state, law);
    const PlasticReturn<Dim> now = return_to_yield<Dim>(state.be, state.alpha, law);
    state.be = now.be;
    state.alpha = now.alpha;
    work += now.work;
    return kirchhoff_stress<Dim>(state.J, now.s, law);
}

/// W of a state [J/m^3].
template <int Dim>
double elastic_energy(const PlasticState<Dim>& state, const VonMises& law) {
    const double mean = mean_of<Dim>(state.be);
    const SymTensor<Dim> d = plus_identity<Dim>(state.be, -mean);
    const double x = isochoric_mean(half_square<Dim>(d), determinant<Dim>(d), mean - 1.0);
    return volume_energy(state.J, law) + 1.5 * law.shear_modulus * x;
}

/// Return of a body of gradient F, J = det F; `strain` stays as it is.
template <int Dim>
PlasticReturn<Dim> return_to_yield(const PlasticStrain<Dim>& strain, const Mat<Dim>& F, double J,
                                   const VonMises& law) {
    const double shrink = 1.0 / std::cbrt(J * J);
    SymTensor<Dim> be_tr = push_forward<Dim>(F, strain.inverse);
    for (double& component : be_tr) component *= shrink;
    return return_to_yield<Dim>(be_tr, strain.alpha, law);
}

/// The strain after a return at this F.
template <int Dim>
PlasticStrain<Dim> plastic_strain(const PlasticReturn<Dim>& now, const Mat<Dim>& F, double J) {
    const double grow = std::cbrt(J * J);
    PlasticStrain<Dim> strain;
    strain.inverse = push_forward<Dim>(Mat<Dim>(F.inverse()), now.be);
    strain.alpha = now.alpha;
    for (double& component : strain.inverse) component *= grow;
    return strain;
}

}  // namespace quern
