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

/// Goes once over nodes and grains and changes `nodal`; visit(node, slot, wall, change, v_frame) sees every
/// change before it is made, with wall = -1 for what other grains do.
template <int Dim, class Visit>
void go_through(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, std::vector<Vec<Dim>>& nodal,
                Visit&& visit) {
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
            const auto apply = [&](const Change<Dim>& change, const Vec<Dim>& v_frame, int wall) {
                const Vec<Dim> dv = change.normal + change.tangential;
                if (dv.squaredNorm() == 0.0) return;
                visit(a, s, wall, change, v_frame);
                nodal[s] += dv;
            };
            if (here.size() > 1 && slot.m > 0.0 && slot.m < mass && slot.gradient.squaredNorm() > 0.0) {
                double mu = 0.0;
                for (const int other : here)
                    if (other != s)
                        mu += slots[other].m *
                              (*scene.friction)(material, scene.grains[slots[other].grain].material);
                const Vec<Dim> n = -slot.gradient.normalized();
                apply(obstruct<Dim>(nodal[s] - v, n, mu / (mass - slot.m)), Vec<Dim>::Zero(), -1);
            }
            for (std::size_t w = 0; w < scene.walls.size() && slot.m > 0.0; ++w) {
                const Wall<Dim>& wall = scene.walls[w];
                const Vec<Dim> x = nodes.grid().node_position(slot.index);
                if (wall.distance(x) > at_wall * h) continue;
                apply(obstruct<Dim>(nodal[s] - wall.velocity, -wall.normal, wall.friction), wall.velocity,
                      static_cast<int>(w));
            }
        }
    }
}

}  // namespace

template <int Dim>
void apply_seed_rule(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                     std::vector<Vec<Dim>>& nodal, const std::vector<Vec<Dim>>& nodal_before,
                     ContactReport<Dim>& report) {
    go_through<Dim>(nodes, scene, nodal,
                    [&](int, int s, int w, const Change<Dim>& change, const Vec<Dim>& v_frame) {
                        const Slot<Dim>& slot = nodes.slots()[s];
                        const Vec<Dim> dv = change.normal + change.tangential, J = slot.m * dv;
                        const Vec<Dim> u = 0.5 * (nodal_before[s] + nodal[s] + dv) - v_frame;
                        report.normal_work += slot.m * change.normal.dot(u);
                        report.friction_work += slot.m * change.tangential.dot(u);
                        report.grain_impulse[slot.grain] += J;
                        ++report.n_contacts;
                        if (w < 0) return;
                        report.wall_work += J.dot(v_frame);
                        report.wall_impulse[w] -= J;
                        report.wall_moment[w] -= moment(nodes.grid().node_position(slot.index), J);
                    });
}

template <int Dim>
void list_seed_contacts(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                        const std::vector<Vec<Dim>>& nodal_trial, std::vector<ContactPoint<Dim>>& points) {
    const std::vector<Slot<Dim>>& slots = nodes.slots();
    std::vector<Vec<Dim>> nodal = nodal_trial, received(slots.size(), Vec<Dim>::Zero());
    const auto at = [&](const Slot<Dim>& slot) { return Vec<Dim>(nodes.grid().node_position(slot.index)); };
    go_through<Dim>(nodes, scene, nodal, [&](int, int s, int w, const Change<Dim>& change, const Vec<Dim>&) {
        const Slot<Dim>& slot = slots[s];
        const Vec<Dim> J = slot.m * (change.normal + change.tangential);
        if (w < 0) {
            received[s] += J;
            return;
        }
        const Wall<Dim>& wall = scene.walls[w];
        ContactPoint<Dim> point{slot.grain, -1 - w, at(slot), at(slot), -wall.normal, -J};
        point.slips = at_friction_limit<Dim>(point.impulse, point.normal, wall.friction);
        points.push_back(point);
    });
    for (int a = 0; a < nodes.n_nodes(); ++a) {
        const std::span<const int> here = nodes.slots_of(a);
        double mass = 0.0;
        for (const int s : here) mass += slots[s].m;
        for (std::size_t k = 0; k < here.size(); ++k)
            for (std::size_t l = k + 1; l < here.size(); ++l) {
                const Slot<Dim>&A = slots[here[k]], &B = slots[here[l]];
                const auto share = [&](const Slot<Dim>& of, const Slot<Dim>& other) {
                    return mass > of.m ? other.m / (mass - of.m) : 0.0;
                };
                const Vec<Dim> on_b = share(B, A) * received[here[l]], on_a = share(A, B) * received[here[k]];
                const Vec<Dim> outward = B.gradient.stableNormalized() - A.gradient.stableNormalized();
                ContactPoint<Dim> point{A.grain, B.grain,          at(A),
                                        at(B),   Vec<Dim>::Zero(), 0.5 * (on_b - on_a)};
                if (point.impulse.isZero(0.0) || outward.isZero(0.0)) continue;
                point.normal = outward.normalized();
                const double mu =
                    (*scene.friction)(scene.grains[A.grain].material, scene.grains[B.grain].material);
                point.slips = at_friction_limit<Dim>(point.impulse, point.normal, mu);
                points.push_back(point);
            }
    }
}

template void apply_seed_rule<2>(const ContactNodes<2>&, const ContactScene<2>&, std::vector<Vec<2>>&,
                                 const std::vector<Vec<2>>&, ContactReport<2>&);
template void apply_seed_rule<3>(const ContactNodes<3>&, const ContactScene<3>&, std::vector<Vec<3>>&,
                                 const std::vector<Vec<3>>&, ContactReport<3>&);
template void list_seed_contacts<2>(const ContactNodes<2>&, const ContactScene<2>&,
                                    const std::vector<Vec<2>>&, std::vector<ContactPoint<2>>&);
template void list_seed_contacts<3>(const ContactNodes<3>&, const ContactScene<3>&,
                                    const std::vector<Vec<3>>&, std::vector<ContactPoint<3>>&);

}  // namespace quern
