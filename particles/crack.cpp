#include "particles/crack.hpp"

#include <algorithm>

namespace quern {
namespace {

Vec<2> normal_of(const Crack<2>& crack) {
    return {-crack.edge[0][1], crack.edge[0][0]};
}

Vec<3> normal_of(const Crack<3>& crack) {
    return crack.edge[0].cross(crack.edge[1]);
}

}  // namespace

template <int Dim>
double Crack<Dim>::size() const {
    return normal_of(*this).norm();
}

template <int Dim>
bool Crack<Dim>::cuts(const Vec<Dim>& a, const Vec<Dim>& b) const {
    constexpr double tolerance = 1e-9;
    const Vec<Dim> normal = normal_of(*this).normalized();
    const double height_a = normal.dot(a - corner), height_b = normal.dot(b - corner);
    const double least = -tolerance * (b - a).norm();
    if ((height_a >= least) == (height_b >= least)) return false;
    const double part = std::clamp(height_a / (height_a - height_b), 0.0, 1.0);
    const Vec<Dim> at = a + part * (b - a) - corner;
    Eigen::Matrix<double, Dim, Dim - 1> edges;
    for (int k = 0; k < Dim - 1; ++k) edges.col(k) = edge[k];
    const Eigen::Matrix<double, Dim - 1, 1> t =
        (edges.transpose() * edges).inverse() * (edges.transpose() * at);
    return t.minCoeff() >= -tolerance && t.maxCoeff() <= 1.0 + tolerance;
}

template struct Crack<2>;
template struct Crack<3>;

}  // namespace quern
