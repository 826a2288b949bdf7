#include "particles/shape_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace quern {

template <int Dim>
double total_volume(const Shape<Dim>& shape) {
    double total = 0.0;
    for (const double v : shape.volume) total += v;
    return total;
}

template <int Dim>
Vec<Dim> first_moment(const Shape<Dim>& shape) {
    Vec<Dim> moment = Vec<Dim>::Zero();
    for (int i = 0; i < shape.n_nodes(); ++i) moment += shape.volume[i] * shape.X[i];
    return moment;
}

template <int Dim>
Mat<Dim> second_moment(const Shape<Dim>& shape) {
    Mat<Dim> moment = Mat<Dim>::Zero();
    for (int i = 0; i < shape.n_nodes(); ++i) moment += shape.volume[i] * shape.X[i] * shape.X[i].transpose();
    return moment;
}

template <int Dim>
bool is_connected(const Shape<Dim>& shape, double reach) {
    using Cell = std::array<long, 3>;
    const auto cell_of = [reach](const Vec<Dim>& x) {
        Cell cell{};
        for (int a = 0; a < Dim; ++a) cell[a] = std::lround(std::floor(x[a] / reach));
        return cell;
    };
    std::map<Cell, std::vector<int>> unseen;
    for (int i = 1; i < shape.n_nodes(); ++i) unseen[cell_of(shape.X[i])].push_back(i);

    std::vector<int> found{0};
    for (std::size_t next = 0; next < found.size(); ++next) {
        const Vec<Dim> x = shape.X[found[next]];
        const Cell home = cell_of(x);
        for (int k = 0; k < (Dim == 2 ? 9 : 27); ++k) {
            const Cell cell{home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, Dim == 2 ? 0 : home[2] + k / 9 - 1};
            const auto there = unseen.find(cell);
            if (there == unseen.end()) continue;
            std::erase_if(there->second, [&](int i) {
                if ((shape.X[i] - x).squaredNorm() > reach * reach) return false;
                found.push_back(i);
                return true;
            });
        }
    }
    return static_cast<int>(found.size()) == shape.n_nodes();
}

template <int Dim>
double largest_surface_gap(const Shape<Dim>& shape, const std::vector<Vec<Dim>>& points) {
    double worst = 0.0;
    for (const Vec<Dim>& p : points) {
        double nearest = std::numeric_limits<double>::max();
        for (const SurfacePoint<Dim>& s : shape.surface)
            nearest = std::min(nearest, (shape.X[s.node] - p).norm());
        worst = std::max(worst, nearest);
    }
    return worst;
}

template double total_volume(const Shape<2>&);
template double total_volume(const Shape<3>&);
template Vec<2> first_moment(const Shape<2>&);
template Vec<3> first_moment(const Shape<3>&);
template Mat<2> second_moment(const Shape<2>&);
template Mat<3> second_moment(const Shape<3>&);
template bool is_connected(const Shape<2>&, double);
template bool is_connected(const Shape<3>&, double);
template double largest_surface_gap(const Shape<2>&, const std::vector<Vec<2>>&);
template double largest_surface_gap(const Shape<3>&, const std::vector<Vec<3>>&);

}  // namespace quern
