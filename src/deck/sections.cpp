// Checks of single sections: elastic moduli, shapes, the box.
#include <algorithm>
#include <numeric>

#include "src/deck/deck_input.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

/// K and G from any two of K, G, E, nu: E = 9KG/(3K + G), nu = (3K - 2G)/(6K + 2G).
void complete_moduli(MaterialInput& m, const Cursor& at) {
    std::vector<std::string> given;
    if (m.bulk) given.push_back("bulk_modulus");
    if (m.shear) given.push_back("shear_modulus");
    if (m.young) given.push_back("young_modulus");
    if (m.poisson) given.push_back("poisson_ratio");
    if (given.size() != 2) {
        throw InputError(at.where(), given.empty() ? "none of the moduli" : join(given),
                         "exactly two of bulk_modulus, shear_modulus, young_modulus, poisson_ratio");
    }
    const double nu = m.poisson.value_or(0.0);
    if (!m.bulk && m.shear && m.young) m.bulk = *m.young * *m.shear / (3.0 * (3.0 * *m.shear - *m.young));
    if (!m.bulk && m.shear) m.bulk = *m.shear * 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu));
    if (!m.bulk) m.bulk = *m.young / (3.0 * (1.0 - 2.0 * nu));
    if (!m.shear && m.young && m.poisson) m.shear = *m.young / (2.0 * (1.0 + nu));
    if (!m.shear && m.young) m.shear = 3.0 * *m.bulk * *m.young / (9.0 * *m.bulk - *m.young);
    if (!m.shear) m.shear = 3.0 * *m.bulk * (1.0 - 2.0 * nu) / (2.0 * (1.0 + nu));
    m.bulk_modulus = *m.bulk;
    m.shear_modulus = *m.shear;
    const bool sound = std::isfinite(*m.bulk) && *m.bulk > 0.0 && std::isfinite(*m.shear) && *m.shear > 0.0;
    if (!sound) {
        throw InputError(at.where(given.back()),
                         fmt::format("K = {:.6g} Pa, G = {:.6g} Pa", *m.bulk, *m.shear),
                         "moduli with K > 0 and G > 0", "from " + join(given, " and "));
    }
}

void check_bond_based(const MaterialInput& m, const Cursor& at, const Context& now) {
    const double K = m.bulk_modulus, G = m.shear_modulus;
    const double nu = (3.0 * K - 2.0 * G) / (6.0 * K + 2.0 * G);
    const bool stress = now.dimension == 2 && m.plane == PlaneState::stress;
    const double needed = stress ? 1.0 / 3.0 : 0.25;
    if (std::abs(nu - needed) <= 1e-3 * needed) return;
    const char* state = now.dimension == 3 ? "in 3D" : stress ? "in plane stress" : "in plane strain";
    throw InputError(at.where("model"), fmt::format("bond_based with nu = {:.6g}", nu),
                     fmt::format("nu = {} {}", stress ? "1/3" : "1/4", state), "model: lps takes any nu");
}

void check_continuum(const MaterialInput& m, const Cursor& at, const Context& now) {
    if (now.dimension == 2 && m.plane == PlaneState::stress) {
        throw InputError(
            at.where("plane"),
            fmt::format("stress with model: {}", material_models[static_cast<std::size_t>(m.model)]),
            "plane: strain", "the thickness of a plastic grain is not solved for");
    }
    if (m.hardening_modulus > 0.0 && !std::isfinite(m.yield_stress)) {
        throw InputError(at.where("hardening_modulus"), "hardening_modulus of a material that never yields",
                         "yield_stress beside it");
    }
}

/// Two keys of which at most one may be given.
void check_alternative(const Cursor& at, const std::string& first, const std::string& second) {
    if (!at.has(first) || !at.has(second)) return;
    throw InputError(at.where(second), fmt::format("{} beside {}", second, first),
                     fmt::format("only one of {} and {}", first, second));
}

}  // namespace

void finish_material(MaterialInput& material, const Cursor& at, const Context& now) {
    complete_moduli(material, at);
    if (material.model == ForceModel::bond_based) check_bond_based(material, at, now);
    if (material.model == ForceModel::correspondence || material.model == ForceModel::material_points)
        check_continuum(material, at, now);
    check_alternative(at, "horizon_ratio", "horizon");
    check_alternative(at, "critical_stretch", "fracture_energy");
    if (at.has("critical_stretch_formula") && !at.has("fracture_energy")) {
        throw InputError(at.where("critical_stretch_formula"),
                         "critical_stretch_formula without fracture_energy", "fracture_energy beside it");
    }
    if (material.breaks_by == BreaksBy::energy) {
        const bool peridem = material.critical_stretch_formula == StretchFormula::peridem;
        if (!at.has("fracture_energy") || peridem)
            throw InputError(
                at.where("breaks_by"),
                peridem ? "energy with critical_stretch_formula: peridem" : "energy without fracture_energy",
                peridem ? "critical_stretch_formula: energy_balance beside it" : "fracture_energy beside it");
    }
    if (material.strength && !material.can_break()) {
        throw InputError(at.where("strength"), "strength of a material that never breaks",
                         "critical_stretch or fracture_energy beside it");
    }
}

void finish_shape(ShapeDeck& shape, const Cursor& at, const Context& now) {
    shape.place = at.place();
    const bool solid = shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::box;
    const bool both = shape.kind == ShapeKind::mesh;
    if (!both && solid != (now.dimension == 3)) {
        throw InputError(at.where("type"), shape_types()[static_cast<std::size_t>(shape.kind)],
                         now.dimension == 2
                             ? "one of disk, ellipse, rectangle, regular_polygon, polygon, mesh"
                             : "one of sphere, box, mesh",
                         fmt::format("the deck is {}D", now.dimension));
    }
    const bool round = shape.kind == ShapeKind::disk || shape.kind == ShapeKind::sphere;
    if (shape.filling == Filling::rings && !round) {
        throw InputError(at.where("filling"), "rings", "lattice or mesh", "rings fill disks and spheres");
    }
    if (shape.kind == ShapeKind::mesh) {
        const std::filesystem::path path =
            std::filesystem::absolute(now.folder / shape.file).lexically_normal();
        if (!std::filesystem::is_regular_file(path)) {
            throw InputError(at.where("file"), "'" + shape.file + "'", "an existing file",
                             "looked for " + path.string());
        }
        shape.file = path.string();
        return;
    }
    const double sizes[] = {shape.size[0], shape.size[1], now.dimension == 3 ? shape.size[2] : shape.size[1]};
    double width =
        shape.radius > 0.0 ? 2.0 * shape.radius : *std::min_element(std::begin(sizes), std::end(sizes));
    if (shape.kind == ShapeKind::ellipse) width = 2.0 * std::min(shape.semi_axes[0], shape.semi_axes[1]);
    if (shape.kind == ShapeKind::polygon) {
        double area = 0.0;
        for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
            const auto& [x0, y0] = shape.vertices[i];
            const auto& [x1, y1] = shape.vertices[(i + 1) % shape.vertices.size()];
            area += 0.5 * (x0 * y1 - x1 * y0);
        }
        if (area == 0.0) throw InputError(at.where("vertices"), "a polygon of area 0", "corners in order");
        if (area < 0.0) std::reverse(shape.vertices.begin(), shape.vertices.end());
        width = std::sqrt(std::abs(area));
    }
    if (shape.spacing > width) {
        throw InputError(at.where("spacing"), fmt::format("{} m", shape.spacing),
                         fmt::format("less than the width of the shape, {:.6g} m", width));
    }
}

void finish_grid(GridDeck& grid, const Cursor& at, const Context& now) {
    grid.place = at.place();
    const char axes[] = {'x', 'y', 'z'};
    for (std::size_t i = 0; i < static_cast<std::size_t>(now.dimension); ++i) {
        const double cells = grid.extent[i] / grid.spacing, nearest = std::round(cells);
        const bool whole = nearest >= 1.0 && std::abs(cells - nearest) < 1e-9 * nearest;
        if (cells > 1e7) {
            throw InputError(at.where("spacing"), fmt::format("{:.3g} cells along {}", cells, axes[i]),
                             "at most 1e7 cells along an axis");
        }
        if (grid.periodic[i] && !whole) {
            throw InputError(at.where("extent"), fmt::format("{:.6g} cells along {}", cells, axes[i]),
                             "a whole number of cells along a periodic axis",
                             fmt::format("spacing {:.6g} m would do", grid.extent[i] / std::ceil(cells)));
        }
        grid.extent[i] = (whole ? nearest : std::ceil(cells)) * grid.spacing;
    }
}

}  // namespace quern
