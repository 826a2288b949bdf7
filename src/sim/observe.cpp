#include "src/sim/observe.hpp"

#include <fmt/format.h>

#include <cstring>
#include <numbers>

#include "contact/slot.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

/// Velocity at the time of the positions: mean of those half a step around it.
template <int Dim>
Vec<Dim> velocity_now(const Scene<Dim>& scene, const StepContext<Dim>& now, int p) {
    if (now.first) return scene.arrays.v_before[p];
    return 0.5 * (scene.arrays.v_before[p] + scene.particles.v[p]);
}

double about_z(const Spin<2>& s) {
    return s[0];
}
double about_z(const Spin<3>& s) {
    return s[2];
}

}  // namespace

template <int Dim>
Particles<Dim> particles_now(const Scene<Dim>& scene, const StepContext<Dim>& now, const Grain<Dim>& grain) {
    Particles<Dim> particles;
    for (int p = grain.first; p < grain.first + grain.count; ++p) {
        particles.x.push_back(scene.particles.x[p]);
        particles.v.push_back(velocity_now(scene, now, p));
        particles.mass.push_back(scene.particles.mass[p]);
    }
    return particles;
}

template <int Dim>
typename Observer<Dim>::Momenta& Observer<Dim>::Momenta::operator+=(const Momenta& other) {
    linear += other.linear;
    angular += other.angular;
    scale += other.scale;
    angular_scale += other.angular_scale;
    potential += other.potential;
    return *this;
}

template <int Dim>
typename Observer<Dim>::Momenta Observer<Dim>::momenta(const Scene<Dim>& scene) const {
    return parallel::sum(static_cast<std::size_t>(scene.particles.size()), Momenta{}, [&](std::size_t p) {
        const Vec<Dim> momentum = scene.particles.mass[p] * scene.particles.v[p];
        Momenta m;
        m.linear = momentum;
        m.angular = moment(scene.particles.x[p], momentum);
        m.scale = momentum.norm();
        m.angular_scale = momentum.norm() * scene.particles.x[p].norm();
        m.potential = -scene.particles.mass[p] * scene.gravity.dot(scene.particles.x[p] - scene.x_start[p]);
        return m;
    });
}

template <int Dim>
void Observer<Dim>::start(const Scene<Dim>& scene, const StepContext<Dim>& now) {
    const Momenta m = momenta(scene);
    start_linear_ = m.linear - now.ledger.now.impulse;
    start_angular_ = m.angular - now.ledger.now.moment;
    start_energy_ = 0.0;
    started_ = false;
}

template <int Dim>
HistoryRow Observer<Dim>::history(const Scene<Dim>& scene, const StepContext<Dim>& now) {
    const Momenta m = momenta(scene);
    const auto& past = now.ledger.past;
    const auto& here = now.ledger.now;
    const double part = now.part_done();
    HistoryRow row;
    row.time = now.time;
    EnergyBudget& e = row.energy;
    const double contact = here.normal + here.friction + here.wall;
    e.kinetic = now.ledger.kinetic + part * (contact + here.constraint - here.transfer);
    e.elastic = scene.elastic_energy();
    e.contact_elastic = now.ledger.contact_elastic;
    e.gravity = m.potential;
    e.damping = 0.0 - past.damping - (now.first ? 0.0 : now.ledger.damping_half);
    e.friction = 0.0 - past.friction - part * here.friction;
    e.contact_loss = 0.0 - past.normal - part * here.normal;
    e.fracture = past.fracture;
    e.plastic = past.plastic;
    e.transfer_loss = past.transfer + part * here.transfer;
    e.external_work = past.load + (now.first ? 0.0 : now.ledger.load_half) + past.constraint +
                      part * here.constraint + past.wall + part * here.wall;
    const double stored = e.kinetic + e.elastic + e.contact_elastic + e.gravity;
    const double lost = e.damping + e.friction + e.contact_loss + e.fracture + e.plastic + e.transfer_loss;
    const double total = stored + lost - e.external_work;
    if (!started_) start_energy_ = total;
    started_ = true;
    e.residual = total - start_energy_;
    throughput_ = std::max(throughput_, e.kinetic + e.elastic + e.contact_elastic + std::abs(lost));
    e.throughput = throughput_;
    largest_residual_ = std::max(largest_residual_, std::abs(e.residual));

    const Vec<Dim> missing = m.linear - start_linear_ - past.impulse - here.impulse;
    const Spin<Dim> missing_angular = m.angular - start_angular_ - past.moment - here.moment;
    momentum_error_ = std::max(momentum_error_, missing.norm());
    angular_error_ = std::max(angular_error_, missing_angular.norm());
    momentum_scale_ = std::max(momentum_scale_, m.scale);
    angular_scale_ = std::max(angular_scale_, m.angular_scale);
    for (int a = 0; a < Dim; ++a) row.momentum[a] = m.linear[a];
    if constexpr (Dim == 2)
        row.angular_momentum[2] = m.angular[0];
    else
        for (int a = 0; a < 3; ++a) row.angular_momentum[a] = m.angular[a];
    const Fragments& fragments = scene.fragments;
    row.broken_bonds = fragments.n_broken();
    row.debris = fragments.n_debris();
    row.fragments =
        fragments.all.empty() ? static_cast<std::int64_t>(scene.grains.size()) : fragments.n_fragments();
    return row;
}

template <int Dim>
void Observer<Dim>::pass(Checkpoint& checkpoint) {
    checkpoint.value("start energy", start_energy_);
    checkpoint.value("start momentum", start_linear_);
    checkpoint.value("start angular momentum", start_angular_);
    for (double* value : {&largest_residual_, &throughput_, &momentum_error_, &momentum_scale_,
                          &angular_error_, &angular_scale_})
        checkpoint.value("largest", *value);
    started_ = true;
}

template <int Dim>
GrainTracker<Dim>::GrainTracker(const Scene<Dim>& scene, const Deck& deck) {
    if (deck.output.track_all)
        grains_ = scene.grain_of_id;
    else
        for (const int id : deck.output.track)
            grains_.push_back(scene.grain_of_id[static_cast<std::size_t>(id)]);
    for (const int g : grains_) {
        angle_.push_back(deck.grains[scene.grains[g].id].angle[2]);
        rotation_.push_back(best_fit_rotation<Dim>(scene.grains[g], scene.particles.x, scene.particles.mass));
    }
    omega_.assign(grains_.size(), 0.0);
}

template <int Dim>
std::vector<GrainRow> GrainTracker<Dim>::rows(const Scene<Dim>& scene, StepContext<Dim>& now,
                                              double elapsed) {
    std::vector<GrainRow> rows;
    for (std::size_t k = 0; k < grains_.size(); ++k) {
        Grain<Dim> grain = scene.grains[grains_[k]];
        const Particles<Dim> particles = particles_now(scene, now, grain);
        grain.first = 0;
        const GrainMotion<Dim> motion = grain_motion(grain, particles);
        const double omega = about_z(motion.omega);
        // The turn since the last row, on the branch that the mean spin points to.
        const Mat<Dim> turn = motion.rotation * rotation_[k].transpose();
        double step = std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
        const double expected = 0.5 * (omega + omega_[k]) * elapsed;
        step += 2.0 * std::numbers::pi * std::round((expected - step) / (2.0 * std::numbers::pi));
        angle_[k] += step;
        rotation_[k] = motion.rotation;
        omega_[k] = omega;
        GrainRow row;
        row.time = now.time;
        row.grain = grain.id;
        row.angle = angle_[k];
        row.omega = omega;
        for (int a = 0; a < Dim; ++a) {
            row.position[a] = motion.centre[a];
            row.velocity[a] = motion.velocity[a];
            row.force[a] = elapsed > 0.0 ? now.grain_impulse[grains_[k]][a] / elapsed : 0.0;
        }
        rows.push_back(row);
    }
    for (Vec<Dim>& impulse : now.grain_impulse) impulse.setZero();
    return rows;
}

template <int Dim>
void GrainTracker<Dim>::pass(Checkpoint& checkpoint) {
    checkpoint.array("tracked angle", std::span(angle_));
    checkpoint.array("tracked spin", std::span(omega_));
    checkpoint.array("tracked rotation", std::span(rotation_));
}

template <int Dim>
void make_frame(const Scene<Dim>& scene, const StepContext<Dim>& now, Frame& frame) {
    const std::size_t n = static_cast<std::size_t>(scene.particles.size());
    constexpr std::size_t d = Dim, n_components = Dim == 2 ? 4 : 6;
    frame.dimension = Dim;
    frame.step = now.step;
    frame.time = now.time;
    frame.position.resize(n * d);
    frame.velocity.resize(n * d);
    frame.damage.resize(n);
    const bool breakable = std::any_of(scene.groups.begin(), scene.groups.end(),
                                       [](const auto& group) { return group.breakable; });
    frame.damage_z.resize(breakable ? n : 0);
    const bool yields = !scene.plastic.empty() || (scene.points && scene.points->yields());
    frame.plastic_strain.assign(yields ? n : 0, 0.0F);
    std::transform(scene.plastic.begin(), scene.plastic.end(), frame.plastic_strain.begin(),
                   [](const auto& strain) { return static_cast<float>(strain.alpha); });
    frame.stress.resize(n * n_components);
    frame.grain.resize(n);
    frame.volume = scene.particles.volume;
    frame.fragment = scene.fragments.of_particle;
    const auto narrow = [](double value) { return static_cast<float>(value); };
    const auto take_motion = [&](const Grain<Dim>& grain) {
        for (int i = grain.first; i < grain.first + grain.count; ++i) {
            const std::size_t p = static_cast<std::size_t>(i);
            const Vec<Dim> v = velocity_now(scene, now, i);
            for (std::size_t a = 0; a < d; ++a) {
                frame.position[p * d + a] = scene.particles.x[p][static_cast<int>(a)];
                frame.velocity[p * d + a] = narrow(v[static_cast<int>(a)]);
            }
            frame.grain[p] = grain.id;
        }
    };
    for (const MaterialGroup<Dim>& group : scene.groups)
        std::visit(
            [&](const auto& model) {
                parallel::for_each(static_cast<std::size_t>(group.last_grain - group.first_grain),
                                   [&](std::size_t i) {
                                       const int g = group.first_grain + static_cast<int>(i);
                                       const Grain<Dim>& grain = scene.grains[g];
                                       const GrainView<Dim> view = scene.view(g);
                                       const std::size_t first = static_cast<std::size_t>(grain.first);
                                       const std::size_t count = static_cast<std::size_t>(grain.count);
                                       thread_local std::vector<double> wide;
                                       wide.assign(n_components * count, 0.0);
                                       if (!view.alive.empty())
                                           model.compute_damage(view, {wide.data(), count});
                                       std::transform(wide.begin(), wide.begin() + grain.count,
                                                      frame.damage.begin() + grain.first, narrow);
                                       if (breakable) {
                                           std::fill_n(wide.begin(), count, 0.0);
                                           if (group.breakable)
                                               model.compute_relative_stretch(view, {wide.data(), count});
                                           std::transform(wide.begin(), wide.begin() + grain.count,
                                                          frame.damage_z.begin() + grain.first, narrow);
                                       }
                                       model.compute_stress(view, wide);
                                       std::transform(wide.begin(), wide.end(),
                                                      frame.stress.data() + n_components * first, narrow);
                                       take_motion(grain);
                                   });
            },
            group.model);
    if (!scene.points) return;
    const std::size_t n_grains = static_cast<std::size_t>(scene.points->n_grains());
    parallel::for_each(n_grains, [&](std::size_t k) {
        const Grain<Dim>& grain = scene.grains[scene.grains.size() - n_grains + k];
        const std::size_t first = static_cast<std::size_t>(grain.first);
        const std::size_t count = static_cast<std::size_t>(grain.count);
        thread_local std::vector<double> stress;
        stress.resize(n_components * count);
        scene.points->compute_stress(static_cast<int>(k), stress);
        if (!frame.plastic_strain.empty())
            scene.points->compute_plastic_strain(static_cast<int>(k),
                                                 {frame.plastic_strain.data() + first, count});
        std::transform(stress.begin(), stress.end(), frame.stress.data() + n_components * first, narrow);
        std::fill_n(frame.damage.begin() + grain.first, grain.count, 0.0F);
        if (breakable) std::fill_n(frame.damage_z.begin() + grain.first, grain.count, 0.0F);
        take_motion(grain);
    });
}

template <int Dim>
std::vector<FragmentRow> fragment_rows(const Scene<Dim>& scene, const StepContext<Dim>& now,
                                       const Frame& frame) {
    constexpr std::size_t n_components = Dim == 2 ? 4 : 6;
    const Fragments& fragments = scene.fragments;
    struct Sums {
        double volume = 0.0, dx = 0.0;
        Vec<Dim> mx = Vec<Dim>::Zero(), mv = Vec<Dim>::Zero();
        Spin<Dim> L = Spin<Dim>::Zero();
        Mat<Dim> second = Mat<Dim>::Zero();
    };
    std::vector<FragmentRow> rows(fragments.all.size());
    std::vector<Sums> sums(rows.size());
    const auto for_each_particle = [&](auto&& visit) {
        for (const Grain<Dim>& grain : scene.grains)
            for (int p = grain.first; p < grain.first + grain.count && !rows.empty(); ++p) {
                const std::size_t k = static_cast<std::size_t>(fragments.of_particle[p]);
                sums[k].dx = grain.shape->dx * grain.scale;
                visit(p, rows[k], sums[k]);
            }
    };
    for_each_particle([&](int p, FragmentRow& row, Sums& sum) {
        const double m = scene.particles.mass[p], V = scene.particles.volume[p];
        row.mass += m;
        sum.volume += V;
        sum.mx += m * scene.particles.x[p];
        sum.mv += m * velocity_now(scene, now, p);
        for (std::size_t c = 0; c < n_components; ++c)
            row.stress[c] += V * frame.stress[n_components * static_cast<std::size_t>(p) + c];
        row.damage += V * frame.damage[static_cast<std::size_t>(p)];
    });
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Fragment& from = fragments.all[k];
        FragmentRow& row = rows[k];
        row.time = now.time;
        row.fragment = static_cast<std::int64_t>(k);
        row.grain = from.grain;
        row.parent = from.parent;
        row.born = from.born;
        row.born_step = from.step;
        row.particles = from.particles;
        sums[k].mx /= row.mass;
        sums[k].mv /= row.mass;
        for (int a = 0; a < Dim; ++a) {
            row.position[a] = sums[k].mx[a];
            row.velocity[a] = sums[k].mv[a];
        }
        for (std::size_t c = 0; c < n_components; ++c) row.stress[c] /= sums[k].volume;
        row.damage /= sums[k].volume;
    }
    for_each_particle([&](int p, FragmentRow&, Sums& sum) {
        const double m = scene.particles.mass[p];
        const Vec<Dim> r = scene.particles.x[p] - sum.mx;
        sum.L += moment(r, Vec<Dim>(m * (velocity_now(scene, now, p) - sum.mv)));
        sum.second += m * r * r.transpose();
    });
    for (std::size_t k = 0; k < rows.size(); ++k) {
        Eigen::Matrix<double, n_spin<Dim>, n_spin<Dim>> inverse;  // 0 for a point or a line: it does not turn
        invert_inertia(sums[k].second, rows[k].mass, sums[k].dx, inverse);
        const Spin<Dim> omega = inverse * sums[k].L;
        for (int a = 0; a < n_spin<Dim>; ++a) rows[k].omega[Dim == 2 ? 2 : a] = omega[a];
    }
    return rows;
}

template <int Dim>
std::string state_hash(const Scene<Dim>& scene) {
    std::uint64_t hash = 14695981039346656037ull;
    const auto add = [&](const Vec<Dim>& v) {
        for (int a = 0; a < Dim; ++a) {
            std::uint64_t bits;
            const double value = v[a];
            std::memcpy(&bits, &value, sizeof bits);
            for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (bits >> 8 * byte & 0xff)) * 1099511628211ull;
        }
    };
    for (const int g : scene.grain_of_id)
        for (int p = scene.grains[g].first; p < scene.grains[g].first + scene.grains[g].count; ++p) {
            add(scene.particles.x[p]);
            add(scene.particles.v[p]);
        }
    return fmt::format("{:016x}", hash);
}

template Particles<2> particles_now<2>(const Scene<2>&, const StepContext<2>&, const Grain<2>&);
template Particles<3> particles_now<3>(const Scene<3>&, const StepContext<3>&, const Grain<3>&);
template class Observer<2>;
template class Observer<3>;
template class GrainTracker<2>;
template class GrainTracker<3>;
template void make_frame<2>(const Scene<2>&, const StepContext<2>&, Frame&);
template void make_frame<3>(const Scene<3>&, const StepContext<3>&, Frame&);
template std::vector<FragmentRow> fragment_rows<2>(const Scene<2>&, const StepContext<2>&, const Frame&);
template std::vector<FragmentRow> fragment_rows<3>(const Scene<3>&, const StepContext<3>&, const Frame&);
template std::string state_hash<2>(const Scene<2>&);
template std::string state_hash<3>(const Scene<3>&);

}  // namespace quern
