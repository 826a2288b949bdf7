// Keys of a packing: name, unit, range, description; reader and reference follow from here.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>

#include "src/deck/deck_input.hpp"
#include "src/deck/names.hpp"
#include "src/pack/outline.hpp"
#include "src/pack/pack_spec.hpp"

namespace quern {
namespace {

const std::vector<std::string> size_types = {"list", "file", "uniform", "lognormal", "power_law", "weibull"};
const std::vector<std::string> with_limits = {"uniform", "lognormal", "power_law", "weibull"};
const std::vector<std::string> region_types = {"box", "circle"};

/// A column of numbers > 0; lines that begin with # are comments.
std::vector<double> read_column(const SizeSpec& sizes, const std::string& path, const Cursor& at) {
    std::ifstream stream(path);
    if (!stream) throw InputError(at.where("file"), "'" + sizes.file + "'", "an existing file");
    std::vector<double> values;
    std::size_t column = 0;
    int line_number = 0;
    bool header = true;
    for (std::string line; std::getline(stream, line);) {
        ++line_number;
        const std::string_view row = trim(line);
        if (row.empty() || row.front() == '#') continue;
        const std::vector<std::string_view> cells = split_cells(row);
        if (header) {
            const std::vector<std::string> names(cells.begin(), cells.end());
            const auto found = std::find(names.begin(), names.end(), sizes.column);
            if (found == names.end())
                throw InputError(at.where("column"), fmt::format("'{}', which {} lacks", sizes.column, path),
                                 "one of " + join(names), did_you_mean(sizes.column, names));
            column = static_cast<std::size_t>(found - names.begin());
            header = false;
            continue;
        }
        const std::string where = Place{path, line_number, sizes.column}.text();
        const std::optional<NumberAndRest> number =
            column < cells.size() ? split_number(cells[column]) : std::nullopt;
        if (!number || !number->rest.empty() || number->number <= 0.0)
            throw InputError(
                where, column < cells.size() ? fmt::format("'{}'", cells[column]) : std::string("nothing"),
                "a number > 0");
        values.push_back(number->number * sizes.unit);
    }
    if (values.empty()) throw InputError(path, "no sizes", "a header and one row a size");
    return values;
}

void finish_sizes(SizeSpec& sizes, const Cursor& at, const Context& now) {
    sizes.place = at.place();
    if (sizes.kind == SizeKind::list) return;
    if (sizes.kind == SizeKind::file) {
        sizes.values = read_column(sizes, (now.folder / sizes.file).string(), at);
        return;
    }
    if (!(sizes.min < sizes.max))
        throw InputError(at.where("max"), fmt::format("{} m", sizes.max),
                         fmt::format("more than min, {} m", sizes.min));
    if (sizes.kind == SizeKind::power_law && sizes.mean.has_value() == sizes.exponent.has_value())
        throw InputError(at.where(), sizes.mean ? "mean and exponent" : "neither mean nor exponent",
                         "exactly one of mean, exponent");
    if (sizes.mean && !(sizes.min < *sizes.mean && *sizes.mean < sizes.max))
        throw InputError(at.where("mean"), fmt::format("{} m", *sizes.mean),
                         fmt::format("a mean between min and max, {} and {} m", sizes.min, sizes.max));
}

Table<SizeSpec> size_table() {
    using T = SizeSpec;
    Table<T> t;
    t.type_of = [](const T& s) { return size_types[static_cast<std::size_t>(s.kind)]; };
    t.word("type", &T::kind, size_types,
           "Sizes (diameters of the disks of equal area): given, or a distribution of the number of grains")
        .require();
    const Key values{.name = "values",
                     .form = Form::numbers,
                     .unit = "m",
                     .range = positive,
                     .about = "Sizes, each as often as the others"};
    t.add(
         values,
         [values](T& sizes, const Cursor& at, const Context& now) {
             if (at.node().kind != Node::Kind::list || at.node().items.empty())
                 throw InputError(at.where(), at.node().description(), values.expectation(2));
             Key value = values;
             value.form = Form::number;
             for (std::size_t i = 0; i < at.node().items.size(); ++i)
                 sizes.values.push_back(read_number(at.entry(i), now, value));
         },
         [](const T&, int) { return std::string(); })
        .require()
        .only_for({"list"});
    t.text("file", &T::file, "CSV of sizes, relative to this file").require().only_for({"file"});
    t.text("column", &T::column, "Its column").only_for({"file"});
    t.number("unit", &T::unit, "m", positive, "Length of one unit of the column").only_for({"file"});
    t.number("min", &T::min, "m", positive, "Least size").require().only_for(with_limits);
    t.number("max", &T::max, "m", positive, "Largest size").require().only_for(with_limits);
    t.number("mean", &T::mean, "m", positive, "Mean size within the limits; power_law: or give exponent")
        .only_for({"lognormal", "power_law", "weibull"});
    t.number("exponent", &T::exponent, "", {-50.0, 50.0, false, false, false},
             "Number of grains per size ~ size^-exponent")
        .only_for({"power_law"});
    t.number("deviation", &T::deviation, "", positive, "Standard deviation of ln size, without limits")
        .require()
        .only_for({"lognormal"});
    t.number("modulus", &T::modulus, "", {0.0, 100.0, true, false, false},
             "k of the number of larger grains, exp(-(size/scale)^k)")
        .require()
        .only_for({"weibull"});
    t.finish = [](T& sizes, const Cursor& at, const Context& now) {
        const bool needs_mean = sizes.kind == SizeKind::lognormal || sizes.kind == SizeKind::weibull;
        if (needs_mean && !sizes.mean)
            throw InputError(at.where(), "no mean", "a number > 0 in m",
                             "required: mean size within the limits");
        finish_sizes(sizes, at, now);
    };
    return t;
}

Table<RegionSpec> region_table() {
    using T = RegionSpec;
    Table<T> t;
    t.type_of = [](const T& region) { return region_types[region.circle ? 1 : 0]; };
    const Key type{.name = "type", .form = Form::word, .words = region_types, .about = "Form of the region"};
    t.add(
         type,
         [type](T& r, const Cursor& at, const Context& now) { r.circle = read_word(at, now, type) == 1; },
         [](const T& r, int) { return region_types[r.circle ? 1 : 0]; })
        .require();
    t.vector("origin", &T::origin, "m", any_number, "Lower corner").only_for({"box"});
    t.vector("extent", &T::extent, "m", positive, "Edge lengths").require().only_for({"box"});
    for (const std::size_t axis : {0, 1}) {
        const Key rule{.name = axis == 0 ? "x" : "y",
                       .form = Form::word,
                       .words = {"closed", "open", "periodic"},
                       .about =
                           "Both edges across this axis: grains stay inside; their centres do; the two "
                           "edges are one"};
        t.add(
             rule,
             [=](T& r, const Cursor& at, const Context& now) {
                 r.rule[axis] = static_cast<EdgeRule>(read_word(at, now, rule));
             },
             [=](const T& r, int) { return rule.words[static_cast<std::size_t>(r.rule[axis])]; })
            .only_for({"box"});
    }
    t.vector("centre", &T::middle, "m", any_number, "Centre").only_for({"circle"});
    t.number("radius", static_cast<double T::*>(&T::radius), "m", positive, "Radius; grains stay inside")
        .require()
        .only_for({"circle"});
    t.finish = [](T& r, const Cursor& at, const Context&) {
        r.place = at.place();
        for (std::size_t axis = 0; axis < 2; ++axis) {
            r.centre[axis] = r.middle[axis];
            r.low[axis] = r.circle ? r.middle[axis] - r.radius : r.origin[axis];
            r.high[axis] = r.circle ? r.middle[axis] + r.radius : r.origin[axis] + r.extent[axis];
        }
    };
    return t;
}

/// The deck's own keys of a shape, but those of particles.
Table<PackShape> pack_shape_table() {
    Table<PackShape> t;
    t.type_of = [](const PackShape& shape) { return shape_types()[static_cast<std::size_t>(shape.kind)]; };
    for (const KeyField<ShapeDeck>& field : shape_table().fields) {
        const std::string& name = field.key.name;
        if (name == "filling" || name == "spacing" || name == "scaling" || name == "file" || name == "unit")
            continue;
        t.add(
            field.key,
            [field](PackShape& shape, const Cursor& at, const Context& now) { field.read(shape, at, now); },
            [field](const PackShape& shape, int dimension) { return field.write(shape, dimension); });
    }
    t.number("share", &PackShape::share, "", positive, "Part of all grains, over the sum of all shares");
    t.finish = [](PackShape& shape, const Cursor& at, const Context& now) {
        if (shape.kind == ShapeKind::mesh)
            throw InputError(at.where("type"), "mesh", "a disk, an ellipse or a convex polygon");
        finish_shape(shape, at, now);
        make_outline(shape);
    };
    return t;
}

Table<EdgeGroups> edge_table() {
    using T = EdgeGroups;
    Table<T> t;
    const auto edge = [&t](const char* name, std::string T::*member, const char* about) {
        const Key key{.name = name, .form = Form::text, .about = about};
        t.add(
            key,
            [=](T& edges, const Cursor& at, const Context& now) {
                const std::string group = read_text(at, now, key);
                check_group_name(group, at.where());
                edges.*member = group;
            },
            [](const T&, int) { return std::string(); });
    };
    edge("x-", &T::x_low, "Group of the grains that overlap the left edge; closed: touch it");
    edge("x+", &T::x_high, "The right edge");
    edge("y-", &T::y_low, "The lower edge");
    edge("y+", &T::y_high, "The upper edge; a grain at two edges belongs to the first of them in this order");
    edge("rim", &T::rim, "The edge of a circle");
    return t;
}

const Table<PackSpec>& pack_table() {
    static const Table<PackSpec> table = [] {
        using T = PackSpec;
        Table<T> t;
        t.text("title", &T::title, "In the summary (.json)");
        t.add(
            {.name = "params",
             .form = Form::named,
             .about = "Numbers, quantities, texts and formulas for use as `${name}` below"},
            [](T&, const Cursor&, const Context&) {}, [](const T&, int) { return std::string(); });
        t.integer("seed", &T::seed, not_negative, "Of the random numbers");
        t.section("region", &T::region, region_table(), "Where grains are packed").require();
        t.number(
            "solid_fraction", &T::solid_fraction, "", {0.0, 1.0, true, true, false},
            "Area of the grains within the region over that of the region; left out: what `count` grains "
            "make");
        t.integer("count", &T::count, {0.0, 1e6, false, false, false},
                  "Number of grains; 0: as many as fill. With solid_fraction all sizes are multiplied by one "
                  "factor within 10 % of 1");
        t.section("sizes", &T::sizes, size_table(), "Sizes of the grains").require();
        t.named("shapes", &T::shapes, pack_shape_table(),
                "Shapes as in a deck, in any size; left out: disks, and no column shape");
        t.section("edges", &T::edges, edge_table(), "Groups of grains at edges");
        t.integer("rounds", &T::rounds, {1.0, 1e6, false, false, false},
                  "Rounds of exchanges of places until the solid fraction counts as out of reach");
        return t;
    }();
    return table;
}

void check_edges(const PackSpec& spec, const Cursor& at) {
    const EdgeGroups& e = spec.edges;
    const auto refuse = [&](const char* name, const char* got, const char* expected) {
        throw InputError(at.where(fmt::format("edges.{}", name)), got, expected);
    };
    const std::pair<const char*, const std::string*> sides[] = {
        {"x-", &e.x_low}, {"x+", &e.x_high}, {"y-", &e.y_low}, {"y+", &e.y_high}};
    for (int k = 0; k < 4; ++k) {
        if (sides[k].second->empty()) continue;
        if (spec.region.circle) refuse(sides[k].first, "an edge of a box", "rim, the edge of a circle");
        if (spec.region.periodic(k / 2))
            refuse(sides[k].first, "an edge that is periodic", "an edge with an end");
    }
    if (!e.rim.empty() && !spec.region.circle) refuse("rim", "rim", "one of x-, x+, y-, y+ for a box");
}

}  // namespace

PackSpec read_pack_spec(const std::string& path, const std::vector<std::string>& overrides) {
    Node root = read_tree(path);
    for (const std::string& text : overrides) apply_override(root, text);
    const Cursor at(root, path);
    const Node* params = root.find("params");
    const Parameters parameters = params ? Parameters(Cursor(at, *params, "params")) : Parameters();
    const Context context{parameters, 2, std::filesystem::path(path).parent_path()};
    PackSpec spec = read_section(at, context, pack_table());
    spec.file = path;
    if (!spec.solid_fraction && spec.count == 0)
        throw InputError(at.where(), "neither count nor solid_fraction", "at least one of them");
    check_edges(spec, at);
    return spec;
}

std::string pack_reference() {
    return reference_text(keys_of(pack_table()));
}

std::string pack_schema() {
    return schema_text(keys_of(pack_table()), "Quern packing");
}

}  // namespace quern
