#include "contact/seed_rule.hpp"

#include <algorithm>

namespace quern {

namespace {

constexpr double at_wall = 1e-6;  ///< nodes this near to a wall are on it [h]

/// Velocity change of one constraint, split for the energy budget.
template <int Dim>
struct Change {
    Vec<Dim> normal = Vec<Dim>::Zero(), tangential = Vec<Dim>::Zero();
};

template <int Dim>
Change<Dim> obstruct(const Vec<Dim>& u, const Vec<Dim>& n, double mu) {
    Change<Dim> change;
    const double v_n = u.dot(n);
    if (!(v_n > 0.0)) return change;
    const Vec<Dim> v_t = u - v_n * n;
    const double size = v_t.norm();
    change.normal = -v_n * n;
    if (size > 0.0) change.tangential = -std::min(mu * v_n / size, 1.0) * v_t;
    return change;
}

}  // namespace

template <int Dim>
void apply_seed_rule(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                     std::vector<Vec<Dim>>& nodal, const std::vector<Vec<Dim>>& nodal_before,
                     ContactReport<Dim>& report) {
    const std::vector<Slot<Dim>>& slots = nodes.slots();
    const double h = nodes.grid().h();
    for (int a = 0; a < nodes.n_nodes(); ++a) {
        const std::span<const int> here = nodes.slots_of(a);
        Vec<Dim> momentum = Vec<Dim>::Zero();
        double mass = 0.0;
        for (const int s : here) {
            momentum += slots[s].m * nodal[s];
            mass += slots[s].m;
        }
        if (!(mass > 0.0)) continue;
        const Vec<Dim> v = momentum / mass;
        for (const int s : here) {
            const Slot<Dim>& slot = slots[s];
            const int material = scene.grains[slot.grain].material;
            const auto apply = [&](const Change<Dim>& change, const Vec<Dim>& v_frame) {
                const Vec<Dim> dv = change.normal + change.tangential;
                if (dv.squaredNorm() == 0.0) return Vec<Dim>(Vec<Dim>::Zero());
                const Vec<Dim> u = 0.5 * (nodal_before[s] + nodal[s] + dv) - v_frame;
                report.normal_work += slot.m * change.normal.dot(u);
                report.friction_work += slot.m * change.tangential.dot(u);
                nodal[s] += dv;
                report.grain_impulse[slot.grain] += slot.m * dv;
                ++report.n_contacts;
                return Vec<Dim>(slot.m * dv);
            };
            if (here.size() > 1 && slot.m > 0.0 && slot.m < mass && slot.gradient.squaredNorm() > 0.0) {
                double mu = 0.0;
                for (const int other : here)
                    if (other != s)
                        mu += slots[other].m *
                              (*scene.friction)(material, scene.grains[slots[other].grain].material);
                const Vec<Dim> n = -slot.gradient.normalized();
                apply(obstruct<Dim>(nodal[s] - v, n, mu / (mass - slot.m)), Vec<Dim>::Zero());
            }
            for (std::size_t w = 0; w < scene.walls.size() && slot.m > 0.0; ++w) {
                const Wall<Dim>& wall = scene.walls[w];
                const Vec<Dim> x = nodes.grid().node_position(slot.index);
                if (wall.distance(x) > at_wall * h) continue;
                const Vec<Dim> J = apply(obstruct<Dim>(nodal[s] - wall.velocity, -wall.normal, wall.friction),
                                         wall.velocity);
                report.wall_work += J.dot(wall.velocity);
                report.wall_impulse[w] -= J;
                report.wall_moment[w] -= moment(x, J);
            }
        }
    }
}

template void apply_seed_rule<2>(const ContactNodes<2>&, const ContactScene<2>&, std::vector<Vec<2>>&,
                                 const std::vector<Vec<2>>&, ContactReport<2>&);
template void apply_seed_rule<3>(const ContactNodes<3>&, const ContactScene<3>&, std::vector<Vec<3>>&,
                                 const std::vector<Vec<3>>&, ContactReport<3>&);

}  // namespace quern
