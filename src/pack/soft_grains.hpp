// Soft grains that push each other apart until none overlap, or until they are jammed.
#pragma once

#include <vector>

#include "src/pack/grains.hpp"
#include "src/pack/overlap.hpp"
#include "src/pack/portable_math.hpp"

namespace quern {

/// Grains of a size times a common factor, with the energy of their overlaps [m^2]
///
///     E = 1/2 sum_contacts sum_points d^2        d: depth of a point of contact [m]
///
/// whose gradient drives centres and angles. Minimised by FIRE (Bitzek, Koskinen, Gaehler, Moseler, Gumbsch
/// 2006, doi 10.1103/PhysRevLett.97.170201) with masses as the sizes, since large grains have many contacts.
class SoftGrains {
  public:
    explicit SoftGrains(PackedGrains grains);

    void set_factor(double factor);
    double factor() const { return factor_; }
    const PackedGrains& grains() const { return grains_; }
    void set_places(const PackedGrains& from);  ///< centres and angles

    enum class Rest { free, jammed, unfinished };
    /// free: no overlap is deeper than `slack` times the sum of the inner radii, so that grains smaller by
    /// this part do not overlap at all; jammed: forces are in balance; unfinished: neither after so many
    /// steps.
    Rest relax(int max_steps);
    static constexpr double slack = 1e-4;

    /// Overlaps as they are, without moving anything; centres may lie on open edges.
    void look() { compute_forces(0.0); }
    double energy() const { return energy_; }
    int n_contacts() const { return n_contacts_; }  ///< between grains
    double deepest() const { return deepest_; }     ///< relative, as in relax()

    /// Exchanges the places of grains of similar size where that lowers the energy: one attempt a grain.
    /// `reach`: how far apart in the order of sizes they may be, as part of all grains. Returns how many.
    int exchange(portable::Random& random, double reach);

  private:
    void make_pairs();
    /// Centres keep away from open edges by `margin` inner radii.
    void compute_forces(double margin);
    void add_force(int i, double nx, double ny, double x, double y);
    double energy_of(int i, int but) const;
    double pair_energy(int i, int j) const;
    int cell_of(int i) const;
    double inner(int i) const { return grains_.outline_of(i).inner * grains_.size[i]; }

    PackedGrains grains_;
    double factor_ = 1.0, mean_size_ = 0.0, skin_ = 0.0;
    bool turning_ = false;
    TurnedCorners corners_;
    std::vector<int> by_size_;                   ///< grains in the order of sizes
    std::vector<int> pair_first_, pair_second_;  ///< neighbours j > i of grain i
    std::vector<double> pair_x_, pair_y_;        ///< centres when pairs were made
    int n_cells_[2] = {1, 1};
    std::vector<int> cell_first_, cell_grain_, slot_;  ///< grains by cell, and where each stands
    std::vector<double> fx_, fy_, torque_, vx_, vy_, spin_, weight_, turn_weight_;
    int n_contacts_ = 0;
    double energy_ = 0.0, deepest_ = 0.0, force_sum_ = 0.0, force_left_ = 0.0;
};

}  // namespace quern
