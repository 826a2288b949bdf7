#include "particles/strain.hpp"

#include <algorithm>

namespace quern {

template <int Dim>
double dilatational_modulus(const Material& material) {
    const double K = material.bulk_modulus, G = material.shear_modulus;
    if constexpr (Dim == 3) return K;
    return material.plane == PlaneState::strain ? K + G / 3.0 : 9.0 * K * G / (3.0 * K + 4.0 * G);
}

template <int Dim>
void compute_cauchy_stress(const Mat<Dim>& F, const Material& material, double* out) {
    const double G = material.shear_modulus, lambda = material.bulk_modulus - 2.0 / 3.0 * G;
    const Mat<Dim> E = 0.5 * (F.transpose() * F - Mat<Dim>::Identity());
    double E_zz = 0.0;
    // Beyond a stretch of about 2 the plane-stress thickness of this law vanishes; it is held at a tenth.
    if (Dim == 2 && material.plane == PlaneState::stress)
        E_zz = std::max(-lambda / (lambda + 2.0 * G) * E.trace(), 0.5 * (0.01 - 1.0));
    const double F_zz = std::sqrt(1.0 + 2.0 * E_zz);
    const double trace = E.trace() + E_zz;
    const Mat<Dim> S = lambda * trace * Mat<Dim>::Identity() + 2.0 * G * E;
    const double J = F.determinant() * F_zz;
    const Mat<Dim> sigma = F * S * F.transpose() / J;
    if constexpr (Dim == 2) {
        const double S_zz = lambda * trace + 2.0 * G * E_zz;
        out[0] = sigma(0, 0);
        out[1] = sigma(1, 1);
        out[2] = sigma(0, 1);
        out[3] = material.plane == PlaneState::stress ? 0.0 : F_zz * F_zz * S_zz / J;
    } else {
        out[0] = sigma(0, 0);
        out[1] = sigma(1, 1);
        out[2] = sigma(2, 2);
        out[3] = sigma(0, 1);
        out[4] = sigma(1, 2);
        out[5] = sigma(0, 2);
    }
}

template double dilatational_modulus<2>(const Material&);
template double dilatational_modulus<3>(const Material&);
template void compute_cauchy_stress(const Mat<2>&, const Material&, double*);
template void compute_cauchy_stress(const Mat<3>&, const Material&, double*);

}  // namespace quern
