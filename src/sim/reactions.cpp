#include "src/sim/reactions.hpp"

#include <fmt/format.h>

#include <numeric>

namespace quern {

namespace {

template <int Dim>
void put(const Vec<Dim>& from, double (&to)[3]) {
    for (int a = 0; a < Dim; ++a) to[a] = from[a];
}

/// Centre of mass of particles at the places `x`.
template <int Dim>
Vec<Dim> centre(const Scene<Dim>& scene, const std::vector<Vec<Dim>>& x, const std::vector<int>& particles) {
    Vec<Dim> sum = Vec<Dim>::Zero();
    double mass = 0.0;
    for (const int p : particles) {
        sum += scene.particles.mass[p] * x[p];
        mass += scene.particles.mass[p];
    }
    return sum / mass;
}

template <int Dim>
ReactionRow row_of(std::string name, const Scene<Dim>& scene, const std::vector<int>& particles) {
    ReactionRow row;
    row.name = std::move(name);
    const Vec<Dim> here = centre(scene, scene.particles.x, particles);
    put<Dim>(here, row.position);
    put<Dim>(here - centre(scene, scene.x_start, particles), row.displacement);
    return row;
}

/// Places and names.
template <int Dim>
std::vector<ReactionRow> places(const Deck& deck, const Scene<Dim>& scene) {
    std::vector<ReactionRow> rows;
    for (std::size_t w = 0; w < scene.walls.size(); ++w) {
        ReactionRow row;
        row.name = deck.walls[w].name;
        put<Dim>(scene.walls[w].point, row.position);
        for (int a = 0; a < Dim; ++a) row.displacement[a] = row.position[a] - deck.walls[w].point[a];
        rows.push_back(row);
    }
    for (const Constraint<Dim>& constraint : scene.constraints)
        rows.push_back(row_of(fmt::format("constraints[{}]", rows.size() - scene.walls.size()), scene,
                              constraint.particles));
    for (const int g : scene.held_walls) {
        std::vector<int> particles(static_cast<std::size_t>(scene.grains[g].count));
        std::iota(particles.begin(), particles.end(), scene.grains[g].first);
        rows.push_back(row_of(fmt::format("grains[{}]", scene.grains[g].id), scene, particles));
    }
    return rows;
}

}  // namespace

template <int Dim>
std::vector<ReactionRow> reaction_rows(const Deck& deck, const Scene<Dim>& scene, StepContext<Dim>& now,
                                       double elapsed) {
    std::vector<ReactionRow> rows = places(deck, scene);
    const double per_time = elapsed > 0.0 ? 1.0 / elapsed : 0.0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        Reaction<Dim>& reaction = now.reactions[r];
        rows[r].time = now.time;
        put<Dim>(per_time * reaction.impulse, rows[r].force);
        for (int k = 0; k < Spin<Dim>::RowsAtCompileTime; ++k)
            rows[r].moment[Dim == 2 ? 2 : k] = per_time * reaction.moment[k];
        rows[r].work = reaction.work + now.part_done() * reaction.work_now;
        reaction.impulse.setZero();
        reaction.moment.setZero();
    }
    return rows;
}

template std::vector<ReactionRow> reaction_rows<2>(const Deck&, const Scene<2>&, StepContext<2>&, double);
template std::vector<ReactionRow> reaction_rows<3>(const Deck&, const Scene<3>&, StepContext<3>&, double);

}  // namespace quern
