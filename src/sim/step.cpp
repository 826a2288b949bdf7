#include "src/sim/step.hpp"

#include <fmt/format.h>

#include <chrono>
#include <limits>
#include <utility>

#include "grid/error.hpp"
#include "grid/parallel.hpp"
#include "src/sim/internal_forces.hpp"
#include "src/sim/point_contact.hpp"

namespace quern {

namespace {

/// Adds the time between its birth and its death to a stage.
class StageTimer {
  public:
    explicit StageTimer(double& seconds) : seconds_(seconds), start_(Clock::now()) {}
    ~StageTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

  private:
    using Clock = std::chrono::steady_clock;
    double& seconds_;
    Clock::time_point start_;
};

template <int Dim>
double value(const Expression& expression, const Vec<Dim>& x, double t) {
    return expression(x[0], x[1], Dim == 3 ? x[Dim - 1] : 0.0, t);
}

template <int Dim>
void add_loads(Scene<Dim>& scene, double time) {
    StepArrays<Dim>& a = scene.arrays;
    std::fill(a.load.begin(), a.load.end(), Vec<Dim>::Zero());
    for (const Load<Dim>& load : scene.loads)
        for (const int p : load.particles) {
            const double amount = load.per_mass ? scene.particles.mass[p] : scene.particles.volume[p];
            for (int k = 0; k < Dim; ++k)
                a.load[p][k] += amount * value<Dim>(load.value[k], scene.particles.x[p], time);
        }
    if (scene.points) project_forces(scene, a.load);
}

/// v* = v + dt f/m, and what the forces do on the way.
template <int Dim>
void predict(Scene<Dim>& scene, StepContext<Dim>& now, double dt) {
    StepArrays<Dim>& a = scene.arrays;
    Particles<Dim>& particles = scene.particles;
    const bool loaded = !scene.loads.empty();
    const bool bond_damped = !a.damping.empty();
    const bool with_grid = scene.moves_with_grid();
    struct Sums {
        typename Ledger<Dim>::Entry entry;
        double damping_half = 0, load_half = 0, kinetic = 0, fastest = 0;
        Sums& operator+=(const Sums& other) {
            fastest = std::max(fastest, other.fastest);
            entry += other.entry;
            damping_half += other.damping_half;
            load_half += other.load_half;
            kinetic += other.kinetic;
            return *this;
        }
    };
    std::swap(a.v_before, particles.v);
    if (with_grid) std::swap(a.drift_before, a.drift);
    const std::vector<Vec<Dim>>& before = with_grid ? a.drift_before : a.v_before;
    const Sums sums = parallel::sum(static_cast<std::size_t>(particles.size()), Sums{}, [&](std::size_t p) {
        const double m = particles.mass[p];
        const Vec<Dim> v = a.v_before[p];
        Vec<Dim> damping = -scene.mass_damping * m * v;
        if (bond_damped) damping += a.damping[p];
        const Vec<Dim> load = loaded ? a.load[p] : Vec<Dim>(Vec<Dim>::Zero());
        const Vec<Dim> outside = m * scene.gravity + load - scene.mass_damping * m * v;
        const Vec<Dim> dp = dt * (a.internal[p] + m * scene.gravity + damping + load);
        particles.v[p] = v + dp / m;
        Sums s;
        s.entry.impulse = dt * outside;
        s.entry.moment = moment(particles.x[p], Vec<Dim>(dt * outside));
        s.damping_half = 0.5 * dt * damping.dot(before[p]);
        s.load_half = 0.5 * dt * load.dot(before[p]);
        s.fastest = particles.v[p].squaredNorm();
        s.kinetic = 0.5 * m * v.squaredNorm() + now.part_done() * dp.dot(before[p]);
        return s;
    });
    now.ledger.now = sums.entry;
    now.ledger.damping_half = sums.damping_half;
    now.ledger.load_half = sums.load_half;
    now.ledger.kinetic = sums.kinetic;
    now.largest_speed = std::sqrt(sums.fastest);
}

template <int Dim>
bool node_pairs(const Scene<Dim>& scene) {
    return scene.contact && std::holds_alternative<NodePairContact<Dim>>(*scene.contact);
}

/// Books what a constraint does to a particle as what the constraint receives.
template <int Dim>
void receive(Reaction<Dim>& reaction, const Vec<Dim>& given, const Spin<Dim>& moment, double work) {
    reaction.impulse -= given;
    reaction.moment -= moment;
    reaction.work_now += work;
}

/// Velocities of the walls at n+1/2. A servo takes the place of what the deck gives along the normal.
template <int Dim>
void steer_walls(Scene<Dim>& scene, const StepContext<Dim>& now, double dt) {
    const double time = now.time + 0.5 * now.dt;
    for (std::size_t w = 0; w < scene.walls.size(); ++w) {
        Wall<Dim>& wall = scene.walls[w];
        scene.arrays.wall_v_before[w] = wall.velocity;
        for (int k = 0; k < Dim; ++k) wall.velocity[k] = scene.wall_velocity[w][k](time);
        if (std::optional<Servo>& servo = scene.servos[w]) {
            servo->steer(now.time, dt);
            wall.velocity += (servo->speed - wall.normal.dot(wall.velocity)) * wall.normal;
        }
        if (now.first) scene.arrays.wall_v_before[w] = wall.velocity;
    }
}

/// Prescribed velocities; the impulse that they take is external. Before contact its work is taken with the
/// prescribed velocity, which is the final one; what undoes contact on the grid, with the velocity that
/// contact had left and the mass that it met: so the works of both sum to the change of kinetic energy.
/// Springs between nodes are forces like those inside grains: their works are taken with the final
/// velocities.
template <int Dim>
void apply_constraints(Scene<Dim>& scene, StepContext<Dim>& now, bool after_contact) {
    const bool springs = node_pairs(scene);
    const std::vector<double>& mass =
        after_contact && !scene.contact_mass.empty() ? scene.contact_mass : scene.particles.mass;
    const bool with_grid = after_contact && scene.moves_with_grid();
    const double time = now.time + 0.5 * now.dt;
    for (std::size_t c = 0; c < scene.constraints.size(); ++c) {
        const Constraint<Dim>& constraint = scene.constraints[c];
        Reaction<Dim>& all = now.reactions[scene.walls.size() + c];
        for (std::size_t i = 0; i < constraint.particles.size(); ++i) {
            const int p = constraint.particles[i], w = constraint.wall[i];
            Vec<Dim> v = scene.particles.v[p];
            for (int k = 0; k < Dim; ++k)
                if (constraint.velocity[k])
                    v[k] = value<Dim>(*constraint.velocity[k], scene.particles.x[p], time);
            const Vec<Dim> dp = mass[p] * (v - scene.particles.v[p]);
            const Vec<Dim> v_work = after_contact && !springs ? scene.particles.v[p] : v;
            const double work = 0.5 * dp.dot(scene.arrays.v_before[p] + v_work);
            const Spin<Dim> turn = moment(scene.particles.x[p], dp);
            scene.particles.v[p] = v;
            for (int k = 0; k < Dim && with_grid; ++k)
                if (constraint.velocity[k]) scene.arrays.drift[p][k] = v[k];
            now.largest_speed = std::max(now.largest_speed, v.norm());
            now.ledger.now.constraint += work;
            now.ledger.now.impulse += dp;
            now.ledger.now.moment += turn;
            receive(all, dp, turn, work);
            if (w >= 0)
                receive(now.reactions[scene.walls.size() + scene.constraints.size() + w], dp, turn, work);
        }
    }
}

template <int Dim>
void add_contact(Scene<Dim>& scene, StepContext<Dim>& now, double dt) {
    if (!scene.contact) return;
    const ContactScene<Dim> view = scene.contact_scene();
    double fastest = now.largest_speed;
    for (const Wall<Dim>& wall : scene.walls) fastest = std::max(fastest, wall.velocity.norm());
    const bool springs = node_pairs(scene);
    const ContactTrial<Dim> trial{
        now.dt,     scene.arrays.v_before, scene.particles.v, scene.arrays.drift, fastest, now.first,
        now.listing};
    const ContactReport<Dim>& report =
        scene.points
            ? add_point_impulses(scene, view, trial, now.contact_list)
            : std::visit(
                  [&](auto& method) -> const ContactReport<Dim>& { return method.add_impulses(view, trial); },
                  *scene.contact);
    if (now.listing && !scene.points)
        std::visit([&](auto& method) { method.list_contacts(view, now.contact_list); }, *scene.contact);
    apply_constraints(scene, now, true);
    if (auto* pairs = std::get_if<NodePairContact<Dim>>(&*scene.contact); pairs && !scene.constraints.empty())
        pairs->book_losses(view, trial);
    typename Ledger<Dim>::Entry& entry = now.ledger.now;
    now.ledger.contact_elastic = report.elastic;
    now.ledger.kinetic += now.part_done() * report.elastic_work;
    now.ledger.past.friction -= report.slip_loss;
    entry.normal += report.normal_work;
    entry.friction += report.friction_work;
    entry.wall += report.wall_work;
    for (std::size_t w = 0; w < report.wall_impulse.size(); ++w) {
        entry.impulse -= report.wall_impulse[w];
        entry.moment -= report.wall_moment[w];
        if (std::optional<Servo>& servo = scene.servos[w])
            servo->pressed = -scene.walls[w].normal.dot(report.wall_impulse[w]) / dt;
        Reaction<Dim>& reaction = now.reactions[w];
        reaction.impulse += report.wall_impulse[w];
        reaction.moment += report.wall_moment[w];
        // The works that contact has summed over the walls: springs act with the mean velocity.
        const Vec<Dim>& velocity = scene.walls[w].velocity;
        const Vec<Dim> acting =
            springs ? Vec<Dim>(0.5 * (scene.arrays.wall_v_before[w] + velocity)) : velocity;
        reaction.work_now -= report.wall_impulse[w].dot(acting);
    }
    for (std::size_t g = 0; g < report.grain_impulse.size(); ++g)
        now.grain_impulse[g] += report.grain_impulse[g];
    now.contact_nodes += report.n_nodes;
    now.contacts += report.n_contacts;
    now.sweeps += report.sweeps;
    now.searches += report.searched ? 1 : 0;
    if (!report.converged && now.unconverged++ == 0) now.first_unconverged = now.step;
    if (report.stable_step < now.dt && now.unstable++ == 0) now.first_unstable = now.step;
    now.least_stable_step = std::min(now.least_stable_step, report.stable_step);
}

/// Works of this step that need the velocities after contact.
template <int Dim>
void close_ledger(Scene<Dim>& scene, StepContext<Dim>& now, double dt) {
    StepArrays<Dim>& a = scene.arrays;
    const Particles<Dim>& particles = scene.particles;
    const bool with_grid = scene.moves_with_grid();
    const bool loaded = !scene.loads.empty(), bond_damped = !a.damping.empty();
    typename Ledger<Dim>::Entry& entry = now.ledger.now;
    if (!with_grid && !loaded && !bond_damped && scene.mass_damping == 0.0) return;
    const std::vector<Vec<Dim>>& after = with_grid ? a.drift : particles.v;
    struct Sums {
        double damping = 0, load = 0, transfer = 0;
        Sums& operator+=(const Sums& other) {
            damping += other.damping;
            load += other.load;
            transfer += other.transfer;
            return *this;
        }
    };
    const Sums sums = parallel::sum(static_cast<std::size_t>(particles.size()), Sums{}, [&](std::size_t p) {
        const double m = particles.mass[p];
        const Vec<Dim> v = a.v_before[p];
        Vec<Dim> damping = -scene.mass_damping * m * v;
        if (bond_damped) damping += a.damping[p];
        Sums s;
        s.damping = 0.5 * dt * damping.dot(after[p]);
        if (loaded) s.load = 0.5 * dt * a.load[p].dot(after[p]);
        if (with_grid) {
            Vec<Dim> force = a.internal[p] + m * scene.gravity + damping;
            if (loaded) force += a.load[p];
            s.transfer = 0.5 * dt * force.dot(a.drift_before[p] + a.drift[p]) -
                         0.5 * m * (particles.v[p].squaredNorm() - v.squaredNorm());
        }
        return s;
    });
    entry.damping = now.ledger.damping_half + sums.damping;
    entry.load = now.ledger.load_half + sums.load;
    if (with_grid)
        entry.transfer = sums.transfer + entry.normal + entry.friction + entry.wall + entry.constraint;
}

/// Stress and strain of material points go to the end of the step, and `drift` to what moves each particle:
/// those that are held go where they are led.
template <int Dim>
void move_points(Scene<Dim>& scene, StepContext<Dim>& now) {
    const StageTimer timer(now.stages.points);
    now.ledger.past.plastic += scene.points->move(scene.particles, now.dt, scene.arrays.drift);
    for (const Constraint<Dim>& constraint : scene.constraints)
        for (const int p : constraint.particles) scene.arrays.drift[p] = scene.particles.v[p];
}

}  // namespace

template <int Dim>
typename Ledger<Dim>::Entry& Ledger<Dim>::Entry::operator+=(const Entry& other) {
    damping += other.damping;
    load += other.load;
    constraint += other.constraint;
    normal += other.normal;
    friction += other.friction;
    wall += other.wall;
    fracture += other.fracture;
    plastic += other.plastic;
    transfer += other.transfer;
    impulse += other.impulse;
    moment += other.moment;
    return *this;
}

template <int Dim>
StepContext<Dim> make_context(const Scene<Dim>& scene, double dt) {
    StepContext<Dim> now;
    now.dt = dt;
    now.grain_impulse.assign(scene.grains.size(), Vec<Dim>::Zero());
    now.reactions.resize(scene.walls.size() + scene.constraints.size() + scene.held_walls.size());
    return now;
}

template <int Dim>
void kick(Scene<Dim>& scene, StepContext<Dim>& now) {
    const double dt = now.kick_time();
    now.contact_list.clear();
    steer_walls(scene, now, dt);
    {
        const StageTimer timer(now.stages.internal_forces);
        const std::int64_t broken = now.newly_broken;
        compute_internal_forces(scene, now);
        if (now.newly_broken != broken) update_fragments(scene, now);
    }
    {
        const StageTimer timer(now.stages.loads);
        if (!scene.loads.empty()) add_loads(scene, now.time);
    }
    {
        const StageTimer timer(now.stages.kick);
        predict(scene, now, dt);
        apply_constraints(scene, now, false);
    }
    {
        const StageTimer timer(now.stages.contact);
        add_contact(scene, now, dt);
    }
    const StageTimer timer(now.stages.kick);
    close_ledger(scene, now, dt);
}

template <int Dim>
void drift(Scene<Dim>& scene, StepContext<Dim>& now) {
    if (scene.points) move_points(scene, now);
    const StageTimer timer(now.stages.drift);
    Particles<Dim>& particles = scene.particles;
    const bool with_grid = scene.moves_with_grid() || scene.points;
    const std::vector<Vec<Dim>>& velocity = with_grid ? scene.arrays.drift : particles.v;
    struct Moved {
        double fastest = 0.0;  ///< squared speed
        int lost = std::numeric_limits<int>::max();
        Moved& operator+=(const Moved& other) {
            fastest = std::max(fastest, other.fastest);
            lost = std::min(lost, other.lost);
            return *this;
        }
    };
    const Moved moved =
        parallel::sum(static_cast<std::size_t>(particles.size()), Moved{}, [&](std::size_t i) {
            const int p = static_cast<int>(i);
            particles.x[p] += now.dt * velocity[p];
            Moved m;
            m.fastest = velocity[p].squaredNorm();
            if (!scene.grid.contains(particles.x[p])) m.lost = p;
            return m;
        });
    double longest = std::sqrt(moved.fastest);
    for (const Wall<Dim>& wall : scene.walls) longest = std::max(longest, wall.velocity.norm());
    scene.travelled += now.dt * longest;
    now.ledger.past += now.ledger.now;
    now.ledger.now = {};
    now.time = now.dt * static_cast<double>(++now.step);
    now.first = false;
    for (Reaction<Dim>& reaction : now.reactions) reaction.work += std::exchange(reaction.work_now, 0.0);
    for (Wall<Dim>& wall : scene.walls) wall.point += now.dt * wall.velocity;
    if (const int p = moved.lost; p < particles.size()) {
        std::size_t g = 0;
        while (p >= scene.grains[g].first + scene.grains[g].count) ++g;
        const bool number = particles.x[p].allFinite();
        throw SimulationError(fmt::format(
            "grain {}, particle {}, step {} (t = {:.6g} s): {}", scene.grains[g].id,
            p - scene.grains[g].first, now.step, now.time,
            number
                ? "has left the grid; a wall or a larger grid is missing, or the run is unstable"
                : "its position is no number; the run is unstable, try a smaller time.safety or time.step"));
    }
}

template struct Ledger<2>;
template struct Ledger<3>;
template StepContext<2> make_context<2>(const Scene<2>&, double);
template StepContext<3> make_context<3>(const Scene<3>&, double);
template void kick<2>(Scene<2>&, StepContext<2>&);
template void kick<3>(Scene<3>&, StepContext<3>&);
template void drift<2>(Scene<2>&, StepContext<2>&);
template void drift<3>(Scene<3>&, StepContext<3>&);

}  // namespace quern
