#include "contact/patch.hpp"

#include <algorithm>

#include "contact/slot.hpp"

namespace quern {

namespace {

constexpr double push_reach = 1.5, turn_reach = 2.5;  ///< [dx]
/// Part of the nearest particle in a push at a point that is further from all of them.
constexpr double least_push = 1e-3;

double kernel(double z) {
    const double y = 1.0 - z * z;
    return z < 1.0 ? y * y : 0.0;
}

}  // namespace

template <int Dim>
int Patches<Dim>::add(const ContactScene<Dim>& scene, const Grain<Dim>& grain, std::span<const Vec<Dim>> s,
                      const Footprints<Dim>& footprints, int nearest, const Vec<Dim>& x_c,
                      const Vec<Dim>& foot, const Vec<Dim>& n, bool push_only) {
    const double dx = grain.shape->dx * grain.scale;
    Patch<Dim> patch;
    patch.first = static_cast<int>(particles.size());
    double turned_mass = 0.0;
    const Vec<Dim> to_foot = foot - x_c;
    Vec<Dim> pushed = Vec<Dim>::Zero(), turned = Vec<Dim>::Zero();
    for (const Neighbour& neighbour : footprints.around(nearest)) {
        PatchParticle<Dim> e;
        e.particle = grain.first + neighbour.node;
        e.r = scene.x[e.particle] - x_c;
        e.a = 0.0;
        if (neighbour.surface >= 0) {
            const Vec<Dim> d = s[e.particle] - x_c;
            e.a = kernel((d - n.dot(d) * n).norm() / (push_reach * dx));
            if (neighbour.surface == nearest) e.a = std::max(e.a, least_push);
        }
        e.w = push_only ? 0.0 : kernel((e.r - to_foot).norm() / (turn_reach * dx));
        if (e.a == 0.0 && e.w == 0.0) continue;
        e.ma = scene.mass[e.particle] * e.a;
        e.mw = scene.mass[e.particle] * e.w;
        patch.m += e.ma;
        pushed += e.ma * e.r;
        turned_mass += e.mw;
        turned += e.mw * e.r;
        particles.push_back(e);
    }
    patch.count = static_cast<int>(particles.size()) - patch.first;
    patch.r = -pushed / patch.m;
    if (turned_mass > 0.0) turned /= turned_mass;
    Mat<Dim> second = Mat<Dim>::Zero();
    for (int k = patch.first; k < patch.first + patch.count; ++k) {
        PatchParticle<Dim>& e = particles[k];
        e.r -= turned;
        second += e.mw * e.r * e.r.transpose();
    }
    patch.rotates = invert_inertia(second, turned_mass, dx, patch.Y);
    patches.push_back(patch);
    return static_cast<int>(patches.size()) - 1;
}

template <int Dim>
Vec<Dim> Patches<Dim>::velocity(int number, std::span<const Vec<Dim>> v) const {
    const Patch<Dim>& patch = patches[number];
    Vec<Dim> P = Vec<Dim>::Zero();
    Spin<Dim> L = Spin<Dim>::Zero();
    for (int k = patch.first; k < patch.first + patch.count; ++k) {
        const PatchParticle<Dim>& e = particles[k];
        P += e.ma * v[e.particle];
        L += moment(e.r, Vec<Dim>(e.mw * v[e.particle]));
    }
    Vec<Dim> u = P / patch.m;
    if (patch.rotates) u += cross(Spin<Dim>(patch.Y * L), patch.r);
    return u;
}

template <int Dim>
void Patches<Dim>::add_impulse(int number, const Vec<Dim>& J, std::span<Vec<Dim>> v) const {
    const Patch<Dim>& patch = patches[number];
    const Vec<Dim> push = J / patch.m;
    const Spin<Dim> turn =
        patch.rotates ? Spin<Dim>(patch.Y * moment(patch.r, J)) : Spin<Dim>(Spin<Dim>::Zero());
    for (int k = patch.first; k < patch.first + patch.count; ++k) {
        const PatchParticle<Dim>& e = particles[k];
        v[e.particle] += e.a * push + e.w * cross(turn, e.r);
    }
}

template <int Dim>
Mat<Dim> Patches<Dim>::inverse_mass(int number, std::span<const double> mass, bool exact) const {
    const Patch<Dim>& patch = patches[number];
    Eigen::Matrix<double, n_spin<Dim>, Dim> turn = Eigen::Matrix<double, n_spin<Dim>, Dim>::Zero();
    if (patch.rotates)
        for (int a = 0; a < Dim; ++a) turn.col(a) = patch.Y * moment(patch.r, Vec<Dim>(Vec<Dim>::Unit(a)));
    Mat<Dim> W = Mat<Dim>::Zero();
    if (!exact) {
        for (int a = 0; a < Dim; ++a)
            W.col(a) = Vec<Dim>::Unit(a) / patch.m + cross(Spin<Dim>(turn.col(a)), patch.r);
        return W;
    }
    for (int k = patch.first; k < patch.first + patch.count; ++k) {
        const PatchParticle<Dim>& e = particles[k];
        Mat<Dim> B;
        for (int a = 0; a < Dim; ++a)
            B.col(a) = e.a / patch.m * Vec<Dim>::Unit(a) + e.w * cross(Spin<Dim>(turn.col(a)), e.r);
        W += mass[e.particle] * B.transpose() * B;
    }
    return W;
}

template struct Patches<2>;
template struct Patches<3>;

}  // namespace quern
