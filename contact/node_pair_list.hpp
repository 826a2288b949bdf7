// Which nodes may touch: a Verlet list with a skin over a cell list.
//
// A row is a node that takes part; its entries are the walls, the nodes of other grains, and the nodes of its
// own grain beyond a crack that may come within R before the next search. Every pair stands in the rows of
// both nodes, so that each row computes what its own node receives and nothing is written twice. The list
// serves until a node of it has moved by half the skin (its displacement since the search, not the sum of its
// ways), or a wall has.
//
// Rows: `surface`   nodes within 1.5 spacings of a surface node of the reference shape, two layers: a node
// that has
//                   been forced between two nodes of the first layer is met by the second one. Deeper nodes
//                   are more than R away from all that has not gone through two layers. All nodes of a grain
//                   with broken bonds: any of them may be at a new surface.
//       `all`       every node.
//
// In a grain with broken bonds, two of its nodes are a pair if the bond between them is broken, or if they
// were never bonded: what has been beyond the horizon in the reference shape meets only if a piece of the
// grain has come round.
#pragma once

#include <cstdint>

#include "contact/node_pair_law.hpp"
#include "contact/point_cells.hpp"

namespace quern {

/// What contact between nodes knows beside positions and velocities.
template <int Dim>
struct PairMemory {
    std::vector<std::int64_t> particle, partner;  ///< of tangential springs that hold something
    std::vector<Vec<Dim>> slip;                   ///< their displacements [m]
    std::vector<Vec<Dim>> wall_velocity;          ///< [n_walls] of the step before [m/s]
};

template <int Dim>
class NodePairList {
  public:
    NodePairList(const CartesianGrid<Dim>& grid, const NodePairLaw<Dim>& law)
        : grid_(grid), nearest_(grid), law_(&law) {}

    /// Searches if the list no longer serves. True if it did.
    bool update(const ContactScene<Dim>& scene);
    /// All broken bonds of a grain, ascending. Energy [J; 2D: J/m] of the springs that begin where nodes are
    /// already nearer than R.
    double set_broken(const ContactScene<Dim>& scene, int grain, std::vector<BrokenBond> bonds);

    /// Fills all but wall_velocity; `recall` gives it to the next search, which must be the first thing then.
    void save(PairMemory<Dim>& memory) const;
    void recall(const PairMemory<Dim>& memory, std::size_t n_particles);

    int n_rows() const { return static_cast<int>(particle_.size()); }
    int particle(int row) const { return particle_[row]; }
    int grain(int row) const { return grain_[row]; }
    int row_of(int particle) const { return row_of_[particle]; }
    /// Rows that have entries, ascending; those of a grain are [first, last) of them.
    const std::vector<int>& listed() const { return listed_; }
    std::pair<int, int> listed_of(int grain) const {
        return {grain_listed_[grain], grain_listed_[grain + 1]};
    }
    /// Rows of a grain are [first, last).
    std::pair<int, int> rows_of(int grain) const { return {grain_rows_[grain], grain_rows_[grain + 1]}; }
    /// Entries of a row are [first, last): walls first.
    std::pair<int, int> entries_of(int row) const { return {first_[row], first_[row + 1]}; }
    /// The other node; -1 - wall for a wall.
    int partner(int entry) const { return partner_[entry]; }
    double radius(int entry) const { return radius_[entry]; }        ///< R [m]
    double stiffness(int entry) const { return stiffness_[entry]; }  ///< k_n = K V_i V_j [N/m; 2D: N/m^2]
    /// Tangential displacement of the row's node against the partner, kept from search to search [m].
    Vec<Dim>& slip(int entry) { return slip_[entry]; }
    bool keeps_slip() const { return law_->options().friction_law == PairFriction::history; }
    const NearestImage<Dim>& nearest() const { return nearest_; }

  private:
    struct Found {
        int partner;
        double radius, stiffness;
        Vec<Dim> slip;
    };
    /// Rows of a block and what they found.
    struct Block {
        std::vector<Found> found;
        std::vector<int> count;
    };
    static constexpr int rows_per_block = 64;

    bool serves(const ContactScene<Dim>& scene);
    void search(const ContactScene<Dim>& scene);
    void choose_rows(const ContactScene<Dim>& scene);
    void find_partners(const ContactScene<Dim>& scene, int row, Block& block) const;
    bool parted(const ContactScene<Dim>& scene, int grain, int node, int other) const;
    const std::vector<int>& surface_nodes(const Shape<Dim>& shape);
    double skin() const { return law_->options().skin * law_->largest_radius(); }
    bool broken(int grain) const {
        return static_cast<std::size_t>(grain) < broken_.size() && !broken_[grain].empty();
    }

    CartesianGrid<Dim> grid_;
    NearestImage<Dim> nearest_;
    const NodePairLaw<Dim>* law_;
    std::vector<std::pair<const Shape<Dim>*, std::vector<int>>> surface_nodes_;  // of each shape
    std::vector<std::vector<BrokenBond>> broken_;                                // [n_grains]

    // Of the last search.
    bool searched_ = false, outdated_ = false;
    double check_at_ = 0.0;              // of `travelled` [m]
    double search_by_ = 0.0;             // of `travelled`, for new cracks [m]
    std::vector<Vec<Dim>> x_;            // [n_rows] positions then
    std::vector<Vec<Dim>> wall_x_;       // [n_walls]
    std::vector<int> particle_, grain_;  // [n_rows]
    std::vector<int> grain_rows_;        // [n_grains + 1]
    std::vector<int> listed_, grain_listed_;
    std::vector<int> row_of_;  // [n] or -1
    std::vector<int> first_, partner_;
    std::vector<double> radius_, stiffness_;
    std::vector<Vec<Dim>> slip_;  // empty without history
    PointCells<Dim> cells_;
    std::vector<Block> blocks_;

    // Of the search before, while searching.
    std::vector<int> old_row_of_, old_first_, old_partner_;
    std::vector<Vec<Dim>> old_slip_;
};

}  // namespace quern
