#include "src/mesh/make_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

#include "grid/error.hpp"
#include "particles/shape_builders.hpp"
#include "particles/shape_checks.hpp"
#include "src/mesh/element_mesh.hpp"
#include "src/mesh/generate_mesh.hpp"
#include "src/mesh/mesh_file.hpp"

namespace quern {
namespace {

std::string where(const ShapeDeck& deck, const char* field) {
    Place place = deck.place;
    place.key = place.key.empty() ? field : fmt::format("{}.{}", place.key, field);
    return place.text();
}

void require_positive(const ShapeDeck& deck, const char* field, double value) {
    if (!(value > 0.0) || !std::isfinite(value))
        throw InputError(where(deck, field), fmt::format("{}", value), "a positive number");
}

/// Refuses what would be a slip in the units rather than a shape.
void require_affordable(const ShapeDeck& deck, double measure, int dim) {
    constexpr double most = 2e7;
    const double n_nodes = measure / std::pow(deck.spacing, dim);
    if (n_nodes > most)
        throw InputError(where(deck, "spacing"),
                         fmt::format("{} m, which makes about {:.1e} nodes", deck.spacing, n_nodes),
                         fmt::format("at most {:.0e} nodes a shape", most), "check the units");
}

template <int Dim>
void require_enough_nodes(const ShapeDeck& deck, const Shape<Dim>& shape) {
    constexpr int least = Dim == 2 ? 4 : 8;
    const char* field = deck.kind == ShapeKind::mesh ? "file" : "spacing";
    if (shape.n_nodes() < least)
        throw InputError(where(deck, field), fmt::format("{} nodes", shape.n_nodes()),
                         fmt::format("at least {} nodes in a shape", least), "choose a smaller spacing");
}

/// A shape from elements: lumped volumes, boundary nodes as given.
template <int Dim>
Shape<Dim> shape_of_mesh(const ElementMesh<Dim>& mesh) {
    Shape<Dim> shape;
    shape.X = mesh.X;
    shape.volume = make_lumped_volumes<Dim>(mesh);
    return shape;
}

/// A mesh of a known solid: the surface is the solid's, and its boundary nodes lie on it.
template <int Dim, class Solid>
Shape<Dim> make_meshed_shape(const Solid& solid, double spacing, const std::string& at) {
    ElementMesh<Dim> mesh;
    try {
        mesh = generate_mesh(solid, spacing);
    } catch (const std::runtime_error& error) {
        throw InputError(at, error.what(), "a shape that gmsh can mesh", "try another spacing");
    }
    if (const std::optional<MeshDefect> defect = find_mesh_defect<Dim>(mesh))
        throw InputError(at, "from gmsh " + defect->got, defect->expected, "try another spacing");
    Shape<Dim> shape = shape_of_mesh<Dim>(mesh);
    std::vector<bool> on_boundary(mesh.X.size(), false);
    for (const Facet& facet : find_boundary<Dim>(mesh))
        for (int k = 0; k < facet.n_nodes; ++k) on_boundary[facet.node[k]] = true;
    for (int i = 0; i < shape.n_nodes(); ++i) {
        if (!on_boundary[i]) continue;
        const SurfaceView<Dim> view = solid.view(shape.X[i]);
        shape.surface.push_back({i, view.normal, 0.0, view.kappa});
    }
    shape.cornered = solid.cornered();
    shape.outline = solid.outline();
    const Vec<Dim> before = shape.X[0];
    move_to_centre_of_mass(shape);
    shape.radius = solid.radius_about(before - shape.X[0]);
    return shape;
}

template <int Dim>
Shape<Dim> make_shape_from_file(const ShapeDeck& deck) {
    require_positive(deck, "unit", deck.unit);
    std::filesystem::path path(deck.file);
    if (path.is_relative()) path = std::filesystem::path(deck.place.file).parent_path() / path;
    const std::string at = where(deck, "file");
    const ElementMesh<Dim> mesh = read_mesh_file<Dim>(path.string(), deck.unit, at);
    if (const std::optional<MeshDefect> defect = find_mesh_defect<Dim>(mesh))
        throw InputError(at, fmt::format("{} in '{}'", defect->got, path.string()), defect->expected,
                         defect->hint);
    Shape<Dim> shape = shape_of_mesh<Dim>(mesh);
    const MeshSurface<Dim> surface = fit_surface<Dim>(mesh);
    shape.surface = surface.points;
    shape.cornered = surface.cornered;
    shape.outline = surface.outline;
    move_to_centre_of_mass(shape);
    for (const Vec<Dim>& x : shape.outline) shape.radius = std::max(shape.radius, x.norm());
    return shape;
}

/// Lattice or mesh of a solid; spacing_of_cells: cell edges of the lattice [m].
template <int Dim, class Solid>
Shape<Dim> fill(const ShapeDeck& deck, const Solid& solid, const Vec<Dim>& spacing_of_cells) {
    require_positive(deck, "spacing", deck.spacing);
    require_affordable(deck, (solid.high() - solid.low()).prod(), Dim);
    if (deck.filling == Filling::rings)
        throw InputError(where(deck, "filling"), "rings", "lattice or mesh",
                         "rings fill disks and spheres only");
    if (deck.filling == Filling::mesh)
        return make_meshed_shape<Dim>(solid, deck.spacing, where(deck, "spacing"));
    const Shape<Dim> shape = make_lattice_shape<Dim>(solid, spacing_of_cells);
    require_enough_nodes<Dim>(deck, shape);
    if (!is_connected<Dim>(shape, 1.01 * spacing_of_cells.norm()))
        throw InputError(where(deck, "spacing"),
                         fmt::format("{} m, with which the lattice falls into pieces", deck.spacing),
                         "a spacing smaller than the thinnest part of the shape");
    return shape;
}

/// Cell edges that divide a box exactly, nearest to the wanted spacing.
template <int Dim>
Vec<Dim> dividing_spacing(const ShapeDeck& deck) {
    require_positive(deck, "spacing", deck.spacing);
    Vec<Dim> edges;
    for (int a = 0; a < Dim; ++a)
        edges[a] = deck.size[a] / std::max(1.0, std::round(deck.size[a] / deck.spacing));
    return edges;
}

template <int Dim>
Shape<Dim> make_round_shape(const ShapeDeck& deck) {
    require_positive(deck, "radius", deck.radius);
    require_positive(deck, "spacing", deck.spacing);
    const Ball<Dim> ball(deck.radius);
    if (deck.filling != Filling::rings) return fill<Dim>(deck, ball, Vec<Dim>::Constant(deck.spacing));
    require_affordable(deck, ball.measure(), Dim);
    const int n = std::max(1, static_cast<int>(std::lround(deck.radius / deck.spacing)));
    if constexpr (Dim == 2)
        return make_rings_shape(deck.radius, n);
    else
        return make_shells_shape(deck.radius, n);
}

Shape<2> make_polygon_shape(const ShapeDeck& deck, std::vector<Vec<2>> vertices, const char* field) {
    if (const std::optional<PolygonDefect> defect = find_polygon_defect(vertices))
        throw InputError(where(deck, field), defect->got, defect->expected, defect->hint);
    const Vec<2> spacing = deck.kind == ShapeKind::rectangle ? dividing_spacing<2>(deck)
                                                             : Vec<2>(Vec<2>::Constant(deck.spacing));
    return fill<2>(deck, Polygon(std::move(vertices)), spacing);
}

/// Corners counter-clockwise, the first on the positive x axis.
std::vector<Vec<2>> regular_vertices(double radius, int sides) {
    std::vector<Vec<2>> vertices;
    for (int i = 0; i < sides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / sides;
        vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return vertices;
}

[[noreturn]] void refuse_kind(const ShapeDeck& deck, const char* kind, int dim) {
    throw InputError(
        where(deck, "kind"), fmt::format("{} in {}D", kind, dim),
        dim == 2 ? "disk, ellipse, rectangle, regular_polygon, polygon or mesh" : "sphere, box or mesh");
}

Shape<2> build(const ShapeDeck& deck, std::integral_constant<int, 2>) {
    switch (deck.kind) {
        case ShapeKind::disk:
            return make_round_shape<2>(deck);
        case ShapeKind::ellipse:
            for (const double half : deck.semi_axes) require_positive(deck, "semi_axes", half);
            return fill<2>(deck, Ellipse(deck.semi_axes[0], deck.semi_axes[1]),
                           Vec<2>::Constant(deck.spacing));
        case ShapeKind::rectangle: {
            require_positive(deck, "size", deck.size[0]);
            require_positive(deck, "size", deck.size[1]);
            const double a = 0.5 * deck.size[0], b = 0.5 * deck.size[1];
            return make_polygon_shape(deck, {{-a, -b}, {a, -b}, {a, b}, {-a, b}}, "size");
        }
        case ShapeKind::regular_polygon:
            require_positive(deck, "radius", deck.radius);
            if (deck.sides < 3)
                throw InputError(where(deck, "sides"), fmt::format("{}", deck.sides), "at least 3 sides");
            return make_polygon_shape(deck, regular_vertices(deck.radius, deck.sides), "sides");
        case ShapeKind::polygon: {
            std::vector<Vec<2>> vertices;
            for (const std::array<double, 2>& v : deck.vertices) vertices.emplace_back(v[0], v[1]);
            return make_polygon_shape(deck, std::move(vertices), "vertices");
        }
        case ShapeKind::mesh:
            return make_shape_from_file<2>(deck);
        case ShapeKind::sphere:
            refuse_kind(deck, "sphere", 2);
        case ShapeKind::box:
            refuse_kind(deck, "box", 2);
    }
    refuse_kind(deck, "unknown kind", 2);
}

Shape<3> build(const ShapeDeck& deck, std::integral_constant<int, 3>) {
    switch (deck.kind) {
        case ShapeKind::sphere:
            return make_round_shape<3>(deck);
        case ShapeKind::box:
            for (const double edge : deck.size) require_positive(deck, "size", edge);
            return fill<3>(deck, Cuboid(Vec<3>(deck.size[0], deck.size[1], deck.size[2])),
                           dividing_spacing<3>(deck));
        case ShapeKind::mesh:
            return make_shape_from_file<3>(deck);
        case ShapeKind::disk:
            refuse_kind(deck, "disk", 3);
        case ShapeKind::ellipse:
            refuse_kind(deck, "ellipse", 3);
        case ShapeKind::rectangle:
            refuse_kind(deck, "rectangle", 3);
        case ShapeKind::regular_polygon:
            refuse_kind(deck, "regular_polygon", 3);
        case ShapeKind::polygon:
            refuse_kind(deck, "polygon", 3);
    }
    refuse_kind(deck, "unknown kind", 3);
}

}  // namespace

template <int Dim>
Shape<Dim> make_shape(const ShapeDeck& deck) {
    Shape<Dim> shape = build(deck, std::integral_constant<int, Dim>());
    require_enough_nodes<Dim>(deck, shape);
    shape.name = deck.name;
    return shape;
}

template Shape<2> make_shape(const ShapeDeck&);
template Shape<3> make_shape(const ShapeDeck&);

}  // namespace quern
