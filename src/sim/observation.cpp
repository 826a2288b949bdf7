#include "src/sim/observation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/observe/contact_network.hpp"
#include "src/observe/force_distribution.hpp"
#include "src/observe/grain_stress.hpp"
#include "src/sim/observe.hpp"
#include "src/sim/observed_region.hpp"

namespace quern {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A mean over nothing is no number.
double over(double sum, double n) {
    return n > 0.0 ? sum / n : none;
}

/// A grain as placed in the deck.
template <int Dim>
struct SeenGrain {
    int position = 0;  ///< in Scene::grains
    GrainMotion<Dim> motion;
    double volume = 0.0;
    Mat<Dim> by_contacts = Mat<Dim>::Zero();
    std::array<double, 6> by_particles{};  ///< as in Frame::stress
};

/// All that tables are made of.
template <int Dim>
struct Seen {
    std::vector<SeenGrain<Dim>> grains;  ///< [n_grains] in the deck's order
    std::vector<std::uint8_t> wall;      ///< [n_grains] stands for a wall
    std::vector<ContactPoint<Dim>> points;
    std::vector<PairForce<Dim>> pairs;
    Coordination coordination;

    bool of_two_grains(const PairForce<Dim>& pair) const {
        return pair.second >= 0 && !wall[static_cast<std::size_t>(pair.first)] &&
               !wall[static_cast<std::size_t>(pair.second)];
    }
};

template <int Dim>
constexpr int n_components = Dim == 2 ? 4 : 6;

template <int Dim>
Seen<Dim> look(const Scene<Dim>& scene, const StepContext<Dim>& now, const Frame& frame) {
    Seen<Dim> seen;
    seen.points = now.contact_list;
    for (ContactPoint<Dim>& point : seen.points) {
        point.first = scene.grains[point.first].id;
        if (point.second >= 0) point.second = scene.grains[point.second].id;
    }
    seen.pairs = pair_forces<Dim>(seen.points, now.kick_time(), scene.grid.extent());
    std::vector<Vec<Dim>> centres;
    std::vector<double> volumes;
    for (const int g : scene.grain_of_id) {
        Grain<Dim> grain = scene.grains[g];
        SeenGrain<Dim> of;
        of.position = g;
        of.volume = grain.volume;
        for (int p = grain.first; p < grain.first + grain.count; ++p)
            for (int c = 0; c < n_components<Dim>; ++c)
                of.by_particles[c] += scene.particles.volume[p] / grain.volume *
                                      frame.stress[static_cast<std::size_t>(p * n_components<Dim> + c)];
        const Particles<Dim> particles = particles_now(scene, now, grain);
        seen.wall.push_back(grain.wall);
        grain.first = 0;
        of.motion = grain_motion(grain, particles);
        centres.push_back(of.motion.centre);
        volumes.push_back(of.volume);
        seen.grains.push_back(of);
    }
    const std::vector<Mat<Dim>> stress = contact_stress<Dim>(seen.points, now.kick_time(), centres, volumes);
    for (std::size_t g = 0; g < stress.size(); ++g) seen.grains[g].by_contacts = stress[g];
    seen.coordination = coordination<Dim>(seen.pairs, seen.wall);
    return seen;
}

template <int Dim>
void put(TableRows& rows, const Vec<Dim>& vector) {
    rows.insert(rows.end(), vector.data(), vector.data() + Dim);
}
void put(TableRows& rows, const Spin<2>& spin) {
    rows.push_back(spin[0]);
}
/// xx, yy, xy or xx, yy, zz, xy, yz, xz.
void put(TableRows& rows, const Mat<2>& tensor) {
    rows.insert(rows.end(), {tensor(0, 0), tensor(1, 1), tensor(0, 1)});
}
void put(TableRows& rows, const Mat<3>& t) {
    rows.insert(rows.end(), {t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(1, 2), t(0, 2)});
}

template <int Dim>
TableRows contact_rows(const Seen<Dim>& seen, double time) {
    TableRows rows;
    for (const PairForce<Dim>& pair : seen.pairs) {
        Vec<Dim> branch = pair.at_first - seen.grains[static_cast<std::size_t>(pair.first)].motion.centre;
        if (pair.second >= 0)
            branch += seen.grains[static_cast<std::size_t>(pair.second)].motion.centre - pair.at_second;
        rows.insert(rows.end(), {time, static_cast<double>(pair.first),
                                 pair.second >= 0 ? static_cast<double>(pair.second) : -1.0,
                                 pair.second >= 0 ? -1.0 : static_cast<double>(-1 - pair.second)});
        put<Dim>(rows, pair.at_first);
        put<Dim>(rows, pair.normal);
        rows.push_back(pair.normal_force);
        put<Dim>(rows, pair.tangential_force);
        put<Dim>(rows, branch);
        rows.insert(rows.end(), {pair.slipping, static_cast<double>(pair.n_points)});
    }
    return rows;
}

template <int Dim>
TableRows grain_rows(const Seen<Dim>& seen, double time) {
    TableRows rows;
    for (std::size_t g = 0; g < seen.grains.size(); ++g) {
        const SeenGrain<Dim>& grain = seen.grains[g];
        rows.insert(rows.end(), {time, static_cast<double>(g)});
        put<Dim>(rows, grain.motion.centre);
        put<Dim>(rows, grain.motion.velocity);
        put(rows, grain.motion.omega);
        rows.insert(rows.end(), {grain.volume, static_cast<double>(seen.coordination.pairs[g]),
                                 static_cast<double>(seen.coordination.rattler[g])});
        put(rows, grain.by_contacts);
        rows.insert(rows.end(), grain.by_particles.begin(), grain.by_particles.begin() + n_components<Dim>);
        rows.push_back(-grain.by_contacts.trace() / Dim);
        rows.push_back(principal(grain.by_contacts).difference());
    }
    return rows;
}

/// A row of `regions`, and of `forces` one a bin.
template <int Dim>
void add_region(const Deck& deck, const Scene<Dim>& scene, const Seen<Dim>& seen, double time,
                std::size_t number, TableRows& regions, TableRows& forces) {
    const ObserveRegion* from_deck = number == 0 ? nullptr : &deck.observe.regions[number - 1];
    const ObservedRegion<Dim> region(scene, from_deck, time);
    double solid = 0.0, pairs = 0.0, pairs_held = 0.0, n_grains = 0.0, n_held = 0.0;
    Mat<Dim> stress = Mat<Dim>::Zero();
    std::array<double, 6> by_particles{};
    std::vector<double> loads;
    for (std::size_t g = 0; g < seen.grains.size(); ++g) {
        if (seen.wall[g]) continue;
        const SeenGrain<Dim>& grain = seen.grains[g];
        const Grain<Dim>& of = scene.grains[grain.position];
        double inside = 0.0;
        for (int p = of.first; p < of.first + of.count; ++p)
            inside +=
                scene.particles.volume[p] * region.part(scene.particles.x[p], scene.particles.volume[p]);
        solid += inside;
        stress += inside * grain.by_contacts;
        for (int c = 0; c < n_components<Dim>; ++c) by_particles[c] += inside * grain.by_particles[c];
        if (!region.contains(grain.motion.centre)) continue;
        ++n_grains;
        pairs += seen.coordination.pairs[g];
        loads.push_back(-grain.by_contacts.trace() * grain.volume);
        if (seen.coordination.rattler[g]) continue;
        ++n_held;
        pairs_held += seen.coordination.pairs_held[g];
    }
    std::vector<PairForce<Dim>> inside;
    std::vector<double> normal_forces;
    double slipping = 0.0;
    for (const PairForce<Dim>& pair : seen.pairs) {
        if (!seen.of_two_grains(pair) || !(pair.normal_force > 0.0) || !region.contains(pair.at_first))
            continue;
        inside.push_back(pair);
        normal_forces.push_back(pair.normal_force);
        slipping += pair.slipping > 0.5;
    }
    const double V = region.volume(), n_pairs = static_cast<double>(inside.size());
    stress /= V;
    const Mat<Dim> R = fabric<Dim>(inside);
    const Principal pressed = principal(Mat<Dim>(-stress)), along = principal(R);
    const ForceDistribution distribution = force_distribution(normal_forces, deck.observe.force_bin);
    regions.insert(regions.end(),
                   {time, static_cast<double>(number), V, solid, solid / V, n_grains, n_grains - n_held,
                    n_pairs, over(pairs, n_grains), over(pairs_held, n_held)});
    put(regions, stress);
    for (int c = 0; c < n_components<Dim>; ++c) regions.push_back(by_particles[c] / V);
    regions.insert(regions.end(), {-stress.trace() / Dim, pressed.difference()});
    if (Dim == 2) regions.push_back(pressed.angle);
    put(regions, R);
    regions.push_back(along.difference());
    if (Dim == 2) regions.push_back(along.angle);
    regions.insert(regions.end(),
                   {n_pairs > 0.0 ? distribution.mean : none, over(slipping, n_pairs),
                    part_with_half_the_load(loads), distribution.n_tail > 0 ? distribution.slope : none,
                    distribution.n_tail > 0 ? distribution.slope_error : none,
                    static_cast<double>(distribution.n_tail)});
    for (std::size_t k = 0; k < distribution.counts.size(); ++k)
        forces.insert(forces.end(),
                      {time, static_cast<double>(number), static_cast<double>(k) * distribution.width,
                       static_cast<double>(k + 1) * distribution.width,
                       static_cast<double>(distribution.counts[k]), distribution.density[k]});
}

template <int Dim>
struct Slice {
    double volume = 0.0;
    Vec<Dim> velocity = Vec<Dim>::Zero(), way = Vec<Dim>::Zero();
    Spin<Dim> omega = Spin<Dim>::Zero();
};

template <int Dim>
void add_profile(const ObserveProfile& profile, std::size_t number, const Scene<Dim>& scene,
                 const StepContext<Dim>& now, const Seen<Dim>& seen, TableRows& rows) {
    const ObservedBox<Dim> box = box_between_walls(scene);
    const int axis = static_cast<int>(profile.axis);
    const double low = scene.grid.origin()[axis], extent = scene.grid.extent()[axis];
    const bool repeats = scene.grid.periodic(axis);
    Slices slices{profile.from.value_or(box.low[axis]), profile.to.value_or(box.high[axis]), profile.bins};
    slices.periodic = repeats && !profile.from && !profile.to;
    std::vector<Slice<Dim>> sums(static_cast<std::size_t>(profile.bins));
    std::vector<SlicePart> parts;
    for (std::size_t g = 0; g < seen.grains.size(); ++g) {
        if (seen.wall[g]) continue;
        const SeenGrain<Dim>& seen_grain = seen.grains[g];
        const Grain<Dim>& grain = scene.grains[seen_grain.position];
        const Particles<Dim> particles = particles_now(scene, now, grain);
        for (int i = 0; i < grain.count; ++i) {
            const int p = grain.first + i;
            double x = particles.x[i][axis];
            if (repeats) x -= extent * std::floor((x - low) / extent);
            const double V = scene.particles.volume[p];
            split(slices, x, std::pow(V, 1.0 / Dim), parts);
            for (const SlicePart& part : parts) {
                Slice<Dim>& sum = sums[static_cast<std::size_t>(part.slice)];
                const double share = part.part * V;
                sum.volume += share;
                sum.velocity += share * particles.v[i];
                sum.way += share * (particles.x[i] - scene.x_start[p]);
                sum.omega += share * seen_grain.motion.omega;
            }
        }
    }
    const double face = (box.high - box.low).prod() / (box.high[axis] - box.low[axis]);
    for (int k = 0; k < profile.bins; ++k) {
        const Slice<Dim>& sum = sums[static_cast<std::size_t>(k)];
        const double per_volume = sum.volume > 0.0 ? 1.0 / sum.volume : none;
        rows.insert(rows.end(),
                    {now.time, static_cast<double>(number), slices.from + k * slices.width(),
                     slices.from + (k + 1) * slices.width(), sum.volume / (face * slices.width())});
        put<Dim>(rows, per_volume * sum.velocity);
        put(rows, Spin<Dim>(per_volume * sum.omega));
        put<Dim>(rows, per_volume * sum.way);
    }
}

/// Columns with one number an axis: "v" makes vx, vy and, in 3D, vz.
void add_axes(TableLayout& table, int dimension, const std::string& prefix, const char* unit) {
    for (int a = 0; a < dimension; ++a) table.columns.push_back({prefix + "xyz"[a], unit});
}
/// Of rotation: one about z in 2D.
void add_spin(TableLayout& table, int dimension) {
    if (dimension == 2)
        table.columns.push_back({"omega", "rad/s"});
    else
        add_axes(table, dimension, "omega_", "rad/s");
}
void add_tensor(TableLayout& table, int dimension, const std::string& name, const char* unit, bool with_zz) {
    for (const char* component : {"xx", "yy", "zz", "xy", "yz", "xz"})
        if (dimension == 3 || (component[0] != 'z' && component[1] != 'z'))
            table.columns.push_back({name + "_" + component, unit});
    if (dimension == 2 && with_zz) table.columns.push_back({name + "_zz", unit});
}
void add_columns(TableLayout& table, std::initializer_list<TableColumn> columns) {
    table.columns.insert(table.columns.end(), columns);
}

}  // namespace

std::vector<TableLayout> observed_layouts(const Deck& deck) {
    const int d = deck.dimension;
    const char *force = d == 2 ? "N/m" : "N", *volume = d == 2 ? "m^2" : "m^3";
    std::vector<std::string> walls, region_names = {"all"}, profile_names;
    for (const WallDeck& wall : deck.walls) walls.push_back(wall.name);
    for (const ObserveRegion& region : deck.observe.regions) region_names.push_back(region.name);
    for (const ObserveProfile& profile : deck.observe.profiles) profile_names.push_back(profile.name);
    if (walls.empty()) walls.push_back("none");
    if (profile_names.empty()) profile_names.push_back("none");

    TableLayout contacts{"contacts", {{"time", "s"}, {"first", "1"}, {"second", "1"}, {"wall", "1", walls}}};
    add_axes(contacts, d, "", "m");
    add_axes(contacts, d, "n", "1");
    add_columns(contacts, {{"fn", force}});
    add_axes(contacts, d, "ft", force);
    add_axes(contacts, d, "l", "m");
    add_columns(contacts, {{"slipping", "1"}, {"points", "1"}});

    TableLayout grains{"grain_stress", {{"time", "s"}, {"grain", "1"}}};
    add_axes(grains, d, "", "m");
    add_axes(grains, d, "v", "m/s");
    add_spin(grains, d);
    add_columns(grains, {{"volume", volume}, {"contacts", "1"}, {"rattler", "1"}});
    add_tensor(grains, d, "stress", "Pa", false);
    add_tensor(grains, d, "particle_stress", "Pa", true);
    add_columns(grains, {{"pressure", "Pa"}, {"principal_difference", "Pa"}});

    TableLayout regions{"regions",
                        {{"time", "s"},
                         {"region", "1", region_names},
                         {"volume", volume},
                         {"solid_volume", volume},
                         {"solid_fraction", "1"},
                         {"grains", "1"},
                         {"rattlers", "1"},
                         {"contacts", "1"},
                         {"coordination", "1"},
                         {"coordination_held", "1"}}};
    add_tensor(regions, d, "stress", "Pa", false);
    add_tensor(regions, d, "particle_stress", "Pa", true);
    add_columns(regions, {{"pressure", "Pa"}, {"principal_difference", "Pa"}});
    if (d == 2) add_columns(regions, {{"pressed_along", "rad"}});
    add_tensor(regions, d, "fabric", "1", false);
    add_columns(regions, {{"fabric_difference", "1"}});
    if (d == 2) add_columns(regions, {{"fabric_along", "rad"}});
    add_columns(regions, {{"mean_force", force},
                          {"slipping", "1"},
                          {"half_load", "1"},
                          {"tail_slope", "1"},
                          {"tail_error", "1"},
                          {"tail_contacts", "1"}});

    TableLayout profiles{"profiles",
                         {{"time", "s"},
                          {"profile", "1", profile_names},
                          {"from", "m"},
                          {"to", "m"},
                          {"solid_fraction", "1"}}};
    add_axes(profiles, d, "v", "m/s");
    add_spin(profiles, d);
    add_axes(profiles, d, "u", "m");

    TableLayout forces{"forces",
                       {{"time", "s"},
                        {"region", "1", region_names},
                        {"from", "1"},
                        {"to", "1"},
                        {"count", "1"},
                        {"density", "1"}}};
    return {contacts, grains, regions, profiles, forces};
}

template <int Dim>
std::vector<TableRows> observe(const Deck& deck, const Scene<Dim>& scene, const StepContext<Dim>& now,
                               const Frame& frame) {
    const Seen<Dim> seen = look(scene, now, frame);
    TableRows regions, profiles, forces;
    for (std::size_t k = 0; k <= deck.observe.regions.size(); ++k)
        add_region(deck, scene, seen, now.time, k, regions, forces);
    for (std::size_t k = 0; k < deck.observe.profiles.size(); ++k)
        add_profile(deck.observe.profiles[k], k, scene, now, seen, profiles);
    return {contact_rows(seen, now.time), grain_rows(seen, now.time), regions, profiles, forces};
}

template std::vector<TableRows> observe<2>(const Deck&, const Scene<2>&, const StepContext<2>&, const Frame&);
template std::vector<TableRows> observe<3>(const Deck&, const Scene<3>&, const StepContext<3>&, const Frame&);

}  // namespace quern
