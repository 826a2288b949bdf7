// The pair rule: one impulse a pair of grains and node, by projected Gauss-Seidel. Contacts of the surface
// rule (surface_rule.hpp) are rows of the same sweeps, with patches (patch.hpp) in the place of slots.
//
// Impulse map of a slot (particles p around node a, r_p = x_p - xb, w = N^2 at the surface, q N^2 inside,
// m = sum m_p w_p; N^2 couples neighbouring nodes less than N, so that contact is less stiff and the sweeps
// converge faster):
//
//     dv_p = w_p B_p J,   B_p J = J/m + (Y (r x J)) x r_p,   r = x_c - xb,   Y = (sum m_p w_p (|r_p|^2 1 -
//     r_p r_p^T))^-1
//
// so both grains of a pair receive their impulse at the one point x_c: momentum and angular momentum are
// exact. The velocity that the pair compares is the adjoint, u = sum m_p w_p B_p^T v_p, hence contact never
// raises the kinetic energy, and the inverse mass is exact: W = sum m_p w_p^2 B_p^T B_p of A plus that of B.
//
//     normal     J_n' = max(0, J_n + (n.(u_A - u_B) - max(g, 0)/dt) / (n.W n))
//     friction   J_t' = projection onto |J_t| <= mu J_n' of J_t + T^T (u_A - u_B) / lambda_max(T^T W T)
//
// +J acts on B, -J on A; J in [N s], 2D: per metre of thickness. Bardenhagen, Brackbill, Sulsky 1998,
// eqs 12-23, compare each grain with the centre of mass of all grains at the node along a normal of its own;
// for two grains, one common normal and lumped mass the two agree. Here grains meet in pairs, the inverse
// mass is exact, and approach across a gap g is free up to g/dt.
//
// Where a patch cannot turn (one particle, B_p J = J/m), x_c is its centre; where neither can, n is the line
// of their centres and there is no friction: no other impulse keeps the angular momentum of two points.
//
// In the flip coupling the same rows act on nodal velocities: W = 1/m_A + 1/m_B, no lever.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "contact/contact_list.hpp"
#include "contact/contact_nodes.hpp"
#include "contact/patch.hpp"
#include "contact/surface_rule.hpp"

namespace quern {

template <int Dim>
struct PairRow {
    int a = -1, b = -1;  ///< slots; b = -1: a wall
    int wall = -1;
    int patch_a = -1, patch_b = -1;  ///< of the page, in the place of the slots; -1: none
    Vec<Dim> n = Vec<Dim>::Zero(), u_wall = Vec<Dim>::Zero();
    Vec<Dim> r_a = Vec<Dim>::Zero(), r_b = Vec<Dim>::Zero();  ///< x_c - xb of each slot [m]
    Vec<Dim> point = Vec<Dim>::Zero();                        ///< x_c from the node of slot a [m]
    Mat<Dim> W = Mat<Dim>::Zero();                            ///< inverse mass [1/kg]
    double W_n = 0.0, W_t = 0.0;                              ///< n.W n, lambda_max(T^T W T)
    double gap_speed = 0.0;                                   ///< allowed approach speed [m/s]
    double mu = 0.0;
    double J_n = 0.0;
    Vec<Dim> J_t = Vec<Dim>::Zero();
};

template <int Dim>
class PairRule {
  public:
    explicit PairRule(const GridContactOptions& options)
        : options_(options), at_surfaces_(options.rule == GridRule::surface || options.exact_walls) {}

    /// Nodes, slots and rows of this step. Rows that no speed present can close are left out.
    void prepare(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);
    /// A shape that no grain has any more.
    void forget(const Shape<Dim>& shape) { footprints_.erase(&shape); }
    /// Impulse coupling: solves on particle velocities `trial.v` in place. Flip coupling: on `nodal`, the
    /// velocities of the slots. Adds works and impulses to `report`.
    void solve_particles(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                         const ContactTrial<Dim>& trial, ContactReport<Dim>& report);
    void solve_nodal(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                     std::vector<Vec<Dim>>& nodal, const std::vector<Vec<Dim>>& nodal_before,
                     ContactReport<Dim>& report);
    /// Appends the rows of the last step that press.
    void list_contacts(const ContactNodes<Dim>& nodes, std::vector<ContactPoint<Dim>>& points) const;

  private:
    struct PageReport {                    ///< of the rows of one page
        double change = 0.0, total = 0.0;  ///< of one sweep
        double normal_work = 0.0, friction_work = 0.0, wall_work = 0.0;
        std::vector<Vec<Dim>> wall_impulse;
        std::vector<Spin<Dim>> wall_moment;
    };

    void choose_nodes(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene);
    double free_path(std::span<const Slot<Dim>> slots, const ContactScene<Dim>& scene,
                     const CartesianGrid<Dim>& grid) const;
    void make_rows(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int page);
    void add_pair(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int a, int b,
                  int page);
    void add_wall(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int a, int wall,
                  int page);
    /// The row of a contact, unless no speed present can close its gap.
    void add_row(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, PairRow<Dim> row,
                 const Tile<Dim>& tile, const SurfaceContact<Dim>* at_surface, int page);
    void use_slots(const ContactNodes<Dim>& nodes, PairRow<Dim>& row) const;
    void use_patches(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                     const SurfaceContact<Dim>& contact, PairRow<Dim>& row, Patches<Dim>& patches) const;
    void know_surfaces(const ContactScene<Dim>& scene);
    void know_surface(const ContactScene<Dim>& scene, int grain);
    template <class Field>
    Vec<Dim> velocity(const Field& field, const ContactNodes<Dim>& nodes, std::size_t page, int slot,
                      int patch, const Vec<Dim>& r) const;
    template <class Field>
    void add_impulse(Field& field, const ContactNodes<Dim>& nodes, std::size_t page, int slot, int patch,
                     const Vec<Dim>& r, const Vec<Dim>& J) const;
    SurfaceSide<Dim> surface_side(const ContactNodes<Dim>& nodes, int slot,
                                  const ContactScene<Dim>& scene) const {
        return surface_side(nodes.slots()[slot], scene, nodes.grid());
    }
    SurfaceSide<Dim> surface_side(const Slot<Dim>& slot, const ContactScene<Dim>& scene,
                                  const CartesianGrid<Dim>& grid) const {
        return {&slot,   &scene.grains[slot.grain], &rotation_[slot.grain],        footprints_of_[slot.grain],
                scene.x, surface_points_,           grid.node_position(slot.index)};
    }
    TileSide<Dim> side(const Slot<Dim>& slot, const ContactScene<Dim>& scene) const {
        return {&slot, &scene.grains[slot.grain], &rotation_[slot.grain]};
    }
    template <class Field>
    void sweep(const ContactNodes<Dim>& nodes, Field& field, ContactReport<Dim>& report);
    template <class Before, class After>
    void add_work(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, const Before& before,
                  const After& after, ContactReport<Dim>& report);

    GridContactOptions options_;
    double reachable_speed_ = 0.0;    ///< of one slot against another in this step [m/s]
    std::vector<Mat<Dim>> rotation_;  ///< [n_grains] of grains with slots
    bool at_surfaces_;                ///< rows at surfaces are made
    std::map<const Shape<Dim>*, std::unique_ptr<Footprints<Dim>>> footprints_;
    std::vector<const Footprints<Dim>*> footprints_of_;  ///< [n_grains]
    std::vector<Vec<Dim>> surface_points_;               ///< [n] of grains with slots [m]
    std::vector<std::vector<PairRow<Dim>>> rows_;        ///< [n_pages] node after node
    std::vector<Patches<Dim>> patches_;                  ///< [n_pages] of rows at surfaces
    std::vector<PageReport> page_reports_;               ///< [n_pages]
    std::vector<Vec<Dim>> slot_impulse_;                 ///< [n_slots] received [N s; 2D: N s/m]
};

}  // namespace quern
