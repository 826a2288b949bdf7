#include "contact/node_pair_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quern {

namespace {

/// acos(z)/sqrt(1 - z^2), continued beyond 1.
double approach_time(double z) {
    if (std::abs(z - 1.0) < 1e-6) return 1.0;
    return z < 1.0 ? std::acos(z) / std::sqrt(1.0 - z * z) : std::acosh(z) / std::sqrt(z * z - 1.0);
}

/// p = 5 in space, 4 in the plane, but for the published rule.
bool in_space(int dimension, PairStiffness rule) {
    return dimension == 3 || rule == PairStiffness::published;
}

double coefficient(int dimension, PairStiffness rule) {
    if (rule == PairStiffness::layer) return 1.0;
    return (in_space(dimension, rule) ? 18.0 : 12.0) / std::numbers::pi;
}

}  // namespace

double approach_damping_ratio(double restitution) {
    if (restitution >= 1.0) return 0.0;
    double low = 0.0, high = 1.0;
    while (std::exp(-high * approach_time(high)) > restitution) high *= 2.0;
    for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
        const double z = 0.5 * (low + high);
        (std::exp(-z * approach_time(z)) > restitution ? low : high) = z;
    }
    return 0.5 * (low + high);
}

template <int Dim>
NodePairLaw<Dim>::NodePairLaw(std::span<const Grain<Dim>> grains, std::span<const double> volume,
                              std::vector<PairBody> bodies, const PairLaws& laws,
                              const NodePairOptions& options)
    : bodies_(std::move(bodies)), node_radius_(volume.size()), laws_(laws), options_(options) {
    least_distance_ = std::numeric_limits<double>::infinity();
    for (std::size_t g = 0; g < grains.size(); ++g) {
        const Grain<Dim>& grain = grains[g];
        const double spacing = grain.shape->dx * grain.scale;
        least_distance_ = std::min(least_distance_, bodies_[g].least_distance);
        std::fill_n(node_radius_.begin() + grain.first, grain.count, 0.5 * options.radius_factor * spacing);
        for (const SurfacePoint<Dim>& point : grain.shape->surface) {
            double& r = node_radius_[grain.first + point.node];
            r = std::max(r, point.delta * grain.scale);
        }
        Side side;
        side.material = grain.material;
        side.density = grain.mass / grain.volume;
        side.mass = grain.mass;
        side.spacing = spacing;
        side.size = grain.shape->radius * grain.scale;
        side.largest_volume =
            *std::max_element(volume.begin() + grain.first, volume.begin() + grain.first + grain.count);
        sides_.push_back(side);
    }
    if (options.radius == PairRadius::published)
        std::fill(node_radius_.begin(), node_radius_.end(), 0.5 * options.radius_factor * least_distance_);
    for (std::size_t g = 0; g < grains.size(); ++g) {
        const Grain<Dim>& grain = grains[g];
        Side& side = sides_[g];
        side.largest_radius = *std::max_element(node_radius_.begin() + grain.first,
                                                node_radius_.begin() + grain.first + grain.count);
        const auto found = std::find_if(threats_.begin(), threats_.end(), [&](const Threat& t) {
            return sides_[t.grain].material == side.material;
        });
        Threat& threat = found != threats_.end() ? *found : threats_.emplace_back();
        if (threat.grain < 0) threat.spacing = side.spacing;
        threat.grain = static_cast<int>(g);
        threat.spacing = std::min(threat.spacing, side.spacing);
        threat.radius = std::max(threat.radius, side.largest_radius);
        threat.volume = std::max(threat.volume, side.largest_volume);
        for (const PairStiffness rule :
             {PairStiffness::layer, PairStiffness::consistent, PairStiffness::published}) {
            double& push = threat.push[static_cast<std::size_t>(rule)];
            push = std::max(push, side.largest_volume * length_power(static_cast<int>(g), rule));
        }
    }
    for (const Side& side : sides_) n_materials_ = std::max(n_materials_, side.material + 1);
    damping_ratio_.assign(static_cast<std::size_t>(n_materials_ * n_materials_), 0.0);
    for (const Threat& a : threats_)
        for (const Threat& b : threats_) {
            const PairLaw& pair = law(a.grain, b.grain);
            const int place = sides_[a.grain].material * n_materials_ + sides_[b.grain].material;
            if (options.damping == PairDamping::nodes)
                damping_ratio_[static_cast<std::size_t>(place)] = approach_damping_ratio(pair.restitution);
            double radius = a.radius + b.radius;
            if (pair.radius_factor > 0.0) radius = pair.radius_factor * least_distance_;
            if (pair.radius > 0.0) radius = pair.radius;
            largest_radius_ = std::max(largest_radius_, radius);
        }
}

template <int Dim>
double NodePairLaw<Dim>::length_power(int grain, PairStiffness rule) const {
    const double l = rule == PairStiffness::layer ? sides_[grain].spacing : bodies_[grain].horizon;
    return in_space(Dim, rule) ? 1.0 / (l * l * std::sqrt(l)) : 1.0 / (l * l);
}

template <int Dim>
double NodePairLaw<Dim>::published_radius(int a, int b) const {
    const PairLaw& pair = law(a, b);
    if (pair.radius > 0.0) return pair.radius;
    return (pair.radius_factor > 0.0 ? pair.radius_factor : options_.radius_factor) * least_distance_;
}

template <int Dim>
double NodePairLaw<Dim>::centre_damping(int a, int b, double mass) const {
    const PairLaw& pair = law(a, b);
    const double log_e = std::log(pair.restitution), K_a = bodies_[a].bulk_modulus,
                 K_b = bodies_[b].bulk_modulus;
    return pair.damping_factor * -2.0 * log_e / std::hypot(std::numbers::pi, log_e) *
           std::sqrt(2.0 * K_a * K_b / (K_a + K_b) * published_radius(a, b) * mass);
}

template <int Dim>
double NodePairLaw<Dim>::stiffness(int a, int b) const {
    const PairLaw& pair = law(a, b);
    if (pair.rule == PairStiffness::given) return pair.stiffness;
    const bool published = pair.rule == PairStiffness::published;
    const double k_a = published ? bodies_[a].bulk_modulus : bodies_[a].modulus;
    const double k_b = published ? bodies_[b].bulk_modulus : bodies_[b].modulus;
    return coefficient(Dim, pair.rule) * 2.0 * k_a * k_b / (k_a + k_b) *
           (length_power(a, pair.rule) * length_power(b, pair.rule));
}

template <int Dim>
double NodePairLaw<Dim>::stable_step(int grain) const {
    constexpr double neighbors = Dim == 2 ? 6.0 : 12.0;  // of a grain among its equals
    const Side& side = sides_[grain];
    double squared = 0.0, damped = 0.0;
    for (const Threat& other : threats_) {
        const PairLaw& pair = law(grain, other.grain);
        const double R = pair.radius > 0.0          ? pair.radius
                         : pair.radius_factor > 0.0 ? pair.radius_factor * least_distance_
                                                    : side.largest_radius + other.radius;
        double n_springs = 0.0;
        for (double g = 0.75 * R; g < R; g += other.spacing)
            n_springs += power(std::floor(1.0 + 2.0 * std::sqrt(R * R - g * g) / other.spacing), Dim - 1);
        double push = stiffness(grain, other.grain);
        if (pair.rule == PairStiffness::given) {
            push *= other.volume;
        } else {
            push *= other.push[static_cast<std::size_t>(pair.rule)] / length_power(other.grain, pair.rule);
        }
        const double one = push / side.density;  // k_ij/m_i
        squared = std::max(squared, 2.0 * n_springs * one);
        const double z = std::max(damping_ratio(grain, other.grain),
                                  options_.tangential_damping * std::sqrt(tangential_ratio()));
        damped = std::max(damped, 4.0 * n_springs * z * std::sqrt(one));
        if (options_.damping == PairDamping::centres)
            damped =
                std::max(damped, 2.0 * neighbors * centre_damping(grain, other.grain, side.mass) / side.mass);
    }
    return step_with(grain, squared, damped);
}

template <int Dim>
double NodePairLaw<Dim>::step_with(int grain, double squared, double damped) const {
    const PairBody& body = bodies_[grain];
    const double inside = body.frequency * body.frequency, omega = std::sqrt(inside + squared);
    const double z = 0.5 * (body.bond_damping * inside + damped) / omega;
    return 2.0 / omega * (std::sqrt(1.0 + z * z) - z);
}

template class NodePairLaw<2>;
template class NodePairLaw<3>;

}  // namespace quern
