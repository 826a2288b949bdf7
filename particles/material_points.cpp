#include "particles/material_points.hpp"

#include <algorithm>
#include <cmath>

#include "grid/parallel.hpp"
#include "particles/point_loops.hpp"
#include "particles/stable_step.hpp"

namespace quern {

namespace {

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
MaterialPoints<Dim>::MaterialPoints(const CartesianGrid<Dim>& grid, const PointOptions& options)
    : grid_(grid), options_(options) {
    if (options.functions == PointFunctions::linear) fields_.template emplace<0>();
    if (options.functions == PointFunctions::gimp) fields_.template emplace<1>();
    if (options.functions == PointFunctions::quadratic) fields_.template emplace<2>();
}

template <int Dim>
void MaterialPoints<Dim>::add_grain(const Grain<Dim>& grain, std::span<const double> volume,
                                    const VonMises& law) {
    grains_.push_back(
        {static_cast<std::size_t>(grain.first), static_cast<std::size_t>(grain.count), states_.size(), law});
    states_.resize(states_.size() + volume.size());
    for (const double V : volume) half_.push_back(0.5 * std::pow(V, 1.0 / Dim) / grid_.h());
    std::visit([](auto& fields) { fields.emplace_back(); }, fields_);
}

template <int Dim>
void MaterialPoints<Dim>::compute_forces(const Particles<Dim>& particles, std::vector<Vec<Dim>>& f) {
    const auto of_grain = [&](const Member& grain, auto& field) {
        const std::span<const double> mass = part(particles.mass, grain.first, grain.count);
        field.place(grid_, part(particles.x, grain.first, grain.count), part(half_, grain.state, grain.count),
                    mass);
        field.scatter_forces(
            mass, part(particles.volume, grain.first, grain.count), options_.order, [&](std::size_t p) {
                return to_matrix<Dim>(kirchhoff_stress<Dim>(states_[grain.state + p], grain.law));
            });
        field.gather_forces(mass, std::span(f).subspan(grain.first, grain.count));
    };
    std::visit(
        [&](auto& fields) {
            parallel::for_each(grains_.size(), [&](std::size_t k) { of_grain(grains_[k], fields[k]); });
        },
        fields_);
}

template <int Dim>
void MaterialPoints<Dim>::project(const Particles<Dim>& particles, std::span<const Vec<Dim>> v,
                                  std::vector<Vec<Dim>>& out) {
    out.resize(v.size());
    if (out.data() != v.data()) std::copy_n(v.begin(), first_point(), out.begin());
    const auto of_grain = [&](const Member& grain, auto& field) {
        const std::span<const Vec<Dim>> from = v.subspan(grain.first, grain.count);
        const std::span<Vec<Dim>> to = std::span(out).subspan(grain.first, grain.count);
        if (std::all_of(from.begin(), from.end(), [](const Vec<Dim>& u) { return u == Vec<Dim>::Zero(); })) {
            std::fill(to.begin(), to.end(), Vec<Dim>::Zero());
            return;
        }
        field.scatter_velocities(part(particles.mass, grain.first, grain.count), from, options_.order);
        field.gather_velocities(to);
    };
    std::visit(
        [&](auto& fields) {
            parallel::for_each(grains_.size(), [&](std::size_t k) { of_grain(grains_[k], fields[k]); });
        },
        fields_);
}

template <int Dim>
double MaterialPoints<Dim>::move(const Particles<Dim>& particles, double dt, std::vector<Vec<Dim>>& drift) {
    std::copy_n(particles.v.begin(), first_point(), drift.begin());
    const auto of_grain = [&](const Member& grain, auto& field) {
        field.scatter_velocities(part(particles.mass, grain.first, grain.count),
                                 part(particles.v, grain.first, grain.count), options_.order);
        double plastic = 0.0;
        field.gather_motion([&](std::size_t p, const Vec<Dim>& u, const Mat<Dim>& L) {
            drift[grain.first + p] = u;
            double work = 0.0;
            update<Dim>(states_[grain.state + p], Mat<Dim>(Mat<Dim>::Identity() + dt * L), grain.law, work);
            plastic += particles.volume[grain.first + p] * work;
        });
        return plastic;
    };
    return std::visit(
        [&](auto& fields) {
            return parallel::sum(
                grains_.size(), 0.0, [&](std::size_t k) { return of_grain(grains_[k], fields[k]); }, 1);
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
    const Member& grain = grains_[k];
    const std::span<const double> mass = part(particles.mass, grain.first, grain.count);
    const auto frequency = [&](auto field) {
        field.place(grid_, part(particles.x, grain.first, grain.count), part(half_, grain.state, grain.count),
                    mass);
        std::vector<double> masses;
        for (const double m : mass) masses.insert(masses.end(), Dim, m);
        std::vector<Mat<Dim>> stress(grain.count);
        const double margin = options_.functions == PointFunctions::linear ? 1.4 : 1.06;
        return margin *
               quern::max_frequency(masses, [&](const std::vector<double>& u, std::vector<double>& f) {
                   const auto* displacement = reinterpret_cast<const Vec<Dim>*>(u.data());
                   field.scatter_velocities(mass, {displacement, grain.count}, options_.order);
                   field.gather_motion([&](std::size_t p, const Vec<Dim>&, const Mat<Dim>& gradient) {
                       stress[p] = linear_stress<Dim>(gradient, grain.law);
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
