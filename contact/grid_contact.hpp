// Contact on the background grid: nodes, rule and coupling put together.
//
//     coupling impulse   particles keep their velocities; only contact impulses pass through the grid:
//                        dv_p from the pair rule, or sum_a N_ap (v~_a - v_a) from the seed rule
//     coupling flip      the whole motion passes through the grid, as in FLIP and MPM:
//                        v_p += sum_a N_ap (v~_a - v_a^n),  x_p moves with sum_a N_ap v~_a
//
// v_a^n and v_a: nodal velocities before and after this step's forces, v~_a: after contact. Seed with impulse
// removes about half of the approach only and acts as a dashpot; flip loses spin. Both are kept to be
// compared.
//
// Grains that have come apart are several bodies (bodies.hpp); what is too small for the grid, and the faces
// of cracks that end inside a piece, are loose contact (loose_contact.hpp).
#pragma once

#include "contact/bodies.hpp"
#include "contact/contact_nodes.hpp"
#include "contact/loose_contact.hpp"
#include "contact/pair_rule.hpp"

namespace quern {

template <int Dim>
class GridContact {
  public:
    GridContact(const CartesianGrid<Dim>& grid, const GridContactOptions& options);

    /// Changes trial.v (and sets trial.drift in the flip coupling). Positions must be inside the grid.
    const ContactReport<Dim>& add_impulses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);

    /// Appends the contacts of the last step, which `scene` was given to; impulses last ContactTrial::dt, or
    /// half of it in the first kick.
    void list_contacts(const ContactScene<Dim>& scene, std::vector<ContactPoint<Dim>>& points);

    /// What has become of a grain that has lost bonds: piece [n] as of particles/pieces.hpp, and all its
    /// broken bonds.
    void set_pieces(const ContactScene<Dim>& scene, int grain, std::span<const int> piece,
                    std::span<const BrokenBond> broken);

    const GridContactOptions& options() const { return options_; }

    /// True if positions move with ContactTrial::drift instead of the particle velocities.
    bool moves_with_grid() const { return options_.coupling == GridCoupling::flip; }

  private:
    void apply_rule(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);
    void to_slots(std::span<const Vec<Dim>> v, std::vector<Vec<Dim>>& nodal) const;
    void solve_on_nodes(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);

    GridContactOptions options_;
    ContactNodes<Dim> nodes_;
    PairRule<Dim> pair_;
    ContactBodies<Dim> bodies_;
    LooseContact<Dim> loose_;
    std::vector<Vec<Dim>> nodal_before_, nodal_trial_, nodal_;  ///< [n_slots]
    std::vector<Vec<Dim>> v_trial_;                             ///< [n] impulse coupling of nodal rules
    std::vector<Vec<Dim>> received_;  ///< [n_grains] broken ones in all their pieces
    ContactReport<Dim> report_;
};

}  // namespace quern
