#include "src/import/peridem_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "grid/error.hpp"
#include "src/mesh/mesh_file.hpp"

namespace quern {
namespace {

/// Nodes sorted along x: only those nearer along x than the least distance so far are compared.
double least_distance(std::vector<Numbers3> X) {
    std::sort(X.begin(), X.end());
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < X.size(); ++i)
        for (std::size_t j = i + 1; j < X.size() && X[j][0] - X[i][0] < least; ++j)
            least = std::min(least, std::hypot(X[j][0] - X[i][0], X[j][1] - X[i][1], X[j][2] - X[i][2]));
    return least;
}

template <int Dim>
PeridemMesh read_mesh(const PeridemZone& zone) {
    const ElementMesh<Dim> elements = read_mesh_file<Dim>(zone.mesh, 1.0, zone.mesh_where);
    if (const std::optional<MeshDefect> defect = find_mesh_defect<Dim>(elements))
        throw InputError(zone.mesh_where, fmt::format("{} in '{}'", defect->got, zone.mesh), defect->expected,
                         defect->hint);
    const std::vector<double> volume = make_lumped_volumes<Dim>(elements);
    PeridemMesh mesh;
    Vec<Dim> moment = Vec<Dim>::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < elements.X.size(); ++i) {
        moment += volume[i] * elements.X[i];
        total += volume[i];
        Numbers3 X{};
        for (int a = 0; a < Dim; ++a) X[static_cast<std::size_t>(a)] = elements.X[i][a];
        mesh.X.push_back(X);
    }
    for (int a = 0; a < Dim; ++a) mesh.centre[static_cast<std::size_t>(a)] = moment[a] / total;
    mesh.spacing = std::pow(total / static_cast<double>(mesh.X.size()), 1.0 / Dim);
    mesh.least = least_distance(mesh.X);
    return mesh;
}

std::vector<PeridemMesh> read_meshes(const PeridemDeck& deck) {
    std::map<std::string, PeridemMesh> known;
    std::vector<PeridemMesh> meshes;
    for (const PeridemZone& zone : deck.zones) {
        const auto [mesh, is_new] = known.try_emplace(zone.mesh);
        if (is_new) mesh->second = deck.dimension == 2 ? read_mesh<2>(zone) : read_mesh<3>(zone);
        meshes.push_back(mesh->second);
    }
    return meshes;
}

void check_body(int id, std::size_t n, const std::string& where) {
    if (id >= 0 && static_cast<std::size_t>(id) < n) return;
    throw InputError(
        where, fmt::format("body {}", id),
        n == 0 ? std::string("no body: there is none") : fmt::format("a number from 0 to {}", n - 1));
}

int body_of(int id, bool wall, const PeridemBodies& bodies, const std::string& where) {
    check_body(id, wall ? bodies.walls.size() : bodies.bodies.size(), where);
    return wall ? bodies.walls[static_cast<std::size_t>(id)] : id;
}

/// Radius over that of the mesh, without the last digit: 0.943, not 0.9430000000000001.
double scale_of(const PeridemGrain& grain, const PeridemZone& zone) {
    return std::stod(fmt::format("{:.15g}", grain.radius / zone.radius));
}

}  // namespace

Numbers3 PeridemBody::at(const Numbers3& X) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return {place[0] + scale * (c * X[0] - s * X[1]), place[1] + scale * (s * X[0] + c * X[1]),
            place[2] + scale * X[2]};
}

PeridemBodies make_peridem_bodies(const PeridemDeck& deck, ImportNotes& notes) {
    PeridemBodies result;
    result.meshes = read_meshes(deck);
    std::vector<PeridemGrain> grains;
    const bool needs_table = std::any_of(deck.zones.begin(), deck.zones.end(),
                                         [](const PeridemZone& zone) { return !zone.as_meshed; });
    if (needs_table && deck.particles.empty())
        throw InputError(deck.file, "no Particle_Generation", "From_File: where the grains are");
    if (needs_table) grains = read_peridem_grains(deck, notes);
    std::vector<int> order;
    for (int z = 0; z < static_cast<int>(deck.zones.size()); ++z) order.push_back(z);
    if (deck.walls_apart)
        std::stable_partition(order.begin(), order.end(),
                              [&](int z) { return !deck.zones[static_cast<std::size_t>(z)].wall; });
    for (const int z : order) {
        const PeridemZone& zone = deck.zones[static_cast<std::size_t>(z)];
        const auto add = [&](PeridemBody body) {
            body.centre = body.at(result.meshes[static_cast<std::size_t>(z)].centre);
            if (zone.wall) result.walls.push_back(static_cast<int>(result.bodies.size()));
            result.bodies.push_back(body);
        };
        if (zone.as_meshed) add({.zone = z});
        for (const PeridemGrain& grain : grains)
            if (grain.zone == z)
                add({.zone = z,
                     .scale = scale_of(grain, zone),
                     .place = grain.centre,
                     .angle = grain.angle,
                     .in_table = true});
    }
    for (const int id : deck.moving) {
        check_body(id, result.bodies.size(), deck.moving_where);
        result.bodies[static_cast<std::size_t>(id)].velocity = deck.velocity;
    }
    if (deck.watched)
        result.watched = body_of(*deck.watched, deck.watched_is_wall, result, deck.watched_where);
    return result;
}

std::vector<int> bodies_of(const PeridemSet& set, const PeridemBodies& bodies) {
    std::vector<int> all;
    if (set.bodies)
        for (const int id : *set.bodies) all.push_back(body_of(id, set.walls_only, bodies, set.where));
    if (!set.bodies && set.excluded.empty()) return all;
    if (!set.bodies)
        for (int id = 0; id < static_cast<int>(bodies.bodies.size()); ++id) all.push_back(id);
    std::erase_if(all, [&](int id) {
        return std::find(set.excluded.begin(), set.excluded.end(), id) != set.excluded.end();
    });
    if (all.empty()) throw InputError(set.where, "a set without bodies", "at least one body");
    return all;
}

double least_distance(const PeridemBodies& bodies) {
    double least = std::numeric_limits<double>::infinity();
    for (const PeridemBody& body : bodies.bodies)
        least = std::min(least, body.scale * bodies.meshes[static_cast<std::size_t>(body.zone)].least);
    return least;
}

}  // namespace quern
