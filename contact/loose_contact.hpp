// Contact that needs no surface: debris against everything, and the two faces of a crack inside one piece.
//
// A particle of debris is a ball of its own volume, r = V^(1/n)/2 (n: dimension). It meets every particle q
// of other pieces, as a ball of q's volume, and the walls. Two particles of one piece whose bond of at
// most 1.5 dx is broken touch at 0.95 dx. One impulse a pair along the line of centres, one a wall, both with
// Coulomb friction but that of cracks; projected Gauss-Seidel, after the rule of the grid (n from p to q, d
// distance):
//
//     pair      J' = max(0, J + m (n.(v_p - v_q) - max(g, 0)/dt)),   g = d - r_p - r_q,  1/m = 1/m_p + 1/m_q
//               J_t' = projection onto |J_t| <= mu J' of J_t + (u_p - u_q)_t/W      (loose_friction.hpp)
//     wall      J' = max(0, J - m_p (n.(v_p - u) + max(g, 0)/dt)),   g = n.(x_p - x_w) - r_p
//               J_t' = projection onto |J_t| <= mu J' of J_t - m_p (v_p - u)_t
//
// Pieces that are bodies meet walls by the rule of the grid, which feels nothing of a piece narrower than a
// cell or two: of these no particle's centre passes a wall (the same law with r_p = 0).
//
//     J, J_t [N s; 2D: N s/m], m [kg; 2D: kg/m], g, d, r [m], mu no unit, u velocity of the wall [m/s]
//
// Pairs push apart along their line and never pull, and what rubs passes on its moment: momentum and moment
// of momentum are exact, energy falls, nothing sticks. Impulses do not undo an overlap, so nothing is thrown.
// Surfaces of balls are not flat: what slides over a lattice is held by its hollows as well. Our own; faces
// of a crack as in PeriDEM (Jha, Desai, Bhattacharya, Lipton, J. Mech. Phys. Solids 151 (2021) 104376,
// section 2.2: nodes of one grain without a bond repel at 0.95 of the spacing, without friction), with
// impulses in the place of springs. What slides along a crack by more than a bond can reach is not found
// again while the piece holds together.
#pragma once

#include <vector>

#include "contact/bodies.hpp"
#include "contact/contact_list.hpp"
#include "contact/loose_friction.hpp"
#include "contact/point_cells.hpp"

namespace quern {

template <int Dim>
class LooseContact {
  public:
    LooseContact(const CartesianGrid<Dim>& grid, const GridContactOptions& options)
        : grid_(grid), nearest_(grid), options_(options) {}

    /// Bodies are others than before: search anew.
    void forget() { searched_ = false; }

    /// What can touch in this step, before the rule of the grid. `scene` and `trial` are those of the bodies.
    void find(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
              const ContactTrial<Dim>& trial);
    /// After the rule: changes trial.v and adds to the report, whose impulses are those of grains.
    void add_impulses(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                      const ContactTrial<Dim>& trial, ContactReport<Dim>& report);
    /// Appends the pairs of the last step that press; of bodies and pieces of debris, as ContactBodies counts
    /// them.
    void list_contacts(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                       std::vector<ContactPoint<Dim>>& points) const;

  private:
    /// Two particles, or one and a wall (q = -1 - wall).
    struct Row {
        int p = 0, q = 0;
        Vec<Dim> n = Vec<Dim>::Zero();  ///< from p to q; out of the wall
        double mass = 0.0, gap_speed = 0.0;
        double J = 0.0;
        Vec<Dim> J_t = Vec<Dim>::Zero();
        int rub = -1;  ///< of LooseFriction; -1: no friction between the two
    };
    /// Rows in_islands_[first, last), which share no particle with others.
    struct Island {
        int first, last;
        double change = 0.0, total = 0.0;  ///< of the impulses, in a sweep [N s]
    };

    void search(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene);
    bool make_row(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, const CrackPair& near,
                  Row& row) const;
    /// visit(particle) for all that a row moves.
    template <class Visit>
    void for_each_moved(const Row& row, Visit&& visit) const {
        visit(row.p);
        if (row.q >= 0) visit(row.q);
        if (row.rub >= 0) friction_.for_each_moved(row.rub, visit);
    }
    void make_islands(std::size_t n_particles);
    void sweep(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, bool forwards, Island& island);
    double update(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, Row& row) const;
    void book(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
              const ContactTrial<Dim>& trial, ContactReport<Dim>& report) const;

    CartesianGrid<Dim> grid_;
    NearestImage<Dim> nearest_;
    GridContactOptions options_;

    std::vector<double> radius_;  // [n] of the particles as balls [m]

    // Of the last search.
    bool searched_ = false;
    double search_at_ = 0.0;       // of `travelled` [m]
    std::vector<CrackPair> near_;  // pairs with debris in them, ascending; then what is near walls
    PointCells<Dim> cells_;
    LooseFriction<Dim> friction_;

    // Of this step.
    std::vector<Row> found_;  // [cracks and near_], mass 0: do not touch
    std::vector<Row> rows_;
    std::vector<int> in_islands_;  // rows, island by island
    std::vector<Island> islands_;
    std::vector<int> touched_;                      // particles with rows, ascending
    std::vector<Vec<Dim>> v_trial_, v_after_grid_;  // of those, before and after the rule of the grid
    std::vector<int> root_, island_of_;             // [n] while islands are made
};

}  // namespace quern
