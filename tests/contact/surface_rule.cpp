// Geometry of the surface rule against closed forms, its impulse map, corners and small grains.
#include "contact/surface_rule.hpp"

#include <algorithm>

#include "contact/patch.hpp"
#include "tests/contact/scenes.hpp"

namespace quern::test {

namespace {

constexpr double anywhere = std::numeric_limits<double>::infinity();

/// Surfaces of the grains of a world at its contact nodes.
template <int Dim>
class Surfaces {
  public:
    explicit Surfaces(const World<Dim>& world)
        : world_(world), scene_(world.scene()), nodes_(world.grid, {}), points_(world.particles.x) {
        fill_all(nodes_, scene_);
        for (const Grain<Dim>& grain : world.grains) {
            rotations_.push_back(surface_rotation<Dim>(grain, world.particles.x));
            footprints_.emplace_back(*grain.shape);
            find_surface<Dim>(grain, rotations_.back(), world.particles.x, points_);
        }
    }
    SurfaceSide<Dim> side(const Slot<Dim>& slot) const {
        return {&slot,
                &world_.grains[slot.grain],
                &rotations_[slot.grain],
                &footprints_[slot.grain],
                world_.particles.x,
                points_,
                world_.grid.node_position(slot.index)};
    }
    /// visit(contact, A, B) of all surface particles of `from` on the other grain.
    template <class Visit>
    void for_each_contact(int from, Visit&& visit) const {
        for (int i = 0; i < nodes_.n_nodes(); ++i)
            for (const int a : nodes_.slots_of(i))
                for (const int b : nodes_.slots_of(i)) {
                    if (a == b || nodes_.slots()[a].grain != from) continue;
                    const SurfaceSide<Dim> A = side(nodes_.slots()[a]), B = side(nodes_.slots()[b]);
                    for_each_owned<Dim>(A, world_.grid, [&](int surface) {
                        if (const auto contact = meet<Dim>(A, surface, B, anywhere)) visit(*contact, A, B);
                    });
                }
    }
    template <class Visit>
    void for_each_wall_contact(Visit&& visit) const {
        for (const Slot<Dim>& slot : nodes_.slots()) {
            const SurfaceSide<Dim> A = side(slot);
            for_each_owned<Dim>(A, world_.grid, [&](int surface) {
                visit(*meet<Dim>(A, surface, world_.walls[0], anywhere), A);
            });
        }
    }
    double least_gap(int from) const {
        double least = 1e300;
        for_each_contact(from, [&](const SurfaceContact<Dim>& contact, const auto&, const auto&) {
            least = std::min(least, contact.tile.gap);
        });
        return least;
    }
    const ContactScene<Dim>& scene() const { return scene_; }

  private:
    const World<Dim>& world_;
    ContactScene<Dim> scene_;
    ContactNodes<Dim> nodes_;
    std::vector<Vec<Dim>> points_;
    std::vector<Mat<Dim>> rotations_;
    std::vector<Footprints<Dim>> footprints_;
};

Shape<2> make_hexagon() {
    std::vector<Vec<2>> corners;
    for (int k = 0; k < 6; ++k)
        corners.emplace_back(radius * std::cos(k * std::numbers::pi / 3.0),
                             radius * std::sin(k * std::numbers::pi / 3.0));
    return make_lattice_shape<2>(Polygon(corners), Vec<2>::Constant(1.0 / 16.0));
}
Shape<2> make_block() {
    return make_lattice_shape<2>(Polygon({{-0.75, -0.25}, {0.75, -0.25}, {0.75, 0.25}, {-0.75, 0.25}}),
                                 Vec<2>::Constant(1.0 / 16.0));
}
Shape<3> make_brick() {
    return make_lattice_shape<3>(Cuboid({1.0, 0.75, 0.5}), Vec<3>::Constant(0.125));
}

/// Largest error [dx] of the least gap and of the normal there, of two balls `gap` [dx] apart.
template <int Dim>
std::pair<double, double> ball_errors(const Shape<Dim>& shape, double ratio, double gap) {
    double worst_gap = 0.0, worst_normal = 0.0;
    for (const Aim<Dim>& aim : aims<Dim>(Dim == 2 ? 30 : 15)) {
        World<Dim> world(make_grid<Dim>(2.0 * shape.dx, 48));
        const Vec<Dim> c = world.grid.h() * (Vec<Dim>::Constant(20.0) + aim.shift);
        Placement<Dim> placement;
        placement.scale = ratio;
        placement.angle = Spin<Dim>::Constant(aim.shift[0]);
        world.add(shape, c, Vec<Dim>::Zero());
        world.add(shape, c + ((1.0 + ratio) * radius + gap * shape.dx) * aim.direction, Vec<Dim>::Zero(),
                  placement);
        const Surfaces<Dim> surfaces(world);
        double least = 1e300, there = 0.0;
        for (const int from : {0, 1})
            surfaces.for_each_contact(
                from, [&](const SurfaceContact<Dim>& contact, const auto&, const auto&) {
                    if (contact.tile.gap > least) return;
                    least = contact.tile.gap;
                    there = ((from == 0 ? 1.0 : -1.0) * contact.tile.normal - aim.direction).norm();
                });
        worst_gap = std::max(worst_gap, std::abs(least / shape.dx - gap));
        worst_normal = std::max(worst_normal, there);
    }
    return {worst_gap, worst_normal};
}

}  // namespace

TEST_CASE("Surface: disks and balls know their distance and its direction") {
    const auto check = []<int Dim>(const Filling<Dim>& filling) {
        CAPTURE(Dim);
        CAPTURE(filling.name);
        double gap_error = 0.0, normal_error = 0.0;
        for (const double ratio : {1.0, 0.5})
            for (const double gap : {-0.2, 0.0, 0.3}) {
                const auto [of_gap, of_normal] = ball_errors<Dim>(filling.shape, ratio, gap);
                gap_error = std::max(gap_error, of_gap);
                normal_error = std::max(normal_error, of_normal);
            }
        // measured 7.4e-5 (rings), 4.2e-4 (lattice in the plane), 1.7e-3 (shells), 8.0e-3 (lattice in space)
        CHECK(gap_error < (Dim == 2 ? 1e-3 : 0.015));    // bound 1e-3, 0.015 [dx]
        CHECK(normal_error < (Dim == 2 ? 0.01 : 0.08));  // measured 0.0052 and 0.043, bound 0.01 and 0.08
    };
    for (const Filling<2>& filling : fillings<2>()) check(filling);
    for (const Filling<3>& filling : fillings<3>()) check(filling);
}

TEST_CASE("Surface: faces of blocks and bricks are exact") {
    const auto check = []<int Dim>(const Shape<Dim>& shape, const Aim<Dim>& aim) {
        CAPTURE(Dim);
        Placement<Dim> placement;
        placement.angle = aim.direction.template head<n_spin<Dim>>();
        const Mat<Dim> R = rotation_matrix(placement.angle);
        const Vec<Dim> n = R.col(Dim - 1);
        const double gap = 0.1 * shape.dx;
        World<Dim> world(make_grid<Dim>(2.0 * shape.dx));
        const Vec<Dim> c = world.grid.h() * (Vec<Dim>::Constant(16.0) + aim.shift);
        world.add(shape, c - (0.25 + 0.5 * gap) * n, Vec<Dim>::Zero(), placement);
        // Shifted along the face, so that corners are above faces.
        world.add(shape, c + (0.25 + 0.5 * gap) * n + 2.3 * shape.dx * R.col(0), Vec<Dim>::Zero(), placement);
        world.walls.push_back({c - (0.5 + 1.5 * gap) * n, n, Vec<Dim>::Zero(), 0.0});
        double worst = 0.0;
        int n_found = 0;
        const Surfaces<Dim> surfaces(world);
        const auto compare = [&](const SurfaceContact<Dim>& contact, const SurfaceSide<Dim>& A, double sign) {
            const Tile<Dim>& tile = contact.tile;
            if (tile.gap > 0.5 * shape.dx) return;
            if (contact.b >= 0 && A.footprints->sharp(contact.a)) {  // perhaps on another edge
                CHECK(tile.gap > gap - 1e-12);
                return;
            }
            worst = std::max({worst, std::abs(tile.gap - gap) / shape.dx, (sign * tile.normal - n).norm()});
            ++n_found;
        };
        for (const int from : {0, 1})
            surfaces.for_each_contact(from, [&](const auto& contact, const auto& A, const auto&) {
                compare(contact, A, from == 0 ? 1.0 : -1.0);
            });
        CHECK(n_found > 20);
        surfaces.for_each_wall_contact(
            [&](const auto& contact, const auto& A) { compare(contact, A, -1.0); });
        CHECK(worst < 1e-11);  // measured 6e-13, bound 1e-11 [dx]
    };
    for (const Aim<2>& aim : aims<2>(8)) check(make_block(), aim);
    for (const Aim<3>& aim : aims<3>(4)) check(make_brick(), aim);
}

TEST_CASE("Surface: a corner on a face touches when it is there, and goes no further") {
    const Shape<2> hexagon = make_hexagon(), block = make_block();
    double worst_gap = 0.0, worst_left = 0.0;
    for (const Aim<2>& aim : aims<2>(12)) {
        World<2> world(make_grid<2>(2.0 * block.dx));
        const Vec<2> c = world.grid.h() * (Vec<2>::Constant(16.0) + aim.shift);
        const double tilt = aim.direction[0];
        Placement<2> flat, on_corner;
        flat.angle = Spin<2>(tilt);
        on_corner.angle = Spin<2>(tilt + std::numbers::pi / 2.0 + 0.2 * aim.direction[1]);
        const Vec<2> n = rotation_matrix(flat.angle).col(1);
        world.add(block, c - 0.25 * n, Vec<2>::Zero(), flat);
        world.add(hexagon, c + radius * std::cos(0.2 * aim.direction[1]) * n, -n, on_corner);
        worst_gap = std::max(worst_gap, std::abs(Surfaces<2>(world).least_gap(1)) / block.dx);
        GridContactOptions options;
        options.rule = GridRule::surface;
        for (Vec<2>& x : world.particles.x)
            if (&x - world.particles.x.data() >= world.grains[1].first) x -= 0.3 * block.dx * n;
        const double first = world.collide(options).grain_impulse[1].dot(n);
        const double second = world.collide(options).grain_impulse[1].norm();
        CHECK(first > 0.0);
        worst_left = std::max(worst_left, second / first);
    }
    CHECK(worst_gap < 1e-12);  // measured 5e-15, bound 1e-12 [dx]
    CHECK(worst_left < 0.05);  // measured 0.0069, bound 0.05
}

TEST_CASE("Surface: grains smaller than a cell are felt") {
    const Shape<3> ball = make_lattice_shape<3>(Ball<3>(0.87), Vec<3>::Constant(0.5));
    for (const Aim<3>& aim : aims<3>(6)) {
        World<3> world(make_grid<3>(1.0));
        const Vec<3> c = Vec<3>::Constant(16.0) + aim.shift;
        world.add(ball, c, aim.direction);
        world.add(ball, c + 1.64 * aim.direction, -aim.direction);
        GridContactOptions options;
        options.rule = GridRule::surface;
        const double approach = aim.direction.dot(world.mean_velocity(0) - world.mean_velocity(1));
        CHECK(world.collide(options).grain_impulse[1].dot(aim.direction) > 0.0);
        CHECK(aim.direction.dot(world.mean_velocity(0) - world.mean_velocity(1)) < approach - 0.1);
    }
}

TEST_CASE("Patch: momentum and moment arrive whole, velocity is the adjoint, W is exact") {
    const auto check = []<int Dim>(const Filling<Dim>& filling) {
        CAPTURE(Dim);
        CAPTURE(filling.name);
        World<Dim> world(make_grid<Dim>(2.0 * filling.shape.dx));
        world.add(filling.shape, Vec<Dim>::Constant(2.0), Vec<Dim>::Zero());
        const ContactScene<Dim> scene = world.scene();
        const Footprints<Dim> footprints(filling.shape);
        std::vector<Vec<Dim>> points = world.particles.x;
        find_surface<Dim>(world.grains[0], Mat<Dim>::Identity(), world.particles.x, points);
        double linear = 0.0, angular = 0.0, power = 0.0, mass = 0.0;
        for (std::size_t s = 0; s < filling.shape.surface.size(); s += 5) {
            const SurfacePoint<Dim>& point = filling.shape.surface[s];
            const Vec<Dim> x_c =
                Vec<Dim>::Constant(2.0) + filling.shape.X[point.node] + (point.delta + 0.02) * point.nu;
            Patches<Dim> patches;
            const int number = patches.add(scene, world.grains[0], points, footprints, static_cast<int>(s),
                                           x_c, x_c, point.nu, false);
            REQUIRE(patches.patches[number].rotates);
            std::vector<Vec<Dim>> v;
            for (const Vec<Dim>& x : world.particles.x) v.push_back(x.reverse().cwiseProduct(x));
            const Vec<Dim> J = Vec<Dim>::LinSpaced(Dim, 1.0, -2.0), u = patches.velocity(number, v);
            std::vector<Vec<Dim>> dv(v.size(), Vec<Dim>::Zero());
            patches.add_impulse(number, J, dv);
            Vec<Dim> P = Vec<Dim>::Zero();
            Spin<Dim> L = Spin<Dim>::Zero();
            double received = 0.0;
            for (std::size_t p = 0; p < dv.size(); ++p) {
                const Vec<Dim> momentum = world.particles.mass[p] * dv[p];
                P += momentum;
                L += moment(Vec<Dim>(world.particles.x[p] - x_c), momentum);
                received += v[p].dot(momentum);
            }
            linear = std::max(linear, (P - J).norm());
            angular = std::max(angular, L.norm() / filling.shape.dx);
            power = std::max(power, std::abs(received - u.dot(J)));
            const Mat<Dim> W = patches.inverse_mass(number, world.particles.mass, true);
            mass = std::max(mass, (patches.velocity(number, dv) - W * J).norm() / (W * J).norm());
        }
        CHECK(linear < 1e-13);   // measured 1.4e-15, bound 1e-13
        CHECK(angular < 1e-12);  // measured 1.5e-15, bound 1e-12
        CHECK(power < 1e-12);    // measured 2.7e-15, bound 1e-12
        CHECK(mass < 1e-13);     // measured 4.6e-16, bound 1e-13
    };
    for (const Filling<2>& filling : fillings<2>()) check(filling);
    for (const Filling<3>& filling : fillings<3>()) check(filling);
}

}  // namespace quern::test
