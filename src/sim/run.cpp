#include "src/sim/run.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "grid/error.hpp"
#include "grid/parallel.hpp"
#include "quern_version.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/progress.hpp"
#include "src/results/stop_signals.hpp"
#include "src/results/writer.hpp"
#include "src/sim/observe.hpp"
#include "src/sim/step.hpp"

namespace quern {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// Rows or frames that fall due every `interval` seconds, and at the start.
class Schedule {
  public:
    explicit Schedule(double interval) : interval_(interval) {}
    bool due(double time, double dt) {
        if (time < next_ - 0.5 * dt) return false;
        while (next_ <= time + 0.5 * dt) next_ += interval_;
        return true;
    }

  private:
    double interval_, next_ = 0.0;
};

template <int Dim>
class Run {
  public:
    Run(const Deck& deck, const RunOptions& options)
        : deck_(deck),
          options_(options),
          writer_(writer_options(deck, options)),
          scene_(make_scene<Dim>(deck)) {
        summary_.version = QUERN_VERSION;
        summary_.title = deck.title;
        summary_.dimension = Dim;
        summary_.threads = parallel::n_threads();
        summary_.instructions = batch_loops(deck.compute.instructions).name;
        summary_.deck_hash = deck_hash(deck);
        writer_.write_text("deck.resolved.yaml", resolved_yaml(deck));
        summary_.n_particles = scene_->particles.size();
        summary_.n_bonds = scene_->n_bonds;
        summary_.n_grains = static_cast<std::int64_t>(scene_->grains.size());
        choose_time_step();
    }

    RunOutcome go(RunRecord* record) {
        record_ = record;
        const StopSignals signals;
        host_line();
        RunOutcome outcome = RunOutcome::done;
        try {
            prepare();
            outcome = march();
            summary_.outcome = outcome == RunOutcome::done ? "done" : "interrupted";
        } catch (const SimulationError& error) {
            std::string message = error.what();
            if (now_.dt > summary_.stable_step)
                message += fmt::format(" (time.step {:.4g} s is above the stable step {:.4g} s)", now_.dt,
                                       summary_.stable_step);
            summary_.outcome = "failed: " + message;
            writer_.log(summary_.outcome);
            close();
            throw SimulationError(message);
        }
        close();
        return outcome;
    }

  private:
    static WriterOptions writer_options(const Deck& deck, const RunOptions& options) {
        WriterOptions out;
        out.directory = options.directory;
        out.dimension = Dim;
        out.vtp = deck.output.vtp;
        out.title = deck.title;
        for (int a = 0; a < Dim; ++a) out.domain.push_back(deck.grid.origin[a]);
        for (int a = 0; a < Dim; ++a) out.domain.push_back(deck.grid.origin[a] + deck.grid.extent[a]);
        return out;
    }

    void choose_time_step() {
        summary_.stable_step = scene_->stable_step();
        double dt = deck_.time.step > 0.0 ? deck_.time.step : deck_.time.safety * summary_.stable_step;
        n_steps_ = static_cast<std::int64_t>(std::ceil(deck_.time.end / dt - 1e-9));
        dt = deck_.time.end / static_cast<double>(n_steps_);
        now_.dt = summary_.time_step = dt;
        if (dt > summary_.stable_step)
            warn(fmt::format("time.step {:.4g} s is above the stable step {:.4g} s", dt,
                             summary_.stable_step));
    }

    void host_line() {
        char host[256] = "unknown";
        gethostname(host, sizeof host - 1);
        writer_.log(
            fmt::format("Quern {} on {}, {} threads: {}", QUERN_VERSION, host, summary_.threads, deck_.file));
        writer_.log(
            fmt::format("{} grains, {} particles, {} bonds; time step {:.6g} s (stable {:.6g} s), {} steps",
                        summary_.n_grains, summary_.n_particles, summary_.n_bonds, summary_.time_step,
                        summary_.stable_step, n_steps_));
    }

    void warn(const std::string& text) {
        ++warnings_[text];
        writer_.log("warning: " + text);
    }

    /// Relaxes under the loads of the deck's prepare section, then gives the initial velocities.
    void prepare() {
        reset_context();
        if (deck_.prepare.duration > 0.0) {
            const Vec<Dim> gravity = scene_->gravity;
            const double damping = scene_->mass_damping;
            const FrictionTable friction = scene_->friction;
            const std::vector<Wall<Dim>> walls = scene_->walls;
            const auto wall_velocity = scene_->wall_velocity;
            const std::vector<Load<Dim>> loads = scene_->loads;
            scene_->loads.insert(scene_->loads.end(), scene_->prepare_loads.begin(),
                                 scene_->prepare_loads.end());
            if (deck_.prepare.gravity)
                for (int a = 0; a < Dim; ++a) scene_->gravity[a] = (*deck_.prepare.gravity)[a];
            scene_->mass_damping = deck_.prepare.mass_damping;
            for (std::size_t w = 0; w < walls.size(); ++w) {
                scene_->walls[w].velocity.setZero();
                scene_->wall_velocity[w] = {};
                if (deck_.prepare.friction) scene_->walls[w].friction = *deck_.prepare.friction;
            }
            if (deck_.prepare.friction)
                scene_->friction =
                    FrictionTable(static_cast<int>(deck_.materials.size()), *deck_.prepare.friction);
            const auto steps = static_cast<std::int64_t>(std::ceil(deck_.prepare.duration / now_.dt));
            Progress progress(options_.progress_terminal, deck_.prepare.duration,
                              [&](const std::string& line) { writer_.log("prepare: " + line); });
            for (std::int64_t i = 0; i < steps && !stop_requested(); ++i) {
                kick(*scene_, now_);
                drift(*scene_, now_);
                now_.time = 0.0;
                progress.update(now_.step, now_.dt * static_cast<double>(now_.step), 0.0);
            }
            progress.finish();
            scene_->gravity = gravity;
            scene_->mass_damping = damping;
            scene_->friction = friction;
            scene_->loads = loads;
            scene_->walls = walls;
            scene_->wall_velocity = wall_velocity;
        }
        set_initial_velocities(deck_, *scene_);
        reset_context();
        scene_->x_start = scene_->particles.x;
    }

    void reset_context() {
        StepContext<Dim> fresh;
        fresh.dt = now_.dt;
        fresh.grain_impulse.assign(scene_->grains.size(), Vec<Dim>::Zero());
        fresh.wall_impulse.assign(scene_->walls.size(), Vec<Dim>::Zero());
        now_ = fresh;
    }

    RunOutcome march() {
        const double end = deck_.time.end;
        Schedule frames(deck_.output.interval > 0.0 ? deck_.output.interval : end / 100.0);
        Schedule rows(deck_.output.history_interval > 0.0 ? deck_.output.history_interval : end / 1000.0);
        GrainTracker<Dim> tracker(*scene_, deck_);
        Observer<Dim> observer;
        Progress progress(options_.progress_terminal, end,
                          [&](const std::string& line) { writer_.log(line); });
        start_ = Clock::now();
        double last_row = 0.0;
        for (;;) {
            kick(*scene_, now_);
            const auto output_start = Clock::now();
            if (now_.first) observer.start(*scene_, now_);
            const bool last = now_.step >= n_steps_ || stop_requested();
            if (rows.due(now_.time, now_.dt) || last) {
                write_rows(observer, tracker, now_.time - last_row);
                last_row = now_.time;
            }
            if (frames.due(now_.time, now_.dt) || last) {
                make_frame(*scene_, now_, frame_);
                frame_ = writer_.add_frame(std::move(frame_));
            }
            progress.update(now_.step, now_.time, observer.residual_relative());
            now_.stages.output += seconds_since(output_start);
            if (last) break;
            drift(*scene_, now_);
        }
        progress.finish();
        return now_.step >= n_steps_ ? RunOutcome::done : RunOutcome::interrupted;
    }

    void write_rows(Observer<Dim>& observer, GrainTracker<Dim>& tracker, double elapsed) {
        const HistoryRow row = observer.history(*scene_, now_);
        writer_.add_history(row);
        if (record_) record_->history.push_back(row);
        for (const GrainRow& grain : tracker.rows(*scene_, now_, elapsed)) {
            writer_.add_grain(grain);
            if (record_) record_->grains.push_back(grain);
        }
        summary_.energy = row.energy;
        summary_.residual_relative = observer.residual_relative();
        summary_.momentum_error_linear = observer.momentum_error_linear();
        summary_.momentum_error_angular = observer.momentum_error_angular();
        if (row.energy.residual > 0.2 * row.energy.throughput && row.energy.residual > round_off_energy())
            throw SimulationError(unstable_message(row.energy));
    }

    /// Energy of strains of 1e-10: below it, what is left of a grain at rest is the round-off of its
    /// positions.
    double round_off_energy() const {
        double energy = 0.0;
        for (const Grain<Dim>& grain : scene_->grains) {
            const double speed = grain.shape->dx * grain.scale / now_.dt;  // no wave is faster
            energy += 1e-20 * grain.mass * speed * speed;
        }
        return energy;
    }

    /// Names the particle with the largest speed: where a run that gains energy is blowing up.
    std::string unstable_message(const EnergyBudget& energy) const {
        double largest = -1.0;
        int grain = 0, particle = 0;
        for (const Grain<Dim>& g : scene_->grains)
            for (int p = g.first; p < g.first + g.count; ++p)
                if (const double speed = scene_->particles.v[p].norm(); !(speed <= largest)) {
                    largest = speed;
                    grain = g.id;
                    particle = p - g.first;
                }
        return fmt::format(
            "grain {}, particle {}, step {} (t = {:.6g} s): energy has grown by {:.3g} J of {:.3g} J; "
            "the run is unstable, try a smaller time.safety or time.step",
            grain, particle, now_.step, now_.time, energy.residual, energy.throughput);
    }

    void close() {
        const auto output_start = Clock::now();
        writer_.flush();
        now_.stages.output += seconds_since(output_start);
        summary_.writer_seconds = writer_.busy_seconds();
        summary_.wall_seconds = seconds_since(start_);
        summary_.steps = now_.step;
        summary_.simulated_time = now_.time;
        const double particle_steps =
            static_cast<double>(summary_.n_particles * std::max<std::int64_t>(1, now_.step));
        summary_.ns_per_particle_step = 1e9 * (summary_.wall_seconds - now_.stages.output) / particle_steps;
        summary_.peak_memory_bytes = peak_memory_bytes();
        summary_.state_hash = state_hash(*scene_);
        const StageTimes& s = now_.stages;
        summary_.stages = {{"internal_forces", s.internal_forces},
                           {"loads", s.loads},
                           {"kick", s.kick},
                           {"contact", s.contact},
                           {"drift", s.drift},
                           {"output", s.output}};
        const double steps = static_cast<double>(std::max<std::int64_t>(1, now_.step));
        summary_.contact_per_step = {{"nodes", static_cast<double>(now_.contact_nodes) / steps},
                                     {"rows", static_cast<double>(now_.contacts) / steps},
                                     {"sweeps", static_cast<double>(now_.sweeps) / steps},
                                     {"searches", static_cast<double>(now_.searches) / steps}};
        if (now_.unconverged > 0)
            summary_.warnings.emplace_back(
                fmt::format(
                    "contact sweeps ended at contact.max_sweeps before contact.tolerance (first in step {})",
                    now_.first_unconverged),
                now_.unconverged);
        for (const auto& [text, count] : warnings_) summary_.warnings.emplace_back(text, count);
        writer_.log(fmt::format("{}: {} steps in {:.2f} s, {:.1f} ns per particle-step, state {}",
                                summary_.outcome, summary_.steps, summary_.wall_seconds,
                                summary_.ns_per_particle_step, summary_.state_hash));
        writer_.finish(summary_);
        if (record_) record_->summary = summary_;
    }

    const Deck& deck_;
    RunOptions options_;
    ResultWriter writer_;
    std::unique_ptr<Scene<Dim>> scene_;
    StepContext<Dim> now_;
    Frame frame_;
    std::int64_t n_steps_ = 0;
    Summary summary_;
    RunRecord* record_ = nullptr;
    std::map<std::string, std::int64_t> warnings_;
    Clock::time_point start_ = Clock::now();
};

}  // namespace

RunOutcome run_deck(const Deck& deck, const RunOptions& options, RunRecord* record) {
    if (options.threads > 0) parallel::set_threads(options.threads);
    if (deck.dimension == 2) return Run<2>(deck, options).go(record);
    return Run<3>(deck, options).go(record);
}

}  // namespace quern
