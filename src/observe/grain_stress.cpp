#include "src/observe/grain_stress.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace quern {

template <int Dim>
std::vector<Mat<Dim>> contact_stress(std::span<const ContactPoint<Dim>> points, double dt,
                                     std::span<const Vec<Dim>> centres, std::span<const double> volumes) {
    std::vector<Mat<Dim>> stress(centres.size(), Mat<Dim>::Zero());
    const auto add = [&](int grain, const Vec<Dim>& impulse, const Vec<Dim>& at) {
        const std::size_t g = static_cast<std::size_t>(grain);
        const Mat<Dim> moment = impulse * (at - centres[g]).transpose() / (dt * volumes[g]);
        stress[g] += 0.5 * (moment + moment.transpose());
    };
    for (const ContactPoint<Dim>& point : points) {
        add(point.first, -point.impulse, point.at_first);
        if (point.second >= 0) add(point.second, point.impulse, point.at_second);
    }
    return stress;
}

Principal principal(const Mat<2>& tensor) {
    const double mean = 0.5 * tensor.trace(), half = 0.5 * (tensor(0, 0) - tensor(1, 1));
    const double shear = 0.5 * (tensor(0, 1) + tensor(1, 0)), radius = std::hypot(half, shear);
    return {mean + radius, mean - radius, 0.5 * std::atan2(shear, half)};
}

Principal principal(const Mat<3>& tensor) {
    const Eigen::SelfAdjointEigenSolver<Mat<3>> solver(tensor, Eigen::EigenvaluesOnly);
    return {solver.eigenvalues()[2], solver.eigenvalues()[0], 0.0};
}

template std::vector<Mat<2>> contact_stress<2>(std::span<const ContactPoint<2>>, double,
                                               std::span<const Vec<2>>, std::span<const double>);
template std::vector<Mat<3>> contact_stress<3>(std::span<const ContactPoint<3>>, double,
                                               std::span<const Vec<3>>, std::span<const double>);

}  // namespace quern
