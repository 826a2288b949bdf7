#include "particles/material_points.hpp"

#include <algorithm>
#include <cmath>

#include "grid/parallel.hpp"
#include "particles/point_loops.hpp"
#include "particles/stable_step.hpp"

namespace quern {

namespace {

constexpr double rigid_weight = 1e6;  ///< of points that are led, over their mass

/// Points p of a grain in an array of all particles.
template <class T>
std::span<const T> part(const std::vector<T>& all, std::size_t first, std::size_t count) {
    return std::span(all).subspan(first, count);
}

template <int Dim>
Mat<Dim> linear_stress(const Mat<Dim>& gradient, const VonMises& law) {
    const Mat<Dim> strain = 0.5 * (gradient + gradient.transpose());
    const double mean = strain.trace() / 3.0;
    return (law.bulk_modulus * 3.0 * mean - 2.0 * law.shear_modulus * mean) * Mat<Dim>::Identity() +
           2.0 * law.shear_modulus * strain;
}

}  // namespace

template <int Dim>
MaterialPoints<Dim>::MaterialPoints(const CartesianGrid<Dim>& grid, const PointOptions& options,
                                    bool one_field)
    : grid_(grid), options_(options), one_field_(one_field) {
    if (options.functions == PointFunctions::linear) fields_.template emplace<0>();
    if (options.functions == PointFunctions::gimp) fields_.template emplace<1>();
    if (options.functions == PointFunctions::quadratic) fields_.template emplace<2>();
}

template <int Dim>
void MaterialPoints<Dim>::add_grain(const Grain<Dim>& grain, std::span<const double> volume,
                                    const VonMises& law) {
    const Range range{static_cast<std::size_t>(grain.first), static_cast<std::size_t>(grain.count),
                      states_.size()};
    grain_of_.insert(grain_of_.end(), range.count, static_cast<std::uint32_t>(grains_.size()));
    grains_.push_back({range, law});
    if (one_field_ && !bodies_.empty())
        bodies_.front().count += range.count;
    else {
        bodies_.push_back(range);
        std::visit([](auto& fields) { fields.emplace_back(); }, fields_);
    }
    states_.resize(states_.size() + volume.size());
    for (const double V : volume) half_.push_back(0.5 * std::pow(V, 1.0 / Dim) / grid_.h());
}

template <int Dim>
void MaterialPoints<Dim>::make_rigid(const Particles<Dim>& particles, int k) {
    Member& grain = grains_[k];
    grain.rigid = true;
    if (weights_.empty())
        weights_.assign(particles.mass.begin() + static_cast<std::ptrdiff_t>(first_point()),
                        particles.mass.end());
    for (std::size_t p = 0; p < grain.count; ++p) weights_[grain.state + p] *= rigid_weight;
}

template <int Dim>
std::span<const double> MaterialPoints<Dim>::weights(const Particles<Dim>& particles,
                                                     const Range& body) const {
    return weights_.empty() ? part(particles.mass, body.first, body.count)
                            : part(weights_, body.state, body.count);
}

template <int Dim>
void MaterialPoints<Dim>::compute_forces(const Particles<Dim>& particles, std::vector<Vec<Dim>>& f) {
    const auto of_body = [&](const Range& body, auto& field) {
        const std::span<const double> mass = weights(particles, body);
        field.place(grid_, part(particles.x, body.first, body.count), part(half_, body.state, body.count),
                    mass, one_field_);
        field.scatter_forces(
            mass, part(particles.volume, body.first, body.count), options_.order, [&](std::size_t p) {
                return to_matrix<Dim>(
                    kirchhoff_stress<Dim>(states_[body.state + p], grain_at(body.state + p).law));
            });
        field.gather_forces(mass, std::span(f).subspan(body.first, body.count));
    };
    std::visit(
        [&](auto& fields) {
            parallel::for_each(bodies_.size(), [&](std::size_t k) { of_body(bodies_[k], fields[k]); });
        },
        fields_);
}

template <int Dim>
void MaterialPoints<Dim>::project(const Particles<Dim>& particles, std::span<const Vec<Dim>> v,
                                  std::vector<Vec<Dim>>& out) {
    out.resize(v.size());
    if (out.data() != v.data()) std::copy_n(v.begin(), first_point(), out.begin());
    const auto of_body = [&](const Range& body, auto& field) {
        const std::span<const Vec<Dim>> from = v.subspan(body.first, body.count);
        const std::span<Vec<Dim>> to = std::span(out).subspan(body.first, body.count);
        if (std::all_of(from.begin(), from.end(), [](const Vec<Dim>& u) { return u == Vec<Dim>::Zero(); })) {
            std::fill(to.begin(), to.end(), Vec<Dim>::Zero());
            return;
        }
        field.scatter_velocities(weights(particles, body), from, options_.order);
        field.gather_velocities(to);
    };
    std::visit(
        [&](auto& fields) {
            parallel::for_each(bodies_.size(), [&](std::size_t k) { of_body(bodies_[k], fields[k]); });
        },
        fields_);
}

template <int Dim>
double MaterialPoints<Dim>::move(const Particles<Dim>& particles, double dt, std::vector<Vec<Dim>>& drift) {
    std::copy_n(particles.v.begin(), first_point(), drift.begin());
    const auto of_body = [&](const Range& body, auto& field) {
        field.scatter_velocities(weights(particles, body), part(particles.v, body.first, body.count),
                                 options_.order);
        double plastic = 0.0;
        field.gather_motion([&](std::size_t p, const Vec<Dim>& u, const Mat<Dim>& L) {
            drift[body.first + p] = u;
            const Member& grain = grain_at(body.state + p);
            if (grain.rigid) return;
            double work = 0.0;
            update<Dim>(states_[body.state + p], Mat<Dim>(Mat<Dim>::Identity() + dt * L), grain.law, work);
            plastic += particles.volume[body.first + p] * work;
        });
        return plastic;
    };
    return std::visit(
        [&](auto& fields) {
            return parallel::sum(
                bodies_.size(), 0.0, [&](std::size_t k) { return of_body(bodies_[k], fields[k]); }, 1);
        },
        fields_);
}

template <int Dim>
double MaterialPoints<Dim>::elastic_energy(const Particles<Dim>& particles) const {
    return parallel::sum(
        grains_.size(), 0.0,
        [&](std::size_t k) {
            const Member& grain = grains_[k];
            double energy = 0.0;
            for (std::size_t p = 0; p < grain.count; ++p)
                energy += particles.volume[grain.first + p] *
                          quern::elastic_energy<Dim>(states_[grain.state + p], grain.law);
            return energy;
        },
        1);
}

template <int Dim>
void MaterialPoints<Dim>::compute_stress(int k, std::span<double> stress) const {
    const Member& grain = grains_[k];
    for (std::size_t p = 0; p < grain.count; ++p) {
        const PlasticState<Dim>& state = states_[grain.state + p];
        const SymTensor<Dim> tau = kirchhoff_stress<Dim>(state, grain.law);
        for (std::size_t c = 0; c < tau.size(); ++c) stress[p * tau.size() + c] = tau[c] / state.J;
    }
}

template <int Dim>
void MaterialPoints<Dim>::compute_plastic_strain(int k, std::span<float> alpha) const {
    for (std::size_t p = 0; p < grains_[k].count; ++p)
        alpha[p] = static_cast<float>(states_[grains_[k].state + p].alpha);
}

template <int Dim>
bool MaterialPoints<Dim>::yields() const {
    return std::any_of(grains_.begin(), grains_.end(),
                       [](const Member& grain) { return std::isfinite(grain.law.yield_stress); });
}

template <int Dim>
double MaterialPoints<Dim>::max_frequency(const Particles<Dim>& particles, int k) const {
    const Range& grain = one_field_ ? bodies_.front() : static_cast<const Range&>(grains_[k]);
    const std::span<const double> mass = weights(particles, grain);
    const auto frequency = [&](auto field) {
        field.place(grid_, part(particles.x, grain.first, grain.count), part(half_, grain.state, grain.count),
                    mass, one_field_);
        std::vector<double> masses;
        for (const double m : mass) masses.insert(masses.end(), Dim, m);
        std::vector<Mat<Dim>> stress(grain.count);
        const double margin = options_.functions == PointFunctions::linear ? 1.4 : 1.06;
        return margin *
               quern::max_frequency(masses, [&](const std::vector<double>& u, std::vector<double>& f) {
                   const auto* displacement = reinterpret_cast<const Vec<Dim>*>(u.data());
                   field.scatter_velocities(mass, {displacement, grain.count}, options_.order);
                   field.gather_motion([&](std::size_t p, const Vec<Dim>&, const Mat<Dim>& gradient) {
                       stress[p] = linear_stress<Dim>(gradient, grain_at(grain.state + p).law);
                   });
                   field.scatter_forces(mass, part(particles.volume, grain.first, grain.count),
                                        options_.order, [&](std::size_t p) { return stress[p]; });
                   field.gather_forces(mass, {reinterpret_cast<Vec<Dim>*>(f.data()), grain.count});
               });
    };
    return std::visit(
        [&](const auto& fields) { return frequency(typename std::decay_t<decltype(fields)>::value_type()); },
        fields_);
}

template class MaterialPoints<2>;
template class MaterialPoints<3>;

}  // namespace quern
