#include "contact/node_patch.hpp"

#include "contact/point_cells.hpp"

namespace quern {

namespace {

constexpr double reach = 1.5;     ///< of a patch [spacings]
constexpr double torn_off = 3.0;  ///< members further away than this have left it [spacings]

template <int Dim>
bool belongs(const Grain<Dim>& grain, const Vec<Dim>& node, const Vec<Dim>& member) {
    const double limit = torn_off * grain.shape->dx * grain.scale;
    return (member - node).squaredNorm() <= limit * limit;
}

Spin<2> inverse_inertia(const Mat<2>& second) {
    return Spin<2>(1.0 / second.trace());
}
Mat<3> inverse_inertia(const Mat<3>& second) {
    const Mat<3> inertia = second.trace() * Mat<3>::Identity() - second;
    // Two members span no inertia about their line.
    const double size = inertia.trace() / 3.0;
    if (inertia.determinant() <= 1e-3 * size * size * size) return Mat<3>::Zero();
    return inertia.inverse();
}

}  // namespace

template <int Dim>
NodePatches<Dim>::NodePatches(const Shape<Dim>& shape) {
    PointCells<Dim> cells;
    const double r = reach * shape.dx;
    cells.sort(shape.X, r, nullptr);
    first_.push_back(0);
    for (const Vec<Dim>& X : shape.X) {
        cells.visit_near(X, [&](int k) {
            if ((shape.X[k] - X).squaredNorm() <= r * r) nodes_.push_back(k);
        });
        std::sort(nodes_.begin() + first_.back(), nodes_.end());
        first_.push_back(static_cast<int>(nodes_.size()));
    }
}

template <int Dim>
PatchMotion<Dim> patch_motion(const Grain<Dim>& grain, std::span<const int> patch, int node,
                              std::span<const Vec<Dim>> x, std::span<const Vec<Dim>> v,
                              std::span<const double> mass) {
    PatchMotion<Dim> motion;
    const Vec<Dim> middle = x[grain.first + node], v_middle = v[grain.first + node];
    double total = 0.0;
    int n_members = 0;
    Vec<Dim> first = Vec<Dim>::Zero(), momentum = Vec<Dim>::Zero();
    Mat<Dim> second = Mat<Dim>::Zero();
    Spin<Dim> L = Spin<Dim>::Zero();
    // All about the node, one pass: nearby numbers lose nothing in what is taken off below.
    for (const int k : patch) {
        const int p = grain.first + k;
        if (!belongs(grain, middle, x[p])) continue;
        const Vec<Dim> r = x[p] - middle, mr = mass[p] * r, u = v[p] - v_middle;
        total += mass[p];
        first += mr;
        momentum += mass[p] * u;
        second += mr * r.transpose();
        L += moment(mr, u);
        ++n_members;
    }
    const Vec<Dim> offset = first / total;
    motion.centre = middle + offset;
    if (n_members < 2) return motion;
    second -= offset * first.transpose();
    motion.inverse = inverse_inertia(second);
    motion.omega = motion.inverse * (L - moment(offset, momentum));
    return motion;
}

template <int Dim>
Spin<Dim> patch_spin(const PatchMotion<Dim>& motion, const Grain<Dim>& grain, std::span<const int> patch,
                     int node, std::span<const Vec<Dim>> x, std::span<const Vec<Dim>> v,
                     std::span<const double> mass) {
    const Vec<Dim> middle = x[grain.first + node];
    Spin<Dim> L = Spin<Dim>::Zero();
    for (const int k : patch) {
        const int p = grain.first + k;
        if (belongs(grain, middle, x[p])) L += mass[p] * moment(Vec<Dim>(x[p] - motion.centre), v[p]);
    }
    return motion.inverse * L;
}

template <int Dim>
void turn_patch(const PatchMotion<Dim>& motion, const Spin<Dim>& tau, const Grain<Dim>& grain,
                std::span<const int> patch, int node, std::span<const Vec<Dim>> x, std::span<Vec<Dim>> v) {
    const Vec<Dim> middle = x[grain.first + node];
    const Spin<Dim> turn = motion.inverse * tau;
    for (const int k : patch) {
        const int p = grain.first + k;
        if (belongs(grain, middle, x[p])) v[p] += cross(turn, Vec<Dim>(x[p] - motion.centre));
    }
}

template class NodePatches<2>;
template class NodePatches<3>;
template PatchMotion<2> patch_motion<2>(const Grain<2>&, std::span<const int>, int, std::span<const Vec<2>>,
                                        std::span<const Vec<2>>, std::span<const double>);
template PatchMotion<3> patch_motion<3>(const Grain<3>&, std::span<const int>, int, std::span<const Vec<3>>,
                                        std::span<const Vec<3>>, std::span<const double>);
template Spin<2> patch_spin<2>(const PatchMotion<2>&, const Grain<2>&, std::span<const int>, int,
                               std::span<const Vec<2>>, std::span<const Vec<2>>, std::span<const double>);
template Spin<3> patch_spin<3>(const PatchMotion<3>&, const Grain<3>&, std::span<const int>, int,
                               std::span<const Vec<3>>, std::span<const Vec<3>>, std::span<const double>);
template void turn_patch<2>(const PatchMotion<2>&, const Spin<2>&, const Grain<2>&, std::span<const int>, int,
                            std::span<const Vec<2>>, std::span<Vec<2>>);
template void turn_patch<3>(const PatchMotion<3>&, const Spin<3>&, const Grain<3>&, std::span<const int>, int,
                            std::span<const Vec<3>>, std::span<Vec<3>>);

}  // namespace quern
