#include "src/sim/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>

#include "grid/error.hpp"
#include "grid/parallel.hpp"
#include "quern_version.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/progress.hpp"
#include "src/results/stop_signals.hpp"
#include "src/results/writer.hpp"
#include "src/sim/checkpoint.hpp"
#include "src/sim/observation.hpp"
#include "src/sim/observe.hpp"
#include "src/sim/reactions.hpp"
#include "src/sim/step.hpp"

namespace quern {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of this program alone; getrusage() would count that of the process which has started it, too.
double peak_memory_bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        double kilobytes = 0.0;
        if (word == "VmHWM:" && status >> kilobytes) return 1024.0 * kilobytes;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

/// Rows or frames that fall due every `interval` seconds, and at the start.
class Schedule {
  public:
    explicit Schedule(double interval) : interval_(interval) {}
    void pass(Checkpoint& checkpoint) { checkpoint.value("next due", next_); }
    bool is_due(double time, double dt) const { return time >= next_ - 0.5 * dt; }
    bool due(double time, double dt) {
        if (!is_due(time, dt)) return false;
        while (next_ <= time + 0.5 * dt) next_ += interval_;
        return true;
    }

  private:
    double interval_, next_ = 0.0;
};

/// A run that goes on.
struct Stopped {
    Checkpoint checkpoint;  ///< its origin has been read
    std::string refused;    ///< why it is not the last one; empty: it is
};

template <int Dim>
class Run {
  public:
    /// `stopped`: goes on from there.
    Run(const Deck& deck, const RunOptions& options, const RunOrigin& origin, Stopped* stopped)
        : deck_(deck),
          options_(options),
          origin_(origin),
          resumed_(stopped != nullptr),
          scene_(make_scene<Dim>(deck)),
          frames_(deck.output.interval > 0.0 ? deck.output.interval : deck.time.end / 100.0),
          rows_(deck.output.history_interval > 0.0 ? deck.output.history_interval : deck.time.end / 1000.0) {
        reset_context();
        WriterOptions files = writer_options();
        if (stopped) {
            tracker_.emplace(*scene_, deck_);
            files.resumed.emplace();
            files.resumed->tables_bytes.resize(files.tables.size());
            pass(stopped->checkpoint, *files.resumed);
        }
        writer_.emplace(files);
        if (stopped && !stopped->refused.empty()) warn(stopped->refused + "; the checkpoint before is used");
        summary_.version = QUERN_VERSION;
        summary_.title = deck.title;
        summary_.dimension = Dim;
        summary_.threads = parallel::n_threads();
        summary_.instructions = batch_loops(deck.compute.instructions).name;
        summary_.deck_hash = origin.deck_hash;
        if (!resumed_) {
            writer_->write_text("deck.resolved.yaml", resolved_yaml(deck));
            write_strengths();
        }
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
            if (resumed_) {
                writer_->log(fmt::format("goes on from step {}, t = {:.6g} s", now_.step, now_.time));
            } else {
                prepare();
                tracker_.emplace(*scene_, deck_);
            }
            outcome = march();
            summary_.outcome = outcome == RunOutcome::done ? "done" : "interrupted";
        } catch (const SimulationError& error) {
            std::string message = error.what();
            if (now_.dt > summary_.stable_step)
                message += fmt::format(" (time.step {:.4g} s is above the stable step {:.4g} s)", now_.dt,
                                       summary_.stable_step);
            summary_.outcome = "failed: " + message;
            writer_->log(summary_.outcome);
            close();
            throw SimulationError(message);
        }
        close();
        return outcome;
    }

  private:
    WriterOptions writer_options() const {
        WriterOptions out;
        out.directory = options_.directory;
        out.dimension = Dim;
        out.vtp = deck_.output.vtp;
        out.fragments = !scene_->fragments.of_particle.empty();
        if (deck_.observe.on) out.tables = observed_layouts(deck_);
        out.title = deck_.title;
        for (int a = 0; a < Dim; ++a) out.domain.push_back(deck_.grid.origin[a]);
        for (int a = 0; a < Dim; ++a) out.domain.push_back(deck_.grid.origin[a] + deck_.grid.extent[a]);
        const std::array<bool, 3>& repeats = deck_.grid.periodic;
        if (std::find(repeats.begin(), repeats.end(), true) != repeats.end())
            for (int a = 0; a < Dim; ++a) out.periods.push_back(repeats[a] ? deck_.grid.extent[a] : 0.0);
        return out;
    }

    /// All that the rest of the run depends on.
    void pass(Checkpoint& checkpoint, ResultPosition& position) {
        std::int64_t shapes = shapes_hash(*scene_);
        checkpoint.value("shapes", shapes);
        if (shapes != shapes_hash(*scene_))
            throw InputError(options_.directory, "other meshes or shapes than at the checkpoint",
                             "the files that the run began with");
        pass_position(checkpoint, position);
        pass_state(checkpoint, *scene_, now_);
        observer_.pass(checkpoint);
        tracker_->pass(checkpoint);
        frames_.pass(checkpoint);
        rows_.pass(checkpoint);
        checkpoint.value("last row", last_row_);
        StageTimes& s = now_.stages;
        for (double* seconds : {&s.internal_forces, &s.loads, &s.kick, &s.contact, &s.drift, &s.output})
            checkpoint.value("stage seconds", *seconds);
        if (scene_->points) checkpoint.value("stage seconds", s.points);
        checkpoint.value("wall seconds", earlier_seconds_);
    }

    void save() {
        Checkpoint checkpoint;
        pass_origin(checkpoint, origin_);
        ResultPosition position = writer_->position();
        const double before = earlier_seconds_;
        earlier_seconds_ += seconds_since(start_);
        pass(checkpoint, position);
        earlier_seconds_ = before;
        write_checkpoint(options_.directory, checkpoint);
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
        if (scene_->held_in_part > 0)
            warn(fmt::format(
                "{} particles are held along some axes only: contact on the grid gives way there as "
                "if they were free; hold all axes, or make them dense",
                scene_->held_in_part));
    }

    void host_line() {
        char host[256] = "unknown";
        gethostname(host, sizeof host - 1);
        writer_->log(
            fmt::format("Quern {} on {}, {} threads: {}", QUERN_VERSION, host, summary_.threads, deck_.file));
        writer_->log(
            fmt::format("{} grains, {} particles, {} bonds; time step {:.6g} s (stable {:.6g} s), {} steps",
                        summary_.n_grains, summary_.n_particles, summary_.n_bonds, summary_.time_step,
                        summary_.stable_step, n_steps_));
        if (scene_->n_cut > 0) writer_->log(fmt::format("cracks cut {} bonds", scene_->n_cut));
    }

    /// Where the strength differs from grain to grain.
    void write_strengths() {
        if (std::none_of(deck_.materials.begin(), deck_.materials.end(),
                         [](const Material& material) { return material.strength.has_value(); }))
            return;
        std::string text = "grain,strength,critical_stretch\n";
        for (const int g : scene_->grain_of_id) {
            if (scene_->point_grain(g) >= 0) continue;
            const Grain<Dim>& grain = scene_->grains[g];
            const double stretch = std::visit(
                [&](const auto& model) {
                    return model.break_limit().stretch_of(grain.scale, grain.strength);
                },
                scene_->group_of(g).model);
            text += fmt::format("{},{},{}\n", grain.id, grain.strength, stretch);
        }
        writer_->write_text("strength.csv", text);
    }

    void warn(const std::string& text) {
        ++warnings_[text];
        writer_->log("warning: " + text);
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
            const std::vector<std::optional<Servo>> servos = scene_->servos;
            std::fill(scene_->servos.begin(), scene_->servos.end(), std::nullopt);
            const std::vector<Constraint<Dim>> constraints = scene_->constraints;
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
            for (Constraint<Dim>& constraint : scene_->constraints)
                for (auto& velocity : constraint.velocity)
                    if (velocity) velocity = Expression();
            const auto steps = static_cast<std::int64_t>(std::ceil(deck_.prepare.duration / now_.dt));
            Progress progress(options_.progress_terminal, deck_.prepare.duration,
                              [&](const std::string& line) { writer_->log("prepare: " + line); });
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
            scene_->servos = servos;
            scene_->constraints = constraints;
        }
        set_initial_velocities(deck_, *scene_);
        reset_context();
        scene_->x_start = scene_->particles.x;
    }

    void reset_context() { now_ = make_context(*scene_, now_.dt); }

    RunOutcome march() {
        Progress progress(options_.progress_terminal, deck_.time.end,
                          [&](const std::string& line) { writer_->log(line); });
        start_ = Clock::now();
        const std::int64_t first_step = now_.step;
        for (;;) {
            const bool stop = stop_requested(), last = now_.step >= n_steps_ || stop;
            const bool due = deck_.output.checkpoint.every > 0 &&
                             now_.step % deck_.output.checkpoint.every == 0 && now_.step > first_step;
            if ((stop || due) && !now_.first) save();
            now_.listing = deck_.observe.on && (last || frames_.is_due(now_.time, now_.dt));
            kick(*scene_, now_);
            const auto output_start = Clock::now();
            if (now_.first) observer_.start(*scene_, now_);
            if (rows_.due(now_.time, now_.dt) || last) {
                write_rows(now_.time - last_row_);
                last_row_ = now_.time;
            }
            if (frames_.due(now_.time, now_.dt) || last) {
                make_frame(*scene_, now_, frame_);
                write_fragments();
                std::vector<TableRows> tables;
                if (deck_.observe.on) tables = observe(deck_, *scene_, now_, frame_);
                if (record_ && deck_.observe.on) record_->observed.push_back(tables);
                frame_ = writer_->add_frame(std::move(frame_), std::move(tables));
            }
            progress.update(now_.step, now_.time, observer_.residual_relative());
            now_.stages.output += seconds_since(output_start);
            if (last) break;
            drift(*scene_, now_);
        }
        progress.finish();
        return now_.step >= n_steps_ ? RunOutcome::done : RunOutcome::interrupted;
    }

    void write_rows(double elapsed) {
        const HistoryRow row = observer_.history(*scene_, now_);
        writer_->add_history(row);
        if (record_) record_->history.push_back(row);
        for (const GrainRow& grain : tracker_->rows(*scene_, now_, elapsed)) {
            writer_->add_grain(grain);
            if (record_) record_->grains.push_back(grain);
        }
        summary_.reactions = reaction_rows(deck_, *scene_, now_, elapsed);
        for (const ReactionRow& reaction : summary_.reactions) {
            writer_->add_reaction(reaction);
            if (record_) record_->reactions.push_back(reaction);
        }
        summary_.energy = row.energy;
        summary_.residual_relative = observer_.residual_relative();
        summary_.momentum_error_linear = observer_.momentum_error_linear();
        const std::array<bool, 3>& periodic = deck_.grid.periodic;
        const bool turns = std::find(periodic.begin(), periodic.end(), true) == periodic.end();
        summary_.momentum_error_angular =
            turns ? observer_.momentum_error_angular() : std::numeric_limits<double>::quiet_NaN();
        if (row.energy.residual > 0.2 * row.energy.throughput && row.energy.residual > round_off_energy())
            throw SimulationError(unstable_message(row.energy));
    }

    void write_fragments() {
        summary_.fragments = fragment_rows(*scene_, now_, frame_);
        for (const FragmentRow& row : summary_.fragments) {
            writer_->add_fragment(row);
            if (record_) record_->fragments.push_back(row);
        }
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
        writer_->flush();
        now_.stages.output += seconds_since(output_start);
        summary_.writer_seconds = writer_->busy_seconds();
        summary_.wall_seconds = earlier_seconds_ + seconds_since(start_);
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
        if (scene_->points) summary_.stages.insert(summary_.stages.begin() + 4, {"points", s.points});
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
        if (now_.unstable > 0)
            summary_.warnings.emplace_back(fmt::format("time step {:.4g} s is above the stable step {:.4g} s "
                                                       "of the contacts found (first in step "
                                                       "{})",
                                                       now_.dt, now_.least_stable_step, now_.first_unstable),
                                           now_.unstable);
        for (const auto& [text, count] : warnings_) summary_.warnings.emplace_back(text, count);
        writer_->log(fmt::format("{}: {} steps in {:.2f} s, {:.1f} ns per particle-step, state {}",
                                 summary_.outcome, summary_.steps, summary_.wall_seconds,
                                 summary_.ns_per_particle_step, summary_.state_hash));
        writer_->finish(summary_);
        if (record_) record_->summary = summary_;
    }

    const Deck& deck_;
    RunOptions options_;
    RunOrigin origin_;
    bool resumed_;
    std::unique_ptr<Scene<Dim>> scene_;
    StepContext<Dim> now_;
    std::optional<GrainTracker<Dim>> tracker_;
    Observer<Dim> observer_;
    Schedule frames_, rows_;
    double last_row_ = 0.0;         ///< time of it [s]
    double earlier_seconds_ = 0.0;  ///< of the run before it was stopped
    std::optional<ResultWriter> writer_;
    Frame frame_;
    std::int64_t n_steps_ = 0;
    Summary summary_;
    RunRecord* record_ = nullptr;
    std::map<std::string, std::int64_t> warnings_;
    Clock::time_point start_ = Clock::now();
};

RunOutcome run(const Deck& deck, const RunOptions& options, const RunOrigin& origin, Stopped* stopped,
               RunRecord* record) {
    if (options.threads > 0) parallel::set_threads(options.threads);
    if (deck.dimension == 2) return Run<2>(deck, options, origin, stopped).go(record);
    return Run<3>(deck, options, origin, stopped).go(record);
}

}  // namespace

RunOutcome run_deck(const Deck& deck, const RunOptions& options, RunRecord* record) {
    const std::filesystem::path folder = std::filesystem::absolute(deck.file).parent_path();
    return run(deck, options, {folder.string(), deck_hash(deck)}, nullptr, record);
}

RunOutcome resume_run(const RunOptions& options, RunRecord* record) {
    Stopped stopped;
    stopped.checkpoint = read_checkpoint(options.directory, stopped.refused);
    RunOrigin origin;
    pass_origin(stopped.checkpoint, origin);
    const std::string file = options.directory + "/deck.resolved.yaml";
    Deck deck = read_deck(file);
    if (deck_hash(deck) != origin.deck_hash)
        throw InputError(file, "a deck that was changed", "the one that the run began with");
    for (ShapeDeck& shape : deck.shapes)
        if (!shape.file.empty()) shape.file = (std::filesystem::path(origin.folder) / shape.file).string();
    return run(deck, options, origin, &stopped, record);
}

}  // namespace quern
