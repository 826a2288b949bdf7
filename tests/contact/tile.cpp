// Geometry of tiles against closed forms. All errors in units of the cell size h.
#include "contact/tile.hpp"

#include <algorithm>

#include "tests/contact/scenes.hpp"

namespace quern::test {

namespace {

constexpr double far = 1e9;

/// Where the line x + y n meets the sphere of radius R about c nearest to y = 0; `far` if it misses.
template <int Dim>
double meet_ball(const Vec<Dim>& x, const Vec<Dim>& n, const Vec<Dim>& c, double R) {
    const Vec<Dim> d = c - x;
    const double along = n.dot(d), across = d.squaredNorm() - along * along;
    if (across >= R * R) return far;
    const double half = std::sqrt(R * R - across);
    return std::abs(along - half) < std::abs(along + half) ? along - half : along + half;
}

struct Errors {
    double gap = 0, point = 0;  ///< of all tiles that may touch soon
    double normal_there = 0;    ///< of the tile nearest to the contact
    int n = 0;
};

/// Compares a tile with the true surfaces: `y_a` and `y_b` are where the line through the tile's point along
/// its normal meets them. Only tiles that may touch soon count: far from the contact, at the end of a cell, a
/// parabola is no circle, and nothing happens there.
template <int Dim>
void compare(const Tile<Dim>& tile, double y_a, double y_b, double h, Errors& errors) {
    if (y_b - y_a > 0.2 * h) return;
    errors.gap = std::max(errors.gap, std::abs(tile.gap - (y_b - y_a)) / h);
    errors.point = std::max(errors.point, std::abs(y_a + y_b) / 2.0 / h);
    ++errors.n;
}

/// Two balls of radii R and `ratio` R, `gap` apart.
template <int Dim>
Errors measure_balls(const Shape<Dim>& shape, double ratio, double gap) {
    const double h = 2.0 * shape.dx;
    Errors errors;
    for (const Aim<Dim>& aim : aims<Dim>(Dim == 2 ? 40 : 20)) {
        World<Dim> world(make_grid<Dim>(h, 48));
        const Vec<Dim> middle = h * (Vec<Dim>::Constant(24.0) + aim.shift);
        const Vec<Dim> c_a = middle - (radius + 0.5 * gap) * aim.direction;
        const Vec<Dim> c_b = middle + (ratio * radius + 0.5 * gap) * aim.direction;
        world.add(shape, c_a, Vec<Dim>::Zero());
        Placement<Dim> placement;
        placement.scale = ratio;
        world.add(shape, c_b, Vec<Dim>::Zero(), placement);
        ContactNodes<Dim> nodes(world.grid, {});
        fill_all(nodes, world.scene());
        const Mat<Dim> rotation = Mat<Dim>::Identity();
        double nearest = far;
        Errors there;
        for (int i = 0; i < nodes.n_nodes(); ++i) {
            if (nodes.slots_of(i).size() < 2) continue;
            const Slot<Dim>*A = &nodes.slots()[nodes.slots_of(i)[0]],
                  *B = &nodes.slots()[nodes.slots_of(i)[1]];
            if (A->grain != 0) std::swap(A, B);
            const auto tile =
                make_tile<Dim>({A, &world.grains[0], &rotation}, {B, &world.grains[1], &rotation}, h, {});
            if (!tile) continue;
            const Vec<Dim> x = world.grid.node_position(A->index) + tile->point;
            compare<Dim>(*tile, meet_ball<Dim>(x, tile->normal, c_a, radius),
                         meet_ball<Dim>(x, tile->normal, c_b, ratio * radius), h, errors);
            if ((x - middle).norm() < nearest) {
                nearest = (x - middle).norm();
                there.normal_there = (tile->normal - aim.direction).norm();
            }
        }
        CHECK(nearest < 0.6 * h);
        errors.normal_there = std::max(errors.normal_there, there.normal_there);
    }
    return errors;
}

/// A ball, `gap` above the plane through `middle` across the direction.
template <int Dim>
Errors measure_wall(const Shape<Dim>& shape, double gap) {
    const double h = 2.0 * shape.dx;
    Errors errors;
    for (const Aim<Dim>& aim : aims<Dim>(Dim == 2 ? 40 : 20)) {
        World<Dim> world(make_grid<Dim>(h, 48));
        const Vec<Dim> middle = h * (Vec<Dim>::Constant(24.0) + aim.shift);
        const Vec<Dim> centre = middle + (radius + gap) * aim.direction;
        world.add(shape, centre, Vec<Dim>::Zero());
        world.walls.push_back({middle, aim.direction, Vec<Dim>::Zero(), 0.0});
        ContactNodes<Dim> nodes(world.grid, {});
        fill_all(nodes, world.scene());
        const Mat<Dim> rotation = Mat<Dim>::Identity();
        double nearest = far;
        for (const Slot<Dim>& slot : nodes.slots()) {
            const double offset = world.walls[0].distance(world.grid.node_position(slot.index));
            const auto tile =
                make_wall_tile<Dim>({&slot, &world.grains[0], &rotation}, world.walls[0], offset, h, {});
            if (!tile) continue;
            CHECK((tile->normal + aim.direction).norm() < 1e-14);
            const Vec<Dim> x = world.grid.node_position(slot.index) + tile->point;
            const double y_b = world.walls[0].distance(x);  // the normal points into the wall
            const double y_a = meet_ball<Dim>(x, tile->normal, centre, radius);
            if (y_a == far || std::abs(y_a) > h) continue;  // beside the ball
            compare<Dim>(*tile, y_a, y_b, h, errors);
            nearest = std::min(nearest, (x - middle).norm());
        }
        CHECK(nearest < 0.6 * h);
    }
    return errors;
}

}  // namespace

TEST_CASE("Tile: ball against ball") {
    const auto check = []<int Dim>(const Filling<Dim>& filling) {
        CAPTURE(Dim);
        CAPTURE(filling.name);
        for (const double ratio : {1.0, 0.6}) {
            CAPTURE(ratio);
            for (const double gap : {0.0, 0.2, -0.2}) {
                CAPTURE(gap);
                const Errors errors = measure_balls<Dim>(filling.shape, ratio, gap * filling.shape.dx);
                CHECK(errors.n > 20);
                // The gap of a tile at the end of its cell is off by the error of a parabola.
                // measured 0.104, 0.063 (least curvature of a pair) and 0.12, bound 0.2, 0.08 and 0.2
                CHECK(errors.gap < 0.2);
                CHECK(errors.point < 0.08);
                CHECK(errors.normal_there < 0.2);
            }
        }
    };
    for (const Filling<2>& filling : fillings<2>()) check(filling);
    for (const Filling<3>& filling : fillings<3>()) check(filling);
}

TEST_CASE("Tile: ball against wall") {
    const auto check = []<int Dim>(const Filling<Dim>& filling) {
        CAPTURE(Dim);
        CAPTURE(filling.name);
        for (const double gap : {0.0, 0.2, -0.2}) {
            CAPTURE(gap);
            const Errors errors = measure_wall<Dim>(filling.shape, gap * filling.shape.dx);
            CHECK(errors.n > 20);
            CHECK(errors.gap < 0.15);    // measured 0.079, bound 0.15
            CHECK(errors.point < 0.08);  // measured 0.040, bound 0.08
        }
    };
    for (const Filling<2>& filling : fillings<2>()) check(filling);
    for (const Filling<3>& filling : fillings<3>()) check(filling);
}

TEST_CASE("Tile: nearly flat grains meet nearer to the node, on a wall where they do") {
    const Shape<2> shape = make_rings_shape(radius, 40);
    const double h = 2.0 * shape.dx, beside = 0.4 * h;  // of the contact, from the node
    const double q2 = h / radius;                       // of two equal disks: 0.05, below the floor of 0.1
    const Vec<2> node = h * Vec<2>::Constant(48.0), foot = node + Vec<2>(beside, 0.0);
    const Vec<2> up(0.0, radius);
    const auto tile_at_node = [&](World<2>& world) {
        ContactNodes<2> nodes(world.grid, {});
        fill_all(nodes, world.scene());
        const Mat<2> rotation = Mat<2>::Identity();
        for (int i = 0; i < nodes.n_nodes(); ++i) {
            const std::span<const int> slots = nodes.slots_of(i);
            const Slot<2>& first = nodes.slots()[slots[0]];
            if (first.index != IntVec<2>(48, 48)) continue;
            const TileSide<2> A{&first, &world.grains[first.grain], &rotation};
            if (slots.size() < 2) return make_wall_tile<2>(A, world.walls[0], 0.0, h, {});
            const Slot<2>& second = nodes.slots()[slots[1]];
            return make_tile<2>(A, {&second, &world.grains[second.grain], &rotation}, h, {});
        }
        return std::optional<Tile<2>>();
    };
    World<2> pair(make_grid<2>(h, 96)), wall(make_grid<2>(h, 96));
    pair.add(shape, foot + up, Vec<2>::Zero());
    pair.add(shape, foot - up, Vec<2>::Zero());
    wall.add(shape, foot + up, Vec<2>::Zero());
    wall.walls.push_back({node, Vec<2>::Unit(1), Vec<2>::Zero(), 0.0});
    const auto with_grain = tile_at_node(pair), with_wall = tile_at_node(wall);
    REQUIRE(with_grain.has_value());
    REQUIRE(with_wall.has_value());
    CHECK(std::abs(with_grain->point[0] - beside * q2 / 0.1) < 0.01 * h);  // measured 0.0011 h, bound 0.01 h
    CHECK(std::abs(with_wall->point[0] - beside) < 0.01 * h);              // measured 0.0026 h, bound 0.01 h
}

TEST_CASE("Tile: a block on a tilted wall is exact") {
    const Shape<2> block = make_lattice_shape<2>(
        Polygon({{-0.5, -0.25}, {0.5, -0.25}, {0.5, 0.25}, {-0.5, 0.25}}), Vec<2>::Constant(1.0 / 12.0));
    const Shape<3> brick = make_lattice_shape<3>(Cuboid({1.0, 0.75, 0.5}), Vec<3>::Constant(0.125));
    const auto check = []<int Dim>(const Shape<Dim>& shape, const Aim<Dim>& aim, const Mat<Dim>& R) {
        CAPTURE(Dim);
        const double h = 2.0 * shape.dx, gap = 0.1 * shape.dx;
        World<Dim> world(make_grid<Dim>(h));
        const Vec<Dim> foot = h * (Vec<Dim>::Constant(16.0) + aim.shift);
        const Vec<Dim> n = R.col(Dim - 1);
        Placement<Dim> placement;
        placement.angle = aim.direction.template head<n_spin<Dim>>();
        world.add(shape, foot + (0.25 + gap) * n, Vec<Dim>::Zero(), placement);
        world.walls.push_back({foot, n, Vec<Dim>::Zero(), 0.0});
        ContactNodes<Dim> nodes(world.grid, {});
        fill_all(nodes, world.scene());
        const Mat<Dim> rotation = surface_rotation<Dim>(world.grains[0], world.particles.x);
        CHECK((rotation - R).norm() < 1e-12);
        int n_tiles = 0;
        double worst = 0.0;
        for (const Slot<Dim>& slot : nodes.slots()) {
            const double offset = world.walls[0].distance(world.grid.node_position(slot.index));
            const auto tile =
                make_wall_tile<Dim>({&slot, &world.grains[0], &rotation}, world.walls[0], offset, h, {});
            if (!tile) continue;
            ++n_tiles;
            worst = std::max(worst, std::abs(tile->gap - gap) / h);
        }
        CHECK(n_tiles > 4);
        CHECK(worst < 1e-12);  // measured 1.1e-13, bound 1e-12
    };
    for (const Aim<2>& aim : aims<2>(8)) check(block, aim, rotation_matrix(Spin<2>(aim.direction[0])));
    for (const Aim<3>& aim : aims<3>(4)) check(brick, aim, rotation_matrix(Spin<3>(aim.direction)));
}

TEST_CASE("Tile: the surface of a grain tells how it is turned, wherever it is") {
    const Shape<2> triangle =  // its surface particles have another centre than its mass
        make_lattice_shape<2>(Polygon({{0.0, 0.0}, {1.0, 0.0}, {0.0, 0.4}}), Vec<2>::Constant(0.05));
    for (const Aim<2>& aim : aims<2>(8)) {
        World<2> world(make_grid<2>(0.1));
        Placement<2> placement;
        placement.angle = Spin<2>(3.0 * aim.direction[0]);
        placement.scale = 0.7;
        world.add(triangle, Vec<2>(120.0, -35.0), Vec<2>::Zero(), placement);
        const Mat<2> R = surface_rotation<2>(world.grains[0], world.particles.x);
        CHECK((R - rotation_matrix(placement.angle)).norm() < 1e-12);  // measured 4e-14, bound 1e-12
    }
}

TEST_CASE("Tile: tangents and normal make a right-handed frame") {
    for (const Aim<3>& aim : aims<3>(20)) {
        const Eigen::Matrix<double, 3, 2> T = tangents<3>(aim.direction);
        CHECK((T.transpose() * T - Mat<2>::Identity()).norm() < 1e-14);
        CHECK((T.col(0).cross(T.col(1)) - aim.direction).norm() < 1e-14);
    }
    for (const Aim<2>& aim : aims<2>(20)) {
        const Vec<2> t = tangents<2>(aim.direction);
        CHECK(t.dot(aim.direction) == 0.0);
        CHECK(moment(aim.direction, t)[0] == doctest::Approx(1.0));
    }
}

}  // namespace quern::test
