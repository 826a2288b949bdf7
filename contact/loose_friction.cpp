#include "contact/loose_friction.hpp"

#include <algorithm>

namespace quern {

namespace {

/// Unit vectors across n.
std::array<Vec<2>, 1> across(const Vec<2>& n) {
    return {Vec<2>(-n[1], n[0])};
}
std::array<Vec<3>, 2> across(const Vec<3>& n) {
    const Vec<3> t = n.unitOrthogonal();
    return {t, Vec<3>(n.cross(t))};
}

}  // namespace

template <int Dim>
const NodePatches<Dim>& LooseFriction<Dim>::patches_of(const Shape<Dim>& shape) {
    for (const auto& [known, patches] : patches_)
        if (known == &shape) return *patches;
    patches_.emplace_back(&shape, std::make_unique<NodePatches<Dim>>(shape));
    return *patches_.back().second;
}

template <int Dim>
void LooseFriction<Dim>::search(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                                std::span<const CrackPair> pairs) {
    patch_of_.assign(scene.x.size(), -1);
    first_.assign(1, 0);
    members_.clear();
    if (!scene.friction->any()) return;
    const auto list = [&](int p) {
        if (patch_of_[p] >= 0) return;
        const int body = bodies.body_of(p);
        for (const int node : patches_of(*bodies.owner(body).shape).of(bodies.node_at(p))) {
            const int k = bodies.place_of(body, node);
            if (bodies.body_of(k) == body) members_.push_back(k);
        }
        std::sort(members_.begin() + first_.back(), members_.end());
        patch_of_[p] = static_cast<int>(first_.size()) - 1;
        first_.push_back(static_cast<int>(members_.size()));
    };
    for (const CrackPair& pair : pairs) {
        list(pair.first);
        list(pair.second);
    }
}

template <int Dim>
typename LooseFriction<Dim>::Side LooseFriction<Dim>::side(const ContactBodies<Dim>& bodies,
                                                           const ContactScene<Dim>& scene, int p) const {
    Side side;
    side.particle = p;
    side.owner = &bodies.owner(bodies.body_of(p));
    const std::size_t k = static_cast<std::size_t>(patch_of_[p]);
    side.patch = {members_.data() + first_[k], members_.data() + first_[k + 1]};
    side.motion = patch_motion<Dim>(*side.owner, side.patch, p, scene.x, scene.x, scene.mass);
    side.turns = !side.motion.inverse.isZero(0.0);
    return side;
}

template <int Dim>
int LooseFriction<Dim>::add(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene, int p, int q,
                            const Vec<Dim>& d, double radius_p, double radius_q) {
    Rub rub;
    rub.friction =
        (*scene.friction)(bodies.owner(bodies.body_of(p)).material, bodies.owner(bodies.body_of(q)).material);
    if (!(rub.friction > 0.0)) return -1;
    rub.p = side(bodies, scene, p);
    rub.q = side(bodies, scene, q);
    if (!rub.p.turns && !rub.q.turns) return -1;
    const double part = !rub.p.turns ? 0.0 : !rub.q.turns ? 1.0 : radius_p / (radius_p + radius_q);
    rub.p.lever = part * d;
    rub.q.lever = (part - 1.0) * d;
    for (const Side* side : {&rub.p, &rub.q}) {
        const Vec<Dim> r = scene.x[side->particle] - side->motion.centre;
        for (const Vec<Dim>& t : across(Vec<Dim>(d.normalized()))) {
            const Spin<Dim> tau = moment(side->lever, t), turn = side->motion.inverse * tau;
            rub.W += 1.0 / scene.mass[side->particle] + 2.0 * turn.dot(moment(r, t)) + turn.dot(tau);
        }
    }
    rubs_.push_back(rub);
    return static_cast<int>(rubs_.size()) - 1;
}

template <int Dim>
Vec<Dim> LooseFriction<Dim>::slip(int number, const ContactScene<Dim>& scene,
                                  std::span<const Vec<Dim>> v) const {
    const auto velocity = [&](const Side& side) {
        Vec<Dim> u = v[side.particle];
        if (side.turns)
            u += cross(
                patch_spin<Dim>(side.motion, *side.owner, side.patch, side.particle, scene.x, v, scene.mass),
                side.lever);
        return u;
    };
    return velocity(rubs_[number].p) - velocity(rubs_[number].q);
}

template <int Dim>
void LooseFriction<Dim>::push(int number, const ContactScene<Dim>& scene, const Vec<Dim>& J,
                              std::span<Vec<Dim>> v) const {
    const auto give = [&](const Side& side, const Vec<Dim>& impulse) {
        v[side.particle] += impulse / scene.mass[side.particle];
        if (side.turns)
            turn_patch<Dim>(side.motion, moment(side.lever, impulse), *side.owner, side.patch, side.particle,
                            scene.x, v);
    };
    give(rubs_[number].p, -J);
    give(rubs_[number].q, J);
}

template class LooseFriction<2>;
template class LooseFriction<3>;

}  // namespace quern
