#include "src/sim/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "grid/error.hpp"
#include "grid/parallel.hpp"
#include "grid/z_order.hpp"
#include "particles/strain.hpp"
#include "particles/weibull.hpp"
#include "src/mesh/make_shape.hpp"
#include "src/sim/cracks.hpp"
#include "src/sim/force_plan.hpp"
#include "src/sim/overlap.hpp"

namespace quern {

namespace {

template <int Dim>
Vec<Dim> vec(const Numbers3& v) {
    Vec<Dim> r;
    for (int a = 0; a < Dim; ++a) r[a] = v[a];
    return r;
}

Spin<2> spin(const Numbers3& v, Spin<2>) {
    return Spin<2>(v[2]);
}
Spin<3> spin(const Numbers3& v, Spin<3>) {
    return {v[0], v[1], v[2]};
}

template <int Dim>
CartesianGrid<Dim> make_grid(const GridDeck& deck) {
    IntVec<Dim> n;
    std::array<bool, Dim> periodic{};
    for (int a = 0; a < Dim; ++a) {
        n[a] = std::max(1, static_cast<int>(std::ceil(deck.extent[a] / deck.spacing - 1e-9)));
        periodic[a] = deck.periodic[a];
        if (periodic[a] && n[a] < 4)
            throw InputError(deck.place.text(), fmt::format("{} cells on a periodic axis", n[a]),
                             "4 or more");
    }
    return CartesianGrid<Dim>(vec<Dim>(deck.origin), deck.spacing, n, periodic);
}

KernelChoice kernel_choice(const ComputeDeck& deck, bool batches) {
    return {deck.kernel == ForceKernel::reference ? Kernel::reference : Kernel::fast, deck.instructions,
            batches};
}

NodePairOptions node_pair_options(const NodePairDeck& deck) {
    NodePairOptions options;
    options.radius = deck.radius == NodePairRadius::published ? PairRadius::published : PairRadius::surface;
    options.radius_factor = deck.radius_factor;
    options.damping = deck.damping == NodePairDamping::nodes     ? PairDamping::nodes
                      : deck.damping == NodePairDamping::centres ? PairDamping::centres
                                                                 : PairDamping::none;
    options.friction_law = deck.friction_law == NodePairFriction::history ? PairFriction::history
                           : deck.friction_law == NodePairFriction::slip  ? PairFriction::slip
                                                                          : PairFriction::published;
    options.tangential_ratio = deck.tangential_ratio;
    options.tangential_damping = deck.tangential_damping;
    options.particles =
        deck.particles == NodePairParticles::all ? PairParticles::all : PairParticles::surface;
    options.self_contact = deck.self_contact;
    options.skin = deck.skin;
    return options;
}

GridContactOptions contact_options(const ContactDeck& deck) {
    GridContactOptions options;
    options.rule = deck.rule == ContactRule::seed      ? GridRule::seed
                   : deck.rule == ContactRule::surface ? GridRule::surface
                                                       : GridRule::pair;
    options.exact_walls = deck.walls == ContactWalls::rule ? deck.rule == ContactRule::surface
                                                           : deck.walls == ContactWalls::exact;
    options.coupling = deck.coupling == ContactCoupling::flip ? GridCoupling::flip : GridCoupling::impulse;
    options.interior_weight = deck.interior_weight;
    options.max_sweeps = deck.max_sweeps;
    options.tolerance = deck.tolerance;
    options.debris = deck.debris;
    options.skin = deck.skin;
    options.tile = deck.tile;
    options.curvature = deck.curvature;
    options.rotation = deck.rotation;
    options.gap_test = deck.gap_test;
    options.exact_mass = deck.exact_mass;
    return options;
}

template <class Named>
int index_of(const std::vector<Named>& list, const std::string& name) {
    const auto it =
        std::find_if(list.begin(), list.end(), [&](const Named& item) { return item.name == name; });
    return static_cast<int>(it - list.begin());
}

ShapeDeck enlarged(ShapeDeck shape, double scale) {
    shape.radius *= scale;
    for (double& size : shape.size) size *= scale;
    for (double& axis : shape.semi_axes) axis *= scale;
    for (std::array<double, 2>& corner : shape.vertices)
        for (double& x : corner) x *= scale;
    return shape;
}

/// The shape of a grain as a place in Scene::shapes, and the scale that is left to it.
struct ShapeChoice {
    int shape = 0;
    double scale = 1.0;
};

/// Shapes of the deck in its order, then those filled anew for grains of another scale; of each grain, which.
template <int Dim>
std::vector<ShapeChoice> make_shapes(const Deck& deck, Scene<Dim>& scene) {
    const auto add = [&](const ShapeDeck& shape) {
        scene.shapes.push_back(std::make_unique<Shape<Dim>>(make_shape<Dim>(shape)));
        return static_cast<int>(scene.shapes.size()) - 1;
    };
    for (const ShapeDeck& shape : deck.shapes) add(shape);
    std::map<std::pair<int, double>, int> refilled;
    std::vector<ShapeChoice> choices;
    for (const GrainDeck& grain : deck.grains) {
        const int shape = index_of(deck.shapes, grain.shape);
        const ShapeDeck& from = deck.shapes[static_cast<std::size_t>(shape)];
        if (from.scaling == Scaling::stretch || grain.scale == 1.0) {
            choices.push_back({shape, grain.scale});
            continue;
        }
        const auto [place, is_new] = refilled.try_emplace({shape, grain.scale});
        if (is_new) place->second = add(enlarged(from, grain.scale));
        choices.push_back({place->second, 1.0});
    }
    return choices;
}

/// The group of peridynamic grains of this shape and material.
template <int Dim>
MaterialGroup<Dim> make_group(const Deck& deck, const Shape<Dim>& shape, const Material& material,
                              int n_grains) {
    const bool batched =
        material.model != ForceModel::correspondence && makes_batches(deck.compute, n_grains);
    MaterialGroup<Dim> group{make_model<Dim>(shape, material, kernel_choice(deck.compute, batched))};
    group.batched = batched;
    group.bond_damping = material.bond_damping;
    group.damped = material.bond_damping > 0.0;
    group.breakable = material.can_break();
    group.plastic = material.can_yield();
    group.breaks_by_work =
        std::visit([](const auto& model) { return model.break_limit().by_work; }, group.model);
    group.density = material.density;
    return group;
}

/// A point that is wider than a cell would leave nodes without mass inside its grain.
void check_point_size(const Deck& deck, const GrainDeck& grain, double side) {
    if (side <= deck.grid.spacing * (1.0 + 1e-9)) return;
    throw InputError(
        grain.place.text(),
        fmt::format("material points {:.4g} m wide on a grid of {:.4g} m", side, deck.grid.spacing),
        "points no wider than a cell", "half a cell is usual: shapes.*.spacing, grid.spacing");
}

/// Grains in the order of their groups, shape and material, those of material points last; within a group
/// along a curve through space, so that neighbours share caches.
template <int Dim>
void place_grains(const Deck& deck, Scene<Dim>& scene) {
    const std::vector<ShapeChoice> choices = make_shapes(deck, scene);
    const int n_grains = static_cast<int>(deck.grains.size());
    std::vector<std::tuple<bool, int, int, std::uint64_t, int>> order;
    for (int id = 0; id < n_grains; ++id) {
        const Vec<Dim> in_cells = scene.grid.in_cells(vec<Dim>(deck.grains[id].position));
        const int material = index_of(deck.materials, deck.grains[id].material);
        order.emplace_back(deck.materials[material].model == ForceModel::material_points, choices[id].shape,
                           material, z_order<Dim>(CartesianGrid<Dim>::cell(in_cells)), id);
    }
    std::sort(order.begin(), order.end());
    scene.grain_of_id.resize(static_cast<std::size_t>(n_grains));
    std::map<std::pair<int, int>, int> group_size;
    for (const auto& [in_points, shape_index, material_index, place, id] : order)
        ++group_size[{shape_index, material_index}];
    std::pair<int, int> previous{-1, -1};
    for (const auto& [in_points, shape_index, material_index, place, id] : order) {
        const GrainDeck& from = deck.grains[id];
        const Material& material = deck.materials[material_index];
        const Shape<Dim>& shape = *scene.shapes[shape_index];
        const int here = static_cast<int>(scene.grains.size());
        if (in_points) {
            check_point_size(deck, from, shape.dx * choices[id].scale);
        } else if (previous != std::pair{shape_index, material_index}) {
            previous = {shape_index, material_index};
            scene.groups.push_back(make_group(deck, shape, material, group_size[previous]));
            scene.groups.back().first_grain = here;
        }
        if (!in_points) scene.groups.back().last_grain = here + 1;
        Grain<Dim> grain;
        grain.shape = &shape;
        grain.scale = choices[id].scale;
        grain.first = scene.particles.size();
        grain.count = shape.n_nodes();
        grain.material = material_index;
        grain.id = id;
        grain.wall = from.wall;
        if (material.strength)
            grain.strength = weibull_factor(material.strength->weibull_modulus, material.strength->seed, id);
        const double volume_scale = std::pow(grain.scale, Dim);
        const Mat<Dim> R = rotation_matrix(spin(from.angle, Spin<Dim>{}));
        for (int i = 0; i < shape.n_nodes(); ++i) {
            const Vec<Dim> x = vec<Dim>(from.position) + grain.scale * (R * shape.X[i]);
            if (!scene.grid.contains(x))
                throw InputError(from.place.text(),
                                 fmt::format("grain {} with a particle outside the grid", id),
                                 "every grain inside the grid", "move the grain or enlarge grid.extent");
            for (std::size_t w = 0; w < scene.walls.size(); ++w)
                if (scene.walls[w].distance(x) < -0.5 * shape.dx * grain.scale)
                    throw InputError(from.place.text(),
                                     fmt::format("grain {} reaching {:.3g} m behind wall '{}'", id,
                                                 -scene.walls[w].distance(x), deck.walls[w].name),
                                     "every grain in front of every wall", "move the grain or the wall");
            scene.particles.x.push_back(x);
            scene.particles.volume.push_back(volume_scale * shape.volume[i]);
            scene.particles.mass.push_back(material.density * volume_scale * shape.volume[i]);
            grain.volume += scene.particles.volume.back();
            grain.mass += scene.particles.mass.back();
        }
        if (!in_points)
            scene.n_bonds +=
                std::visit([](const auto& model) { return model.n_bonds(); }, scene.groups.back().model);
        scene.grain_of_id[static_cast<std::size_t>(id)] = here;
        scene.grains.push_back(grain);
    }
}

/// Grains of material points, all that follow the groups. Their frequencies: those of grains of a shape and
/// material lie between those of the smallest and the largest, and depend a little on where the grain lies in
/// its cells.
template <int Dim>
void add_points(const Deck& deck, Scene<Dim>& scene) {
    const int first = scene.groups.empty() ? 0 : scene.groups.back().last_grain;
    const int n_grains = static_cast<int>(scene.grains.size());
    if (first == n_grains) return;
    const bool one_field = deck.contact.rule == ContactRule::no_slip;
    MaterialPoints<Dim>& points = scene.points.emplace(scene.grid, deck.material_points, one_field);
    for (int g = first; g < n_grains; ++g) {
        const Grain<Dim>& grain = scene.grains[g];
        const Material& material = deck.materials[grain.material];
        points.add_grain(
            grain,
            std::span(scene.particles.volume)
                .subspan(static_cast<std::size_t>(grain.first), static_cast<std::size_t>(grain.count)),
            {material.bulk_modulus, material.shear_modulus, material.yield_stress,
             material.hardening_modulus});
    }
    if (one_field) {
        scene.point_frequency.assign(static_cast<std::size_t>(points.n_grains()),
                                     points.max_frequency(scene.particles, 0));
        return;
    }
    for (int begin = first, end; begin < n_grains; begin = end) {
        int small = begin, large = begin;
        const auto like = [&](const Grain<Dim>& grain) {
            return grain.shape == scene.grains[begin].shape && grain.material == scene.grains[begin].material;
        };
        for (end = begin; end < n_grains && like(scene.grains[end]); ++end) {
            if (scene.grains[end].scale < scene.grains[small].scale) small = end;
            if (scene.grains[end].scale > scene.grains[large].scale) large = end;
        }
        double frequency = points.max_frequency(scene.particles, small - first);
        if (large != small)
            frequency = std::max(frequency, points.max_frequency(scene.particles, large - first));
        scene.point_frequency.insert(scene.point_frequency.end(), static_cast<std::size_t>(end - begin),
                                     frequency);
    }
}

/// Laws of all pairs of materials: those of node_pair, and what pairs say.
PairLaws pair_laws(const Deck& deck) {
    const NodePairDeck& from = deck.contact.node_pair;
    PairLaw all;
    all.rule = from.stiffness_rule == NodePairStiffness::published    ? PairStiffness::published
               : from.stiffness_rule == NodePairStiffness::consistent ? PairStiffness::consistent
                                                                      : PairStiffness::layer;
    if (from.stiffness) all.rule = PairStiffness::given;
    all.stiffness = from.stiffness.value_or(0.0);
    all.radius = from.contact_radius.value_or(0.0);
    all.restitution = from.restitution;
    all.damping_factor = from.damping_factor;
    PairLaws laws(static_cast<int>(deck.materials.size()), all);
    for (const ContactPair& pair : deck.contact.pairs) {
        PairLaw law = all;
        if (pair.stiffness) {
            law.rule = PairStiffness::given;
            law.stiffness = *pair.stiffness;
        }
        if (pair.contact_radius) law.radius = *pair.contact_radius;
        if (pair.radius_factor) {
            law.radius = 0.0;
            law.radius_factor = *pair.radius_factor;
        }
        if (pair.restitution) law.restitution = *pair.restitution;
        if (pair.damping_factor) law.damping_factor = *pair.damping_factor;
        laws.set(index_of(deck.materials, pair.first), index_of(deck.materials, pair.second), law);
    }
    return laws;
}

template <int Dim>
void add_node_pairs(const Deck& deck, Scene<Dim>& scene) {
    std::vector<PairBody> bodies;
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        const Material& material = deck.materials[scene.grains[g].material];
        const double scale = scene.grains[g].scale;
        PairBody body;
        body.bulk_modulus = material.bulk_modulus;
        body.modulus = dilatational_modulus<Dim>(material);
        body.bond_damping = material.bond_damping;
        const auto measure = [&](const Bonds<Dim>& bonds) {
            body.horizon = scale * bonds.horizon;
            body.least_distance = scale * *std::min_element(bonds.length.begin(), bonds.length.end());
        };
        if (const int k = scene.point_grain(static_cast<int>(g)); k >= 0) {
            // Springs of the layer that a peridynamic grain would have.
            measure(make_bonds(*scene.grains[g].shape, material));
            body.frequency = scene.point_frequency[k];
        } else {
            std::visit(
                [&](const auto& model) {
                    measure(model.bonds());
                    body.frequency = model.max_frequency() / scale;
                },
                scene.group_of(static_cast<int>(g)).model);
        }
        bodies.push_back(body);
    }
    const NodePairOptions options = node_pair_options(deck.contact.node_pair);
    scene.contact.emplace(std::in_place_type<NodePairContact<Dim>>, scene.grid,
                          std::span<const Grain<Dim>>(scene.grains), scene.particles.volume,
                          std::move(bodies), pair_laws(deck), options);
}

template <int Dim>
std::vector<int> select_particles(const Scene<Dim>& scene, const std::vector<int>& ids,
                                  const std::optional<Expression>& region) {
    std::vector<int> particles;
    for (std::size_t id = 0; id < scene.grain_of_id.size(); ++id) {
        if (!ids.empty() && std::find(ids.begin(), ids.end(), static_cast<int>(id)) == ids.end()) continue;
        const Grain<Dim>& grain = scene.grains[scene.grain_of_id[id]];
        for (int p = grain.first; p < grain.first + grain.count; ++p) {
            const Vec<Dim>& x = scene.particles.x[p];
            if (!region || (*region)(x[0], x[1], Dim == 3 ? x[Dim - 1] : 0.0, 0.0) != 0.0)
                particles.push_back(p);
        }
    }
    return particles;
}

void require_particles(const Place& place, const std::vector<int>& particles) {
    if (particles.empty())
        throw InputError(place.text(), "a region without particles", "at least one particle in it");
}

template <int Dim>
void add_walls(const Deck& deck, Scene<Dim>& scene) {
    for (const WallDeck& from : deck.walls) {
        Wall<Dim> wall;
        wall.point = vec<Dim>(from.point);
        wall.normal = vec<Dim>(from.normal).normalized();
        wall.friction = from.friction;
        std::array<Expression, Dim> velocity;
        for (int k = 0; k < Dim && !from.velocity.empty(); ++k) velocity[k] = from.velocity[k];
        scene.walls.push_back(wall);
        scene.wall_velocity.push_back(velocity);
        scene.servos.emplace_back();
    }
}

/// Servos of the walls; what the deck leaves out follows from the grains.
template <int Dim>
void add_servos(const Deck& deck, Scene<Dim>& scene) {
    double mass = 0.0, sound = 0.0;
    for (const Grain<Dim>& grain : scene.grains) {
        if (grain.wall) continue;
        const Material& material = deck.materials[grain.material];
        mass += grain.mass;
        sound = std::max(sound, std::sqrt((dilatational_modulus<Dim>(material) + material.shear_modulus) /
                                          material.density));
    }
    for (std::size_t w = 0; w < deck.walls.size(); ++w) {
        const std::optional<ServoDeck>& from = deck.walls[w].servo;
        if (!from) continue;
        double height = 0.0;
        for (const Vec<Dim>& x : scene.particles.x) height = std::max(height, scene.walls[w].distance(x));
        Servo servo;
        servo.force = from->force ? *from->force : *from->stress;
        servo.per = from->force ? 1.0 : from->area;
        servo.mass = from->mass > 0.0 ? from->mass : mass;
        servo.damping = from->damping.value_or(2.0 * sound / height);
        servo.max_speed = from->max_speed;
        scene.servos[w] = servo;
    }
}

template <int Dim>
void find_held_walls(Scene<Dim>& scene) {
    std::vector<std::uint8_t> held(static_cast<std::size_t>(scene.particles.size()));
    for (const Constraint<Dim>& constraint : scene.constraints)
        for (const int p : constraint.particles) held[p] = 1;
    std::vector<int> wall_of(held.size(), -1);
    for (const int g : scene.grain_of_id) {
        const Grain<Dim>& grain = scene.grains[g];
        const auto first = held.begin() + grain.first, last = first + grain.count;
        if (!grain.wall || std::find(first, last, 1) == last) continue;
        std::fill_n(wall_of.begin() + grain.first, grain.count, static_cast<int>(scene.held_walls.size()));
        scene.held_walls.push_back(g);
    }
    for (Constraint<Dim>& constraint : scene.constraints)
        for (const int p : constraint.particles) constraint.wall.push_back(wall_of[p]);
}

template <int Dim>
void add_loads_and_constraints(const Deck& deck, Scene<Dim>& scene) {
    const auto add = [&](const std::vector<LoadDeck>& from_deck, std::vector<Load<Dim>>& loads) {
        for (const LoadDeck& from : from_deck) {
            Load<Dim> load;
            load.particles = select_particles(scene, from.grains, from.region);
            require_particles(from.place, load.particles);
            load.per_mass = from.per_mass;
            for (int k = 0; k < Dim; ++k) load.value[k] = from.value[k];
            loads.push_back(std::move(load));
        }
    };
    add(deck.loads, scene.loads);
    add(deck.prepare.loads, scene.prepare_loads);
    for (const ConstraintDeck& from : deck.constraints) {
        Constraint<Dim> constraint;
        constraint.particles = select_particles(scene, from.grains, from.region);
        require_particles(from.place, constraint.particles);
        for (int k = 0; k < Dim; ++k) constraint.velocity[k] = from.velocity[k];
        scene.constraints.push_back(std::move(constraint));
    }
    find_held_walls(scene);
}

/// Points move with the field of their grain, which mixes what is held with what is free: all of it must be
/// held, or nothing. In a field that they share with others, held grains are rigid: what the nodes between
/// them and others do is no strain of theirs.
template <int Dim>
void hold_points(const Deck& deck, Scene<Dim>& scene) {
    if (!scene.points) return;
    const std::size_t nobody = scene.constraints.size();
    std::vector<std::size_t> held_by(scene.particles.x.size(), nobody);
    for (std::size_t c = 0; c < nobody; ++c)
        for (const int p : scene.constraints[c].particles) held_by[p] = c;
    for (int k = 0; k < scene.points->n_grains(); ++k) {
        const Grain<Dim>& grain = scene.grains[scene.grains.size() - scene.points->n_grains() + k];
        const auto first = held_by.begin() + grain.first, last = first + grain.count;
        const std::size_t by = *std::min_element(first, last);
        if (by == nobody) continue;
        const auto& velocity = scene.constraints[by].velocity;
        const bool all_axes =
            std::all_of(velocity.begin(), velocity.end(), [](const auto& v) { return v.has_value(); });
        if (!all_axes || std::any_of(first, last, [&](std::size_t c) { return c != by; }))
            throw InputError(deck.constraints[by].place.text(),
                             fmt::format("a velocity of {} of grain {}, which is made of material points",
                                         all_axes ? "a part" : "some axes", grain.id),
                             "whole grains held on all axes",
                             "give the velocity of every axis, without region");
        if (deck.contact.rule == ContactRule::no_slip) scene.points->make_rigid(scene.particles, k);
    }
}

/// Contact on the grid solves for velocities before constraints are put back: it must know what they hold.
/// A particle that is free along some axis keeps its mass.
template <int Dim>
void weigh_held_particles(Scene<Dim>& scene) {
    if (scene.constraints.empty() || !scene.contact ||
        !std::holds_alternative<GridContact<Dim>>(*scene.contact))
        return;
    std::vector<std::array<bool, Dim>> held(static_cast<std::size_t>(scene.particles.size()));
    for (const Constraint<Dim>& constraint : scene.constraints)
        for (const int p : constraint.particles)
            for (int k = 0; k < Dim; ++k)
                if (constraint.velocity[k]) held[p][k] = true;
    scene.contact_mass = scene.particles.mass;
    for (std::size_t p = 0; p < held.size(); ++p) {
        const auto n_axes = std::count(held[p].begin(), held[p].end(), true);
        if (n_axes == Dim) scene.contact_mass[p] *= held_heavier;
        if (n_axes > 0 && n_axes < Dim) ++scene.held_in_part;
    }
}

}  // namespace

template <int Dim>
std::unique_ptr<Scene<Dim>> make_scene(const Deck& deck) {
    auto scene = std::make_unique<Scene<Dim>>(make_grid<Dim>(deck.grid));
    add_walls(deck, *scene);
    place_grains(deck, *scene);
    add_points(deck, *scene);
    mark_cracked(deck, *scene);
    plan_forces(deck, *scene);
    set_cracks(deck, *scene);
    set_no_fail(deck, *scene);
    check_overlap(deck, *scene);
    start_fragments(*scene, deck.contact.debris);
    scene->contact_in_pieces = deck.contact.fragments;
    add_servos(deck, *scene);
    scene->x_start = scene->particles.x;
    const std::size_t n = scene->particles.x.size();
    scene->particles.v.assign(n, Vec<Dim>::Zero());
    if (std::any_of(scene->groups.begin(), scene->groups.end(),
                    [](const auto& group) { return group.plastic; }))
        scene->plastic.resize(n);
    StepArrays<Dim>& arrays = scene->arrays;
    arrays.internal.resize(n);
    arrays.v_before.resize(n);
    arrays.wall_v_before.assign(scene->walls.size(), Vec<Dim>::Zero());
    if (!deck.loads.empty() || !deck.prepare.loads.empty()) arrays.load.resize(n);
    if (std::any_of(scene->groups.begin(), scene->groups.end(),
                    [](const auto& group) { return group.damped; }))
        arrays.damping.assign(n, Vec<Dim>::Zero());
    scene->friction = FrictionTable(static_cast<int>(deck.materials.size()), deck.contact.friction);
    for (const ContactPair& pair : deck.contact.pairs)
        if (pair.friction)
            scene->friction.set(index_of(deck.materials, pair.first), index_of(deck.materials, pair.second),
                                *pair.friction);
    const bool touches = deck.contact.rule != ContactRule::none && deck.contact.rule != ContactRule::no_slip;
    if (touches && deck.contact.method == ContactMethodKind::node_pair) {
        add_node_pairs(deck, *scene);
    } else if (touches) {
        scene->contact.emplace(std::in_place_type<GridContact<Dim>>, scene->grid,
                               contact_options(deck.contact));
        if (scene->moves_with_grid()) {
            arrays.drift.assign(n, Vec<Dim>::Zero());
            arrays.drift_before.assign(n, Vec<Dim>::Zero());
        }
    }
    if (scene->points) arrays.drift.assign(n, Vec<Dim>::Zero());
    hand_over_cracks(*scene);
    scene->gravity = vec<Dim>(deck.gravity);
    scene->mass_damping = deck.mass_damping;
    add_loads_and_constraints(deck, *scene);
    hold_points(deck, *scene);
    weigh_held_particles(*scene);
    return scene;
}

template <int Dim>
void set_initial_velocities(const Deck& deck, Scene<Dim>& scene) {
    for (const Grain<Dim>& grain : scene.grains) {
        const GrainDeck& from = deck.grains[grain.id];
        Vec<Dim> centre = Vec<Dim>::Zero();
        for (int p = grain.first; p < grain.first + grain.count; ++p)
            centre += scene.particles.mass[p] * scene.particles.x[p];
        centre /= grain.mass;
        const Spin<Dim> omega = spin(from.spin, Spin<Dim>{});
        for (int p = grain.first; p < grain.first + grain.count; ++p)
            scene.particles.v[p] =
                vec<Dim>(from.velocity) + cross(omega, Vec<Dim>(scene.particles.x[p] - centre));
    }
    if (!scene.arrays.drift.empty()) scene.arrays.drift = scene.particles.v;
}

template std::unique_ptr<Scene<2>> make_scene<2>(const Deck&);
template std::unique_ptr<Scene<3>> make_scene<3>(const Deck&);
template void set_initial_velocities<2>(const Deck&, Scene<2>&);
template void set_initial_velocities<3>(const Deck&, Scene<3>&);

}  // namespace quern
