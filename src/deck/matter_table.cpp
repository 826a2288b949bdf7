// Keys of materials, shapes and grains: name, unit, range, description.
#include "src/deck/deck_input.hpp"

namespace quern {
namespace {

Table<ArrayInput> array_table() {
    using T = ArrayInput;
    Table<T> t;
    const Key counts{
        .name = "counts", .form = Form::counts, .range = at_least(1), .about = "Grains along each axis"};
    t.add(
         counts,
         [counts](T& array, const Cursor& at, const Context& now) {
             check_size(at, static_cast<std::size_t>(now.dimension), counts, now.dimension);
             Key count = counts;
             count.form = Form::integer;
             for (std::size_t i = 0; i < at.node().items.size(); ++i) {
                 array.counts[i] = read_integer(at.entry(i), now, count);
             }
         },
         [](const T& array, int dimension) {
             return ids_text({array.counts.begin(), array.counts.begin() + dimension});
         })
        .require();
    t.vector("origin", &T::origin, "m", any_number, "Centre of the first grain").require();
    t.vector("step", &T::step, "m", any_number, "Distance between neighbours along each axis").require();
    t.number("jitter", &T::jitter, "", {0.0, 0.5, false, false, false},
             "Largest random displacement as a fraction of the step");
    const Key scale{
        .name = "scale", .form = Form::pair, .range = positive, .about = "Random scale: [least, largest]"};
    t.add(
        scale,
        [scale](T& array, const Cursor& at, const Context& now) {
            check_size(at, 2, scale, now.dimension);
            Key bound = scale;
            bound.form = Form::number;
            array.scale = {read_number(at.entry(0), now, bound), read_number(at.entry(1), now, bound)};
            if (array.scale[0] <= array.scale[1]) return;
            throw InputError(at.where(), fmt::format("[{}, {}]", array.scale[0], array.scale[1]),
                             "the least first");
        },
        [](const T& array, int) {
            return vector_text({array.scale[0], array.scale[1], 0.0}, 2);
        });
    t.integer("seed", &T::seed, not_negative, "Of the random numbers");
    return t;
}

void finish_grain(GrainInput& grain, const Cursor& at, const Context& now) {
    grain.place = at.place();
    grain.has_position = at.has("position");
    if (at.has("group")) check_group_name(grain.group, at.where("group"));
    const int n_ways = static_cast<int>(grain.has_position) + (grain.file ? 1 : 0) + (grain.array ? 1 : 0);
    if (n_ways != 1) {
        throw InputError(at.where(), n_ways == 0 ? "none of position, file, array" : "more than one of them",
                         "exactly one of position, file, array");
    }
    if (grain.array && at.has("scale")) {
        throw InputError(at.where("scale"), "scale beside array", "array.scale: [least, largest]");
    }
    if (grain.file) grain.file = (now.folder / *grain.file).lexically_normal().string();
    for (const char* name : {"shape", "material"}) {
        if (grain.file || at.has(name)) continue;
        throw InputError(at.where(), fmt::format("no {}", name), fmt::format("the name of a {}", name));
    }
}

Table<StrengthScatter> strength_table() {
    using T = StrengthScatter;
    Table<T> t;
    t.number("weibull_modulus", &T::weibull_modulus, "", {1.0, no_limit, false, false, false},
             "Of the critical stretch, whose mean is that of the material")
        .require();
    t.integer("seed", &T::seed, not_negative, "Of the random numbers, one a grain");
    return t;
}

const std::vector<std::string> bond_models = {"lps", "bond_based", "peridem"};
const std::vector<std::string> plastic_models = {"correspondence", "material_points"};

/// A number of which another key is the alternative: written where it is the one in use.
KeyField<MaterialInput>& add_alternative(Table<MaterialInput>& t, const char* name, double Material::*member,
                                         const char* unit, const Range& range, const char* about,
                                         const std::function<bool(const MaterialInput&)>& in_use) {
    const Key key{.name = name, .unit = unit, .range = range, .about = about};
    return t.add(
        key,
        [=](MaterialInput& m, const Cursor& at, const Context& now) {
            m.*member = read_number(at, now, key);
        },
        [=](const MaterialInput& m, int) { return in_use(m) ? number_text(m.*member) : std::string(); });
}

}  // namespace

Table<MaterialInput> material_table() {
    using T = MaterialInput;
    Table<T> t;
    t.type_of = [](const T& m) { return material_models[static_cast<std::size_t>(m.model)]; };
    const Key model{.name = "model",
                    .form = Form::word,
                    .words = material_models,
                    .about =
                        "Internal force: linear peridynamic solid, bond-based, lps with the options "
                        "of PeriDEM for defaults, stabilised correspondence, or material points"};
    t.add(
        model,
        [model](T& m, const Cursor& at, const Context& now) {
            m.model = static_cast<ForceModel>(read_word(at, now, model));
            if (m.model == ForceModel::peridem) set_peridem_options(m);
        },
        [](const T& m, int) { return material_models[static_cast<std::size_t>(m.model)]; });
    t.word("plane", &T::plane, {"strain", "stress"}, "Plane strain or plane stress").in_dimension(2);
    t.number("density", &T::density, "kg/m^3", positive, "Mass per volume").require();
    t.number("bulk_modulus", &T::bulk, "Pa", positive, "K; exactly two of the four moduli");
    t.number("shear_modulus", &T::shear, "Pa", positive, "G");
    t.number("young_modulus", &T::young, "Pa", positive, "E");
    t.number("poisson_ratio", &T::poisson, "", {-1.0, 0.5, true, true, false}, "nu");
    t.word("constants", &T::constants, {"plane", "three_dimensional"},
           "Constants of lps in the plane; default of peridem: three_dimensional")
        .in_dimension(2)
        .only_for({"lps", "peridem"});
    const auto by_length = [](const T& m) { return m.horizon > 0.0; };
    const auto by_energy = [](const T& m) { return m.fracture_energy > 0.0; };
    add_alternative(t, "horizon_ratio", &T::horizon_ratio, "", at_least(1.5),
                    "Horizon over particle spacing; or give horizon", std::not_fn(by_length));
    add_alternative(t, "horizon", &T::horizon, "m", positive,
                    "Horizon of a grain of scale 1; it scales with the grain", by_length);
    t.word("horizon_rim", &T::horizon_rim, {"included", "excluded"},
           "Bonds exactly as long as the horizon; default of peridem: excluded");
    t.word("influence", &T::influence, {"constant", "inverse", "conical", "gaussian"},
           "Weight of a bond: 1, 1/r, 1 - r or exp(-(2 r)^2), r = length / horizon");
    t.word("calibration", &T::calibration, {"none", "discrete"},
           "Constants of the continuum, or of the sums over the actual neighbours")
        .only_for(bond_models);
    t.word(
        "volume_correction", &T::volume_correction, {"none", "linear"},
        "Volumes at the rim of a family: whole, or the share within the horizon; default of peridem: linear");
    t.word("surface_correction", &T::surface_correction, {"none", "volume"},
           "Stiffen bonds near the surface by 2 V0 / (V_i + V_j)")
        .only_for(bond_models);
    t.number("yield_stress", &T::yield_stress, "Pa", or_infinite,
             "Von Mises yield stress in tension, .inf: elastic")
        .only_for(plastic_models);
    t.number("hardening_modulus", &T::hardening_modulus, "Pa", not_negative,
             "Growth of yield_stress with the equivalent plastic strain")
        .only_for(plastic_models);
    t.number("stabilization", &T::stabilization, "", positive,
             "Stiffness, in shear moduli, against what is not uniform in a family")
        .only_for({"correspondence"});
    t.number("bond_damping", &T::bond_damping, "s", not_negative, "Kelvin-Voigt time of the bonds")
        .only_for(bond_models);
    add_alternative(t, "critical_stretch", &T::critical_stretch, "", or_infinite,
                    "Bonds break above it, .inf: never; or give fracture_energy", std::not_fn(by_energy))
        .only_for(bond_models);
    add_alternative(t, "fracture_energy", &T::fracture_energy, "J/m^2", positive,
                    "Gc, from which the critical stretch of every grain follows", by_energy)
        .only_for(bond_models);
    const Key formula{.name = "critical_stretch_formula",
                      .form = Form::word,
                      .words = {"energy_balance", "peridem"},
                      .about =
                          "With fracture_energy; default: energy_balance of the bonds across a plane; "
                          "default of peridem: its formula"};
    t.add(
         formula,
         [formula](T& m, const Cursor& at, const Context& now) {
             m.critical_stretch_formula = static_cast<StretchFormula>(read_word(at, now, formula));
         },
         [=](const T& m, int) {
             return by_energy(m) ? formula.words[static_cast<std::size_t>(m.critical_stretch_formula)]
                                 : std::string();
         })
        .only_for(bond_models);
    t.word("breaks_in", &T::breaks_in, {"tension", "both"},
           "Bonds break when stretched, or when compressed as well; default of peridem: both")
        .only_for(bond_models);
    t.word("breaks_by", &T::breaks_by, {"stretch", "energy"},
           "Bonds break at the critical stretch, or where the work done on them is their share of "
           "fracture_energy")
        .only_for(bond_models);
    t.section("strength", static_cast<std::optional<StrengthScatter> T::*>(&T::strength), strength_table(),
              "Critical stretch that differs from grain to grain")
        .only_for(bond_models);
    t.finish = finish_material;
    return t;
}

Table<ShapeDeck> shape_table() {
    using T = ShapeDeck;
    Table<T> t;
    t.type_of = [](const T& shape) { return shape_types()[static_cast<std::size_t>(shape.kind)]; };
    t.word("type", &T::kind, shape_types(),
           "disk, ellipse, rectangle, regular_polygon and polygon in 2D; sphere and box in 3D; mesh in both")
        .require();
    t.word("filling", &T::filling, {"lattice", "rings", "mesh"},
           "Square lattice, concentric rings or shells (disk, sphere), or a mesh by gmsh")
        .only_for({"disk", "rectangle", "regular_polygon", "polygon", "sphere", "box", "ellipse"});
    t.number("radius", &T::radius, "m", positive, "Radius; of the corners for a regular polygon")
        .require()
        .only_for({"disk", "regular_polygon", "sphere"});
    t.integer("sides", &T::sides, {3, 1000, false, false, false}, "Number of sides")
        .require()
        .only_for({"regular_polygon"});
    t.vector("size", &T::size, "m", positive, "Edge lengths").require().only_for({"rectangle", "box"});
    const Key axes{.name = "semi_axes",
                   .form = Form::pair,
                   .unit = "m",
                   .range = positive,
                   .about = "Half the lengths along x and y"};
    t.add(
         axes,
         [axes](T& shape, const Cursor& at, const Context& now) {
             check_size(at, 2, axes, now.dimension);
             Key half = axes;
             half.form = Form::number;
             for (std::size_t i = 0; i < 2; ++i) shape.semi_axes[i] = read_number(at.entry(i), now, half);
         },
         [](const T& shape, int) {
             return shape.semi_axes[0] > 0.0 ? vector_text({shape.semi_axes[0], shape.semi_axes[1], 0.0}, 2)
                                             : std::string();
         })
        .require()
        .only_for({"ellipse"});
    const Key points{.name = "vertices", .form = Form::points, .unit = "m", .about = "Corners in order"};
    t.add(
         points,
         [points](T& shape, const Cursor& at, const Context& now) {
             if (at.node().kind != Node::Kind::list || at.node().items.size() < 3) {
                 const std::size_t n = at.node().items.size();
                 const bool list = at.node().kind == Node::Kind::list;
                 throw InputError(at.where(), list ? fmt::format("{} points", n) : at.node().description(),
                                  points.expectation(2));
             }
             Key point = points;
             point.form = Form::pair;
             for (std::size_t i = 0; i < at.node().items.size(); ++i) {
                 const Cursor entry = at.entry(i);
                 check_size(entry, 2, point, 2);
                 Key coordinate = point;
                 coordinate.form = Form::number;
                 shape.vertices.push_back({read_number(entry.entry(0), now, coordinate),
                                           read_number(entry.entry(1), now, coordinate)});
             }
         },
         [](const T& shape, int) {
             std::string text;
             for (const auto& [x, y] : shape.vertices) {
                 text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", number_text(x), number_text(y));
             }
             return text.empty() ? text : fmt::format("[{}]", text);
         })
        .require()
        .only_for({"polygon"});
    t.text("file", &T::file, "Gmsh file (.msh), relative to the deck").require().only_for({"mesh"});
    t.number("unit", &T::unit, "m", positive, "Length of one unit of the file").only_for({"mesh"});
    t.number("spacing", &T::spacing, "m", positive, "Wanted distance between particles")
        .require()
        .only_for({"disk", "rectangle", "regular_polygon", "polygon", "sphere", "box", "ellipse"});
    t.word("scaling", &T::scaling, {"stretch", "refill"},
           "Grains of another scale: its particles further apart, or as many as it takes at this spacing")
        .only_for({"disk", "rectangle", "regular_polygon", "polygon", "sphere", "box", "ellipse"});
    t.finish = finish_shape;
    return t;
}

Table<GrainInput> grain_table() {
    using T = GrainInput;
    Table<T> t;
    t.text("shape", &T::shape, "Name of a shape; may come from the file's column");
    t.text("material", &T::material, "Name of a material; may come from the file's column");
    t.text("group", &T::group, "Name by which loads, constraints and output choose it; column: may be empty");
    t.number("scale", &T::scale, "", positive, "Size relative to the shape");
    t.vector("position", &T::position, "m", any_number, "Centre of mass; or give file or array");
    t.turn("angle", &T::angle, "rad", "Rotation about z; rotation vector in 3D");
    t.vector("velocity", &T::velocity, "m/s", any_number, "Initial velocity");
    t.turn("spin", &T::spin, "rad/s", "Initial angular velocity");
    t.flag("wall", &T::wall, "It stands for a wall: node pairs see no contact between two of them");
    const Key file{
        .name = "file", .form = Form::text, .about = "CSV with a grain a row, relative to the deck"};
    t.add(
        file,
        [file](T& grain, const Cursor& at, const Context& now) { grain.file = read_text(at, now, file); },
        [](const T& grain, int) { return grain.file ? quoted(*grain.file) : std::string(); });
    t.section("array", &T::array, array_table(), "Grains in rows and columns");
    t.finish = finish_grain;
    return t;
}

const std::vector<std::string>& shape_types() {
    static const std::vector<std::string> types = {
        "disk", "rectangle", "regular_polygon", "polygon", "sphere", "box", "mesh", "ellipse"};
    return types;
}

}  // namespace quern
