#include "particles/grains.hpp"

#include <Eigen/SVD>

namespace quern {

namespace {

Mat<2> nearest_rotation(const Mat<2>& A) {
    const double angle = std::atan2(A(1, 0) - A(0, 1), A(0, 0) + A(1, 1));
    return rotation_matrix(Spin<2>(angle));
}

Mat<3> nearest_rotation(const Mat<3>& A) {
    const Eigen::JacobiSVD<Mat<3>> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat<3> S = Mat<3>::Identity();
    S(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
    return svd.matrixU() * S * svd.matrixV().transpose();
}

Spin<2> solve_inertia(const Mat<2>& second_moment, const Spin<2>& L) {
    return L / second_moment.trace();
}

Spin<3> solve_inertia(const Mat<3>& second_moment, const Spin<3>& L) {
    const Mat<3> inertia = second_moment.trace() * Mat<3>::Identity() - second_moment;
    return inertia.inverse() * L;
}

}  // namespace

template <int Dim>
Mat<Dim> best_fit_rotation(const Grain<Dim>& grain, std::span<const Vec<Dim>> x,
                           std::span<const double> mass) {
    Mat<Dim> A = Mat<Dim>::Zero();
    for (int p = 0; p < grain.count; ++p)  // sum m X = 0: the centre of x drops out
        A += mass[grain.first + p] * x[grain.first + p] * grain.shape->X[p].transpose();
    return nearest_rotation(A);
}

template <int Dim>
Mat<Dim> surface_rotation(const Grain<Dim>& grain, std::span<const Vec<Dim>> x) {
    const std::vector<SurfacePoint<Dim>>& surface = grain.shape->surface;
    Mat<Dim> A = Mat<Dim>::Zero();
    Vec<Dim> x_sum = Vec<Dim>::Zero(), X_sum = Vec<Dim>::Zero();
    const Vec<Dim> x_first = x[grain.first + surface.front().node];
    for (const SurfacePoint<Dim>& point : surface) {
        const Vec<Dim> r = x[grain.first + point.node] - x_first;
        const Vec<Dim>& X = grain.shape->X[point.node];
        A += r * X.transpose();
        x_sum += r;
        X_sum += X;
    }
    A -= x_sum * X_sum.transpose() / static_cast<double>(surface.size());
    return nearest_rotation(A);
}

template <int Dim>
GrainMotion<Dim> grain_motion(const Grain<Dim>& grain, const Particles<Dim>& particles) {
    GrainMotion<Dim> motion;
    motion.centre.setZero();
    motion.velocity.setZero();
    for (int p = grain.first; p < grain.first + grain.count; ++p) {
        motion.centre += particles.mass[p] * particles.x[p];
        motion.velocity += particles.mass[p] * particles.v[p];
    }
    motion.centre /= grain.mass;
    motion.velocity /= grain.mass;
    Spin<Dim> L = Spin<Dim>::Zero();
    Mat<Dim> second = Mat<Dim>::Zero();
    for (int p = grain.first; p < grain.first + grain.count; ++p) {
        const Vec<Dim> r = particles.x[p] - motion.centre;
        L += particles.mass[p] * moment(r, Vec<Dim>(particles.v[p] - motion.velocity));
        second += particles.mass[p] * r * r.transpose();
    }
    motion.omega = solve_inertia(second, L);
    motion.rotation = best_fit_rotation<Dim>(grain, particles.x, particles.mass);
    return motion;
}

template Mat<2> best_fit_rotation<2>(const Grain<2>&, std::span<const Vec<2>>, std::span<const double>);
template Mat<3> best_fit_rotation<3>(const Grain<3>&, std::span<const Vec<3>>, std::span<const double>);
template Mat<2> surface_rotation<2>(const Grain<2>&, std::span<const Vec<2>>);
template Mat<3> surface_rotation<3>(const Grain<3>&, std::span<const Vec<3>>);
template GrainMotion<2> grain_motion<2>(const Grain<2>&, const Particles<2>&);
template GrainMotion<3> grain_motion<3>(const Grain<3>&, const Particles<3>&);

}  // namespace quern
