// Keys of the deck: name, unit, range, description. Reader, writer, schema and reference follow from here.
// Materials, shapes and grains: matter_table.cpp.
#include "src/deck/deck_input.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

constexpr Range fraction{0.0, 1.0, true, false, false};  // (0, 1]
const std::vector<std::string> in_time = {"t"}, in_place = {"x", "y", "z"}, in_all = {"x", "y", "z", "t"};

Table<TimeDeck> time_table() {
    using T = TimeDeck;
    Table<T> t;
    t.number("end", &T::end, "s", positive, "Simulated time").require();
    t.number_or("step", &T::step, "auto", "s", positive, "Time step; auto: safety times the stable step");
    t.number("safety", &T::safety, "", fraction, "Automatic step as a fraction of 2 / highest frequency");
    t.finish = [](T& time, const Cursor& at, const Context&) { time.place = at.place(); };
    return t;
}

Table<ComputeDeck> compute_table() {
    using T = ComputeDeck;
    Table<T> t;
    t.word("kernel", &T::kernel, {"auto", "single", "reference"},
           "Bond forces: auto: batches of eight grains of a shape, or of similar lattices; single: one by "
           "one; reference: as printed");
    t.word("instructions", &T::instructions, {"auto", "avx512", "avx2", "plain"},
           "Instruction set of the batches; auto: the widest that this machine has");
    t.finish = [](T& compute, const Cursor& at, const Context&) {
        compute.place = at.place();
        if (!has_instructions(compute.instructions))
            throw InputError(at.where(), "an instruction set that this machine lacks",
                             "auto, or one that it has");
    };
    return t;
}

Table<GridDeck> grid_table() {
    using T = GridDeck;
    Table<T> t;
    t.vector("origin", &T::origin, "m", any_number, "Lower corner of the box");
    t.vector("extent", &T::extent, "m", positive, "Edge lengths of the box; rounded up to whole cells")
        .require();
    t.number("spacing", &T::spacing, "m", positive, "Cell size").require();
    const Key axes{
        .name = "periodic", .form = Form::axes, .words = {"x", "y", "z"}, .about = "Axes that repeat"};
    t.add(
        axes,
        [axes](T& grid, const Cursor& at, const Context& now) {
            check_list(at);
            Key axis = axes;
            axis.form = Form::word;
            axis.words.resize(static_cast<std::size_t>(now.dimension));
            for (std::size_t i = 0; i < at.node().items.size(); ++i) {
                grid.periodic[read_word(at.entry(i), now, axis)] = true;
            }
        },
        [axes](const T& grid, int dimension) {
            std::vector<std::string> names;
            for (std::size_t i = 0; i < static_cast<std::size_t>(dimension); ++i) {
                if (grid.periodic[i]) names.push_back(axes.words[i]);
            }
            return fmt::format("[{}]", join(names));
        });
    t.finish = finish_grid;
    return t;
}

/// The key of a quantity of a wall: in the plane, per metre of thickness.
Key in_plane(Key key, const Context& now) {
    if (now.dimension == 3) return key;
    if (key.unit == std::string_view("N")) key.unit = "N/m";
    if (key.unit == std::string_view("kg")) key.unit = "kg/m";
    if (key.unit == std::string_view("m^2")) key.unit = "m";
    return key;
}

void finish_wall(WallInput& wall, const Cursor& at, const Context& now) {
    wall.place = at.place();
    const bool by_plane = at.has("point") || at.has("normal") || at.has("name");
    if (wall.side.has_value() == by_plane) {
        throw InputError(at.where(),
                         by_plane ? "side beside name, point or normal" : "neither side nor point",
                         "either side, or name, point and normal");
    }
    if (wall.side) {
        wall.name = wall_sides[*wall.side];
        if (static_cast<int>(*wall.side / 2) < now.dimension) return;
        throw InputError(at.where("side"), "'" + wall.name + "'", "one of x-, x+, y-, y+", "the deck is 2D");
    }
    for (const char* name : {"name", "point", "normal"}) {
        if (!at.has(name)) throw InputError(at.where(), fmt::format("no {}", name), "name, point and normal");
    }
    if (std::find(wall_sides.begin(), wall_sides.end(), wall.name) != wall_sides.end()) {
        throw InputError(at.where("name"), "'" + wall.name + "'", "a name that is no side of the grid");
    }
    const double length = std::hypot(wall.normal[0], wall.normal[1], wall.normal[2]);
    if (length == 0.0)
        throw InputError(at.where("normal"), "a vector of length 0", "the direction of the normal");
    // Within round-off of 1 it stays, so that a resolved deck reads back to the same bits.
    if (std::abs(length - 1.0) < 1e-14) return;
    for (double& component : wall.normal) component /= length;
}

Table<ServoDeck> servo_table() {
    using T = ServoDeck;
    Table<T> t;
    const auto pressure = [&t](const char* name, std::optional<Expression> T::*member, const char* unit,
                               const char* about) {
        const Key key{.name = name, .form = Form::formula, .unit = unit, .words = in_time, .about = about};
        t.add(
            key,
            [=](T& servo, const Cursor& at, const Context& now) {
                servo.*member = read_formula(at, now, in_plane(key, now));
            },
            [=](const T& servo, int) {
                return servo.*member ? formula_text(*(servo.*member)) : std::string();
            });
    };
    pressure("force", &T::force, "N", "Force on the grains (2D: N/m)");
    pressure("stress", &T::stress, "Pa", "Or the force over area");
    const auto number = [&t](const char* name, double T::*member, const char* unit, const char* word,
                             const char* about) {
        Key key{.name = name, .form = Form::number, .unit = unit, .range = positive, .about = about};
        if (*word) key.words = {word};
        t.add(
            key,
            [=](T& servo, const Cursor& at, const Context& now) {
                servo.*member = *word && says(at, now, word) ? 0.0 : read_number(at, now, in_plane(key, now));
            },
            [=](const T& servo, int) {
                if (servo.*member != 0.0) return number_text(servo.*member);
                return std::string(word);
            });
    };
    number("area", &T::area, "m^2", "", "What the stress acts on (2D: length, m)");
    number("mass", &T::mass, "kg", "auto", "Mass of the wall (2D: kg/m); auto: that of all grains");
    t.number("damping", &T::damping, "1/s", not_negative,
             "Force -mass damping v on the wall; left out: critical for a block of the stiffest material");
    t.number("max_speed", &T::max_speed, "m/s", or_infinite, "The wall goes no faster");
    t.finish = [](T& servo, const Cursor& at, const Context&) {
        servo.place = at.place();
        if (servo.force.has_value() == servo.stress.has_value())
            throw InputError(at.where(), servo.force ? "force and stress" : "neither force nor stress",
                             "one of them");
        if (servo.stress.has_value() != (servo.area > 0.0))
            throw InputError(at.where(), servo.stress ? "stress without area" : "area without stress",
                             "stress with area, or force");
    };
    return t;
}

Table<WallInput> wall_table() {
    using T = WallInput;
    Table<T> t;
    const Key side{.name = "side",
                   .form = Form::word,
                   .words = wall_sides,
                   .about = "Side of the grid box, normal inward; or give name, point and normal"};
    t.add(
        side, [side](T& wall, const Cursor& at, const Context& now) { wall.side = read_word(at, now, side); },
        [](const T& wall, int) { return wall.side ? wall_sides[*wall.side] : std::string(); });
    const Key name{.name = "name", .form = Form::text, .about = "Name in messages and results"};
    t.add(
        name, [name](T& wall, const Cursor& at, const Context& now) { wall.name = read_text(at, now, name); },
        [](const T& wall, int) {
            return wall.side || wall.name.empty() ? std::string() : quoted(wall.name);
        });
    const auto plane = [&t](const char* key_name, Numbers3 T::*member, const char* unit, const char* about) {
        const Key key{.name = key_name, .form = Form::vector, .unit = unit, .about = about};
        t.add(
            key,
            [=](T& wall, const Cursor& at, const Context& now) { wall.*member = read_vector(at, now, key); },
            [=](const T& wall, int dimension) {
                return wall.side || wall.name.empty() ? std::string() : vector_text(wall.*member, dimension);
            });
    };
    plane("point", &T::point, "m", "A point of the plane");
    plane("normal", &T::normal, "", "Towards the grains; of any length");
    t.number("friction", &T::friction, "", not_negative, "Coulomb coefficient against all grains");
    t.formulas("velocity", &T::velocity, "m/s", in_time, "Velocity of the wall; left out: at rest");
    std::optional<ServoDeck> T::*const servo = &T::servo;
    t.section("servo", servo, servo_table(), "Moves the wall along its normal until it presses as asked");
    t.finish = finish_wall;
    return t;
}

const Key stiffness_key{.name = "stiffness",
                        .form = Form::number,
                        .unit = "N/m^7",
                        .range = positive,
                        .about = "Node pairs: force over overlap and both volumes (2D: N/m^6)"};

double read_stiffness(const Cursor& at, const Context& now, Key key) {
    if (now.dimension == 2) key.unit = "N/m^6";
    return read_number(at, now, key);
}

Table<ContactPair> pair_table() {
    using T = ContactPair;
    Table<T> t;
    const Key between{.name = "between", .form = Form::names, .about = "Two materials, or one of them twice"};
    t.add(
         between,
         [between](T& pair, const Cursor& at, const Context& now) {
             check_size(at, 2, between, now.dimension);
             Key name = between;
             name.form = Form::text;
             pair.first = read_text(at.entry(0), now, name);
             pair.second = read_text(at.entry(1), now, name);
         },
         [](const T& pair, int) { return fmt::format("[{}, {}]", quoted(pair.first), quoted(pair.second)); })
        .require();
    t.number("friction", &T::friction, "", not_negative, "Coulomb coefficient between them");
    t.add(
        stiffness_key,
        [](T& pair, const Cursor& at, const Context& now) {
            pair.stiffness = read_stiffness(at, now, stiffness_key);
        },
        [](const T& pair, int) { return pair.stiffness ? number_text(*pair.stiffness) : std::string(); });
    t.number("restitution", &T::restitution, "", fraction, "Node pairs: as contact.node_pair.restitution");
    t.number("damping_factor", &T::damping_factor, "", not_negative,
             "Node pairs: as contact.node_pair.damping_factor");
    t.number("contact_radius", &T::contact_radius, "m", positive,
             "Node pairs: distance at which two nodes touch");
    t.number("radius_factor", &T::radius_factor, "", positive,
             "Node pairs: the same over the smallest distance of two nodes of a grain");
    t.finish = [](T& pair, const Cursor& at, const Context&) {
        if (pair.contact_radius && pair.radius_factor)
            throw InputError(at.where(), "contact_radius and radius_factor", "one of them");
        if (pair.friction || pair.stiffness || pair.restitution || pair.damping_factor ||
            pair.contact_radius || pair.radius_factor)
            return;
        throw InputError(at.where(), "nothing for the pair", "friction, or another key beside between");
    };
    return t;
}

Table<NodePairDeck> node_pair_table() {
    using T = NodePairDeck;
    Table<T> t;
    Key stiffness = stiffness_key;
    stiffness.words = {"layer", "consistent", "published"};
    stiffness.about =
        "Force over overlap and both volumes (2D: N/m^6); or from the moduli: that of a layer of particles, "
        "of a "
        "single bond, or as published, 18 K/(pi horizon^5) in 2D, too";
    t.add(
        stiffness,
        [stiffness](T& deck, const Cursor& at, const Context& now) {
            deck.stiffness.reset();
            for (std::size_t i = 0; i < stiffness.words.size(); ++i)
                if (says(at, now, stiffness.words[i])) {
                    deck.stiffness_rule = static_cast<NodePairStiffness>(i);
                    return;
                }
            deck.stiffness = read_stiffness(at, now, stiffness);
        },
        [stiffness](const T& deck, int) {
            return deck.stiffness ? number_text(*deck.stiffness)
                                  : stiffness.words[static_cast<std::size_t>(deck.stiffness_rule)];
        });
    t.word(
        "radius", &T::radius, {"surface", "published"},
        "Distance at which two nodes touch: that of the true surfaces, or radius_factor times the smallest "
        "distance of two nodes of a grain in the run");
    t.number("radius_factor", &T::radius_factor, "", positive,
             "As above; surface: of the spacing, for nodes on the surface itself");
    t.number("contact_radius", &T::contact_radius, "m", positive,
             "Distance at which two nodes touch, as a number");
    t.word("damping", &T::damping, {"none", "nodes", "centres"},
           "Dashpots: none, one a pair of nodes, or between the centres of grains as published");
    t.number("restitution", &T::restitution, "", fraction,
             "Of two nodes with a dashpot; centres: in their formula");
    t.number("damping_factor", &T::damping_factor, "", not_negative, "Of the dashpots between centres");
    t.word("friction_law", &T::friction_law, {"history", "slip", "published"},
           "Tangential springs that stick; friction against the slip; with the sign of the published model");
    t.number("tangential_ratio", &T::tangential_ratio, "", {0.0, 1.0, true, false, false},
             "Tangential stiffness over normal stiffness (history)");
    t.number("tangential_damping", &T::tangential_damping, "", not_negative,
             "Dashpot of a tangential spring over the critical one (history)");
    t.word("particles", &T::particles, {"surface", "all"}, "Nodes that take part: two layers, or all");
    t.flag("self_contact", &T::self_contact, "Nodes on two sides of a crack repel");
    t.number("skin", &T::skin, "", {0.0, 10.0, false, false, false},
             "Pairs are searched anew when a node has moved by half of this part of the largest radius; 0: "
             "every step");
    return t;
}

Table<ContactDeck> contact_table() {
    using T = ContactDeck;
    Table<T> t;
    t.word("method", &T::method, {"grid", "node_pair"},
           "On the grid, or between nodes; all keys but rule: none, friction, pairs, debris and node_pair "
           "belong to "
           "the grid");
    t.word(
        "rule", &T::rule, {"none", "pair", "surface", "seed", "no_slip"},
        "No contact, pairs of grains on a node, surface particles on surfaces, the seed rule, or one field "
        "for all grains of material points, which stick");
    t.word("walls", &T::walls, {"rule", "exact", "tile"},
           "Gap to walls: at surface particles (exact) or one a node (tile); rule: exact for surface, else "
           "tile");
    t.word("coupling", &T::coupling, {"impulse", "flip"}, "How nodal changes reach the particles");
    t.number("friction", &T::friction, "", not_negative, "Coulomb coefficient between grains");
    t.list("pairs", &T::pairs, pair_table(), "What holds between particular materials");
    t.flag(
        "fragments", &T::fragments,
        "Fragments of a broken grain are grains of their own; false: one body a grain, as before it broke");
    t.integer(
        "debris", &T::debris, {1, 1000000, false, false, false},
        "Pieces of fewer particles than this are debris: balls that do not turn; counted so with either "
        "method");
    t.number("interior_weight", &T::interior_weight, "", fraction,
             "Weight of interior particles in an impulse");
    t.integer("max_sweeps", &T::max_sweeps, {1, 10000, false, false, false},
              "Sweeps over the contacts, at most");
    t.number("tolerance", &T::tolerance, "", {0.0, 1.0, true, true, false},
             "Sweeps end when impulses change by less than this part");
    t.number("skin", &T::skin, "", {0.0, 0.25, false, false, false},
             "Nodes are searched anew when something has moved by this part of a cell; 0: every step");
    t.flag("tile", &T::tile, "Gap at the closest approach of two profiles; false: from mean positions");
    t.flag("curvature", &T::curvature, "Profiles know the curvature of the surface");
    t.flag("rotation", &T::rotation, "Impulses act at one point and turn what they meet");
    t.flag("gap_test", &T::gap_test, "Grains may approach as far as there is a gap");
    t.flag("exact_mass", &T::exact_mass, "Exact inverse mass of the impulse map; false: nodal mass");
    t.section("node_pair", &T::node_pair, node_pair_table(), "Contact between nodes (method: node_pair)");
    t.finish = [](T& contact, const Cursor& at, const Context&) {
        contact.place = at.place();
        const bool flip = contact.coupling == ContactCoupling::flip;
        if (contact.method == ContactMethodKind::node_pair) return;
        if (contact.rule == ContactRule::surface && flip)
            throw InputError(at.where("coupling"), "flip with rule surface", "impulse",
                             "its contacts are at particles, not at nodes");
        if (contact.walls == ContactWalls::exact && (contact.rule == ContactRule::seed || flip))
            throw InputError(at.where("walls"),
                             flip ? "exact walls with coupling flip" : "exact walls with rule seed",
                             "rule or tile", "exact walls act on particles, not on nodes");
    };
    return t;
}

Table<DampingInput> damping_table() {
    Table<DampingInput> t;
    t.number("mass", &DampingInput::mass, "1/s", not_negative, "Force -mass m v on every particle");
    return t;
}

/// `grains`: all, a group, or a list of numbers and groups; no number and no group stand for all.
template <class T>
void add_ids(Table<T>& t, const char* name, std::type_identity_t<std::vector<int> T::*> member,
             std::type_identity_t<std::vector<std::string> T::*> groups, const char* about) {
    const Key key = grain_ids_key(name, about);
    t.add(
        key,
        [=](T& target, const Cursor& at, const Context& now) {
            read_grain_ids(target.*member, target.*groups, at, now, key);
        },
        [=](const T& target, int) { return (target.*member).empty() ? "all" : ids_text(target.*member); });
}

Table<LoadInput> load_table() {
    using T = LoadInput;
    Table<T> t;
    add_ids(t, "grains", &T::grains, &T::groups, "Grains it acts on");
    t.formula("region", &T::region, in_place, "Acts where this is not 0, by the place at t = 0");
    t.formulas("acceleration", &T::acceleration, "m/s^2", in_all, "Force per mass; or give force_density");
    t.formulas("force_density", &T::force_density, "N/m^3", in_all, "Force per volume");
    t.finish = [](T& load, const Cursor& at, const Context&) {
        load.place = at.place();
        if (load.acceleration.empty() == load.force_density.empty()) {
            throw InputError(at.where(), load.acceleration.empty() ? "neither" : "both",
                             "exactly one of acceleration, force_density");
        }
        load.per_mass = !load.acceleration.empty();
        load.value = load.per_mass ? load.acceleration : load.force_density;
    };
    return t;
}

Table<ConstraintDeck> constraint_table() {
    using T = ConstraintDeck;
    Table<T> t;
    add_ids(t, "grains", &T::grains, &T::groups, "Grains it holds");
    t.formula("region", &T::region, in_place, "Holds particles where this is not 0, by the place at t = 0");
    const Key velocity{.name = "velocity",
                       .form = Form::formulas,
                       .unit = "m/s",
                       .words = in_all,
                       .about = "Prescribed velocity per axis; free: not held"};
    t.add(
         velocity,
         [velocity](T& constraint, const Cursor& at, const Context& now) {
             check_size(at, static_cast<std::size_t>(now.dimension), velocity, now.dimension);
             Key component = velocity;
             component.form = Form::formula;
             bool any = false;
             for (std::size_t i = 0; i < at.node().items.size(); ++i) {
                 const Cursor entry = at.entry(i);
                 if (entry.node().kind == Node::Kind::null || says(entry, now, "free")) continue;
                 constraint.velocity[i] = read_formula(entry, now, component);
                 any = true;
             }
             if (!any) throw InputError(at.where(), "free on every axis", "a velocity on one axis at least");
         },
         [](const T& constraint, int dimension) {
             std::string text;
             for (std::size_t i = 0; i < static_cast<std::size_t>(dimension); ++i) {
                 const std::optional<Expression>& value = constraint.velocity[i];
                 text += (i > 0 ? ", " : "") + (value ? formula_text(*value) : std::string("free"));
             }
             return fmt::format("[{}]", text);
         })
        .require();
    t.finish = [](T& constraint, const Cursor& at, const Context&) { constraint.place = at.place(); };
    return t;
}

Table<PrepareInput> prepare_table() {
    using T = PrepareInput;
    Table<T> t;
    t.number("duration", &T::duration, "s", not_negative, "Relaxation before the clock starts");
    t.vector("gravity", &T::gravity, "m/s^2", any_number, "Meanwhile; left out: as in the run");
    t.number("mass_damping", &T::mass_damping, "1/s", not_negative, "Meanwhile: force -mass_damping m v");
    t.number("friction", &T::friction, "", not_negative,
             "Meanwhile, of all contacts; left out: as in the run");
    t.list("loads", &T::load_entries, load_table(), "Body forces meanwhile, on top of those of the run");
    return t;
}

Table<CheckpointDeck> checkpoint_table() {
    using T = CheckpointDeck;
    Table<T> t;
    t.integer("every", &T::every, {0, 2e9, false, false, false},
              "Steps between checkpoints; 0: only when the run is stopped");
    return t;
}

Table<OutputDeck> output_table() {
    using T = OutputDeck;
    Table<T> t;
    t.number_or("interval", &T::interval, "auto", "s", positive, "Between frames; auto: 100 frames");
    t.number_or("history_interval", &T::history_interval, "auto", "s", positive,
                "Between rows of history.csv and grains.csv; auto: 1000 rows");
    add_ids(t, "track", &T::track, &T::groups, "Grains in grains.csv");
    // Unlike loads, an output tracks none by default, and says so with an empty list.
    KeyField<T>& track = t.fields.back();
    const auto read_ids = track.read;
    track.read = [read_ids](T& output, const Cursor& at, const Context& now) {
        if (at.node().kind == Node::Kind::list && at.node().items.empty()) return;
        read_ids(output, at, now);
        output.track_all = output.track.empty() && output.groups.empty();
    };
    track.write = [](const T& output, int) { return output.track_all ? "all" : ids_text(output.track); };
    t.flag("vtp", &T::vtp, "Also a series of .vtp files");
    t.section("checkpoint", &T::checkpoint, checkpoint_table(),
              "States from which `quern run --resume` goes on");
    t.finish = [](T& output, const Cursor& at, const Context&) { output.place = at.place(); };
    return t;
}

Table<PointOptions> points_table() {
    using T = PointOptions;
    Table<T> t;
    t.word("functions", &T::functions, {"linear", "gimp", "quadratic"},
           "Shape functions: linear hats, boxes of the size of a point, quadratic B-splines");
    t.integer("order", &T::order, {1, 10, false, false, false},
              "Terms of the inverse mass matrix: 1 lumps it and loses spin, more keep it and cost time");
    return t;
}

Table<DeckInput> make_deck_table() {
    using T = DeckInput;
    Table<T> t;
    t.text("title", &T::title, "What the deck shows");
    t.integer("dimension", &T::dimension, {2, 3, false, false, false}, "2 or 3");
    t.add(
        {.name = "params",
         .form = Form::named,
         .about = "Numbers, quantities, texts and formulas for use as `${name}` below"},
        [](T&, const Cursor&, const Context&) {}, [](const T&, int) { return std::string(); });
    t.section("time", &T::time, time_table(), "How long and in which steps").require();
    t.vector("gravity", &T::gravity, "m/s^2", any_number, "Acceleration of every particle");
    t.named("materials", &T::materials, material_table(), "Materials by name").require();
    t.named("shapes", &T::shapes, shape_table(), "Reference shapes by name").require();
    t.section("grid", &T::grid, grid_table(), "Box and cells of the background grid").require();
    t.list("walls", &T::walls, wall_table(), "Rigid planes");
    t.section("contact", &T::contact, contact_table(), "What happens between grains");
    t.section("damping", &T::damping, damping_table(), "Artificial damping");
    t.list("loads", &T::loads, load_table(), "Body forces");
    t.list("constraints", &T::constraints, constraint_table(), "Prescribed velocities of particles");
    t.list("cracks", &T::cracks, crack_table(), "Cuts that grains have from the start");
    t.list("no_fail", &T::no_fail, no_fail_table(), "Where bonds never break");
    t.section("prepare", &T::prepare, prepare_table(), "Relaxation before the run");
    t.section("compute", &T::compute, compute_table(), "How forces inside the grains are evaluated");
    t.section("material_points", &T::material_points, points_table(),
              "How grains with model: material_points see the grid");
    t.section("output", &T::output, output_table(), "What is written, and how often");
    t.section(
        "observe", &T::observe, observe_table(),
        "Contacts, stress and their means with every frame (docs/observers.md); {}: without regions and "
        "profiles of your own");
    const auto write_observe = t.fields.back().write;
    t.fields.back().write = [write_observe](const T& input, int dimension) {
        return input.observe.on ? write_observe(input, dimension) : std::string();
    };
    t.list("grains", &T::grains, grain_table(), "Grains, numbered from 0 in this order").require();
    return t;
}

}  // namespace

const Table<DeckInput>& deck_table() {
    static const Table<DeckInput> table = make_deck_table();
    return table;
}

}  // namespace quern
