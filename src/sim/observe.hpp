// What a run reports: energy budget, momenta, tracked grains, frames, the hash of the state.
#pragma once

#include <cstdint>
#include <string>

#include "src/results/checkpoint_file.hpp"
#include "src/results/records.hpp"
#include "src/sim/step.hpp"

namespace quern {

/// Particles of a grain at the time of the positions: velocities are means of those half a step around it.
template <int Dim>
Particles<Dim> particles_now(const Scene<Dim>& scene, const StepContext<Dim>& now, const Grain<Dim>& grain);

/// Follows the budget and the momenta of a run. All is evaluated between kick and drift: positions are those
/// of time n, velocities are known half a step before and after.
///
/// Kinetic energy at time n is that of n-1/2 plus half of this step's work, forces taken with v(n-1/2). For
/// linear forces kinetic plus elastic energy is then exactly constant, so the residual shows errors, not the
/// half step between v and x.
template <int Dim>
class Observer {
  public:
    /// Remembers the state at the start of the clock. Call after the first kick.
    void start(const Scene<Dim>& scene, const StepContext<Dim>& now);

    HistoryRow history(const Scene<Dim>& scene, const StepContext<Dim>& now);

    void pass(Checkpoint& checkpoint);

    double residual_relative() const { return largest_residual_ / std::max(throughput_, tiny); }
    double momentum_error_linear() const { return momentum_error_ / std::max(momentum_scale_, tiny); }
    double momentum_error_angular() const { return angular_error_ / std::max(angular_scale_, tiny); }

  private:
    static constexpr double tiny = 1e-300;
    struct Momenta {
        Vec<Dim> linear = Vec<Dim>::Zero();
        Spin<Dim> angular = Spin<Dim>::Zero();
        double scale = 0, angular_scale = 0;
        double potential = 0;
        Momenta& operator+=(const Momenta& other);
    };
    Momenta momenta(const Scene<Dim>& scene) const;

    bool started_ = false;
    double start_energy_ = 0.0;
    Vec<Dim> start_linear_ = Vec<Dim>::Zero();
    Spin<Dim> start_angular_ = Spin<Dim>::Zero();
    double largest_residual_ = 0, throughput_ = 0;
    double momentum_error_ = 0, momentum_scale_ = 0, angular_error_ = 0, angular_scale_ = 0;
};

/// Unwraps the angles of tracked grains between rows.
template <int Dim>
class GrainTracker {
  public:
    explicit GrainTracker(const Scene<Dim>& scene, const Deck& deck);
    /// One row a tracked grain (position in Scene::grains given); zeroes its impulse. `elapsed`: time since
    /// the row before [s]. 3D: angle and omega are the components about z.
    std::vector<GrainRow> rows(const Scene<Dim>& scene, StepContext<Dim>& now, double elapsed);

    void pass(Checkpoint& checkpoint);

  private:
    std::vector<int> grains_;
    std::vector<double> angle_, omega_;
    std::vector<Mat<Dim>> rotation_;
};

/// Fills the arrays of `frame`, whose memory is kept.
template <int Dim>
void make_frame(const Scene<Dim>& scene, const StepContext<Dim>& now, Frame& frame);

/// Every fragment of a grain that can break, by number; `frame`: made of the same state.
template <int Dim>
std::vector<FragmentRow> fragment_rows(const Scene<Dim>& scene, const StepContext<Dim>& now,
                                       const Frame& frame);

/// FNV-1a over positions and velocities of all particles, grain by grain in the deck's order.
template <int Dim>
std::string state_hash(const Scene<Dim>& scene);

}  // namespace quern
