#include "contact/footprint.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "particles/polygon.hpp"

namespace quern {

namespace {

/// Least cosine between normals of one face of a shape with corners.
constexpr double same_face = 0.9;
/// Spread [dx^2] of the particles of a face that tells a plane: two a spacing apart, as at a corner between
/// two lattice rows, have 0.25, three in a row 0.67.
constexpr double least_spread = 0.4;
/// Faces next to an edge have particles within this [dx].
constexpr double next_to = 2.0;
/// Corners are taken to be no more pointed than this cosine of half their turn.
constexpr double bluntest = 0.3;

/// Nodes sorted into cubes, so that finding neighbours stays linear in their number.
template <int Dim>
class Cubes {
  public:
    Cubes(const std::vector<Vec<Dim>>& X, double edge) : edge_(edge) {
        for (int i = 0; i < static_cast<int>(X.size()); ++i) nodes_[key(cube(X[i]))].push_back(i);
    }
    template <class Visit>
    void for_each_near(const Vec<Dim>& x, Visit&& visit) const {
        const IntVec<Dim> middle = cube(x);
        for (int k = 0; k < power(3, Dim); ++k) {
            IntVec<Dim> c = middle;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= 3) c[a] += rest % 3 - 1;
            const auto found = nodes_.find(key(c));
            if (found == nodes_.end()) continue;
            for (const int i : found->second) visit(i);
        }
    }

  private:
    using Key = std::array<int, 3>;
    static Key key(const IntVec<Dim>& c) {
        Key k{};
        for (int a = 0; a < Dim; ++a) k[static_cast<std::size_t>(a)] = c[a];
        return k;
    }
    IntVec<Dim> cube(const Vec<Dim>& x) const {
        IntVec<Dim> c;
        for (int a = 0; a < Dim; ++a) c[a] = static_cast<int>(std::floor(x[a] / edge_));
        return c;
    }
    double edge_;
    std::map<Key, std::vector<int>> nodes_;
};

}  // namespace

template <int Dim>
Footprints<Dim>::Footprints(const Shape<Dim>& shape) {
    const std::vector<SurfacePoint<Dim>>& surface = shape.surface;
    std::vector<int> surface_of(shape.X.size(), -1);
    for (std::size_t s = 0; s < surface.size(); ++s) surface_of[surface[s].node] = static_cast<int>(s);
    const double far = reach * shape.dx;
    const Cubes<Dim> cubes(shape.X, far);
    begin_.push_back(0);
    for (const SurfacePoint<Dim>& point : surface) {
        const Vec<Dim>& x = shape.X[point.node];
        Mat<Dim> spread = Mat<Dim>::Zero();
        Vec<Dim> mean = Vec<Dim>::Zero();
        double n = 0.0;
        std::vector<Neighbour> found;
        cubes.for_each_near(x, [&](int i) {
            const Vec<Dim> d = (shape.X[i] - x) / shape.dx;
            if (d.norm() > reach) return;
            Neighbour neighbour{i, surface_of[i], false};
            if (neighbour.surface >= 0) {
                const double cosine = surface[neighbour.surface].nu.dot(point.nu);
                neighbour.beside = cosine > (shape.cornered ? same_face : 0.0);
            }
            if (neighbour.beside) {
                spread += d * d.transpose();
                mean += d;
                n += 1.0;
            }
            found.push_back(neighbour);
        });
        std::sort(found.begin(), found.end(),
                  [](const Neighbour& a, const Neighbour& b) { return a.node < b.node; });
        neighbours_.insert(neighbours_.end(), found.begin(), found.end());
        begin_.push_back(static_cast<int>(neighbours_.size()));
        spread = spread / n - mean * mean.transpose() / (n * n);
        // Of Dim eigenvalues the least belongs to the normal; the next one is that of the narrower way.
        const Eigen::SelfAdjointEigenSolver<Mat<Dim>> eigen(spread, Eigen::EigenvaluesOnly);
        sharp_.push_back(shape.cornered && eigen.eigenvalues()[1] < least_spread ? 1 : 0);
    }
    tip_of_.assign(surface.size(), -1);
    if (shape.cornered) find_tips(shape);
}

template <int Dim>
void Footprints<Dim>::find_tips(const Shape<Dim>& shape) {
    const auto add = [&](int s, const Vec<Dim>& offset, const Vec<Dim>& normal) {
        if (tip_of_[s] >= 0) return;
        tip_of_[s] = static_cast<int>(tips_.size());
        tips_.push_back({offset, normal});
    };
    if constexpr (Dim == 2) {
        const std::vector<VertexFrame> frames = make_vertex_frames(shape.outline);
        const std::size_t n = shape.outline.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Vec<2>& vertex = shape.outline[i];
            const Vec<2> before = vertex - shape.outline[(i + n - 1) % n],
                         after = shape.outline[(i + 1) % n] - vertex;
            if (!frames[i].corner || before[0] * after[1] < before[1] * after[0]) continue;  // a notch
            std::size_t nearest = 0;
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t s = 0; s < shape.surface.size(); ++s) {
                const double squared = (shape.X[shape.surface[s].node] - vertex).squaredNorm();
                if (squared < least) {
                    least = squared;
                    nearest = s;
                }
            }
            add(static_cast<int>(nearest), vertex - shape.X[shape.surface[nearest].node], frames[i].normal);
        }
    }
    for (int s = 0; s < static_cast<int>(shape.surface.size()); ++s) {
        if (!sharp_[s]) continue;
        const SurfacePoint<Dim>& point = shape.surface[s];
        double cosine = 1.0;
        for (const Neighbour& neighbour : around(s)) {
            if (neighbour.surface < 0 || sharp_[neighbour.surface]) continue;
            const SurfacePoint<Dim>& face = shape.surface[neighbour.surface];
            if ((shape.X[face.node] - shape.X[point.node]).norm() <= next_to * shape.dx)
                cosine = std::min(cosine, point.nu.dot(face.nu));
        }
        add(s, point.delta / std::max(cosine, bluntest) * point.nu, point.nu);
    }
}

template class Footprints<2>;
template class Footprints<3>;

}  // namespace quern
