// Node-pair contact: springs, dashpots and friction between the nodes of two grains, of a grain and a wall,
// and of two sides of a crack. Constants: node_pair_law.hpp; which nodes: node_pair_list.hpp.
//
//     J_i      = dt F_i(x_n)                              impulses, nothing moves
//     spring   F = k_n (R - d) n                          n from j to i, d = |x_j - x_i| < R, k_n = K V_i V_j
//     wall     F = k_n (R - 2 y) n                        y distance of the node from the plane
//     dashpot  F = c max(0, -n.(v_i - v_j)) n             `nodes`
//     friction u = v_i + omega_i x l_i - v_j - omega_j x l_j,  u_t = u - n (n.u)
//       history    F = -k_t s - c_t u_t,  s += dt u_t, turned with n, shortened to |s| <= mu F_n/k_t
//       slip       F = -min(mu F_n, m' |u_t|/dt) u_t/|u_t|,  1/m' = N_i/m_i + N_j/m_j
//       published  F = +mu F_n u_t/|u_t|,  u = v_i - v_j
//
//     F, F_n [N; 2D: N/m], k_n, k_t [N/m; 2D: N/m^2], c, c_t [kg/s; 2D: kg/(m s)], R, d, y, s, l [m], m [kg;
//     2D: kg/m]; F_n = spring and dashpot, k_t = tangential_ratio k_n, N number of contacts of a node, l
//     lever from the node to the point of contact (between the nodes as R divides, on the plane of a wall),
//     omega rotation of the grain around the node (node_patch.hpp).
//
// Source: Jha, Desai, Bhattacharya, Lipton, J. Mech. Phys. Solids 151 (2021) 104376, eqs 16 to 20; history:
// Cundall & Strack, Geotechnique 29 (1979) 47, turned and shortened as Luding, Granular Matter 10 (2008) 235,
// section 3. Differs: the sign of eq 20 makes friction push bodies on, here `published` and for reproduction
// only; the others oppose slip. F_n of friction holds the dashpot. Friction acts at the point of contact with
// its moment, so that moment of momentum is exact and a body that turns as a whole does not slip; `published`
// acts at the nodes.
//
// Wall: the mirror image of the grain moves against it. Only the image of the node itself counts, which is R
// - 2 y away; images of its neighbours are dx away at touch. Per node the wall is a spring of 2 k_n with the
// energy k_n (R - 2 y)^2/4: half of that of the pair, the other half belongs to the image. It rebounds as the
// grain would from its equal.
//
// Springs store energy (`elastic`); they and the leapfrog keep the budget as the bonds do. A tangential
// spring that slips by s' loses k_t (s_before + s_after)/2 s', exactly what the mean force does over the
// step.
#pragma once

#include <optional>

#include "contact/centre_dashpots.hpp"
#include "contact/contact_list.hpp"
#include "contact/node_pair_list.hpp"
#include "contact/node_patch.hpp"

namespace quern {

template <int Dim>
class NodePairContact {
  public:
    NodePairContact(const CartesianGrid<Dim>& grid, std::span<const Grain<Dim>> grains,
                    std::span<const double> volume, std::vector<PairBody> bodies, const PairLaws& laws,
                    const NodePairOptions& options);
    NodePairContact(const NodePairContact&) = delete;
    NodePairContact& operator=(const NodePairContact&) = delete;

    /// Changes trial.v. The report's stable_step is that of the springs found, after a search; else infinite.
    const ContactReport<Dim>& add_impulses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);

    /// Appends the contacts of the last step, whose trial asked for it (ContactTrial::listing).
    void list_contacts(const ContactScene<Dim>& scene, std::vector<ContactPoint<Dim>>& points) const;

    /// Books the works of the last impulses anew, where velocities have been changed once more since.
    void book_losses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);

    /// All broken bonds of a grain, ascending; the energy with which their springs begin [J; 2D: J/m].
    double set_broken(const ContactScene<Dim>& scene, int grain, std::vector<BrokenBond> bonds) {
        return list_.set_broken(scene, grain, std::move(bonds));
    }
    /// For checkpoints: a contact that recalls the memory of another goes on as that one would.
    PairMemory<Dim> memory() const;
    void recall(const PairMemory<Dim>& memory, std::size_t n_particles);
    bool self_contact() const { return law_.options().self_contact; }
    /// Largest stable step [s] of all grains, before any contact is known.
    double stable_step() const;

  private:
    /// What a node receives in this step.
    struct Push {
        Vec<Dim> J = Vec<Dim>::Zero();               ///< all of it [N s]
        Vec<Dim> dashpots = Vec<Dim>::Zero();        ///< of it: what only loses energy, along normals,
        Vec<Dim> friction = Vec<Dim>::Zero();        ///< and along surfaces
        Spin<Dim> moment = Spin<Dim>::Zero();        ///< of friction about the node [N m s]
        Spin<Dim> lossy_moment = Spin<Dim>::Zero();  ///< of `friction`
    };
    struct WallPush {
        int wall = 0;
        Vec<Dim> J = Vec<Dim>::Zero();
        Spin<Dim> moment = Spin<Dim>::Zero();  ///< about the origin
    };
    struct Sums {
        double elastic = 0.0, elastic_work = 0.0, slip_loss = 0.0;
        double wall_work = 0.0, wall_dashpots = 0.0,
               wall_friction = 0.0;  ///< on the particles, by what walls do
        double stable_step = std::numeric_limits<double>::infinity();
        std::int64_t n_ends = 0;     ///< of contacts, two each
        std::int64_t n_slipped = 0;  ///< tangential springs that hold something
        Sums& operator+=(const Sums& other);
    };
    /// One contact of a row's node.
    struct Touch {
        int entry;
        double d;    ///< distance of the nodes [m]
        Vec<Dim> r;  ///< from the node to its partner [m]
    };
    /// One contact, as friction sees it.
    struct Surface {
        Vec<Dim> n;            ///< from the partner to the node
        Vec<Dim> before, now;  ///< velocity against the partner at the point of contact [m/s]
        Vec<Dim> lever;        ///< from the node to that point [m]
        double F_n, k_t, c_t, mu, slip_mass;
        double share;  ///< of the energies: a half where the partner counts the rest
    };

    void find_touching(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);
    Sums push_row(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, int row);
    void push_from_wall(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, int row, int entry,
                        Sums& sums, double& squared, double& damped);
    void push_from_node(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, int row,
                        const Touch& touch, Sums& sums, double& squared, double& damped);
    void rub(const ContactTrial<Dim>& trial, const Surface& surface, int entry, Push& push, Sums& sums);
    void let_go(int entry, double k_t, double share, Sums& sums);
    void apply(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial);
    std::span<const int> patch_of(const ContactScene<Dim>& scene, int row) const {
        const Grain<Dim>& grain = scene.grains[list_.grain(row)];
        return patches_[patch_of_grain_[list_.grain(row)]].of(list_.particle(row) - grain.first);
    }
    bool has_levers() const { return rubs_ && law_.options().friction_law != PairFriction::published; }
    double kick_time(const ContactTrial<Dim>& trial) const { return trial.first ? 0.5 * trial.dt : trial.dt; }

    NodePairLaw<Dim> law_;
    NodePairList<Dim> list_;
    std::optional<CentreDashpots<Dim>> centres_;
    std::vector<NodePatches<Dim>> patches_;       // of each shape
    std::vector<int> patch_of_grain_;             // [n_grains] into patches_
    std::vector<Vec<Dim>> wall_velocity_before_;  // [n_walls]
    bool listing_ = false;                        // impulses of single contacts are kept
    bool rubs_ = false;                           // there is friction, or what is left of it
    std::int64_t n_slipped_ = 0;

    // Of this step, one entry a row.
    std::vector<std::uint8_t> active_;
    std::vector<int> n_touching_;
    std::vector<Push> push_;
    std::vector<PatchMotion<Dim>> motion_;
    std::vector<int> wall_first_;      // [n_rows + 1] into wall_push_
    std::vector<WallPush> wall_push_;  // row after row
    std::vector<Vec<Dim>> received_;   // while listing: [n_entries] impulse from each node [N s]
    Sums sums_;
    ContactReport<Dim> report_;
};

}  // namespace quern
