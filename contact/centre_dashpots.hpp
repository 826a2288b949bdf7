// The dashpots of the published node-pair contact: between the centres of grains.
//
//     between grains  where |c_j - c_i| < R_i + R_j + 1.01 R_c, every node k of i receives
//         F_k = b min(0, n.(v_cj - v_ci)) n V_k/B_i,   n = (c_j - c_i)/|c_j - c_i|
//         b   = C [-2 ln e/sqrt(pi^2 + ln^2 e)] sqrt(k R_c M),   M = 2 M_i M_j/(M_i + M_j)
//     against a body that stands for a wall: the same for each of its nodes w that is within R_c of a node of
//     i,
//         n = (x_w - c_i)/|x_w - c_i|, v_w for v_cj, M = M_i; the node w receives the opposite of the whole
//     against a plane that i touches: n = minus its normal, v of the plane, M = M_i
//
//     c node nearest to the centre of the reference shape, R radius of the ball around it, B_i = pi R_i^2
//     (3D: 4/3 pi R_i^3), M_i = density B_i, k = 2 K_i K_j/(K_i + K_j), R_c `published` radius, e
//     restitution, C damping factor (100) F [N; 2D: N/m], V, B [m^3; 2D: m^2], M [kg; 2D: kg/m], K, k [Pa],
//     R, R_c [m], b [kg/s in 3D only]
//
// Source: public PeriDEM code 0.1.0; Jha, Desai, Bhattacharya, Lipton, J. Mech. Phys. Solids 151 (2021)
// 104376, section 2.2.2. Differs from the paper as the code does: bounding balls for the range, B_i for the
// volume of the grain, the mass of the grain alone against a wall, one dashpot for every node of the wall in
// reach. Differs from the code: the wall receives its part (there it is held and needs none), planes and
// space. Of two unlike grains the impulses differ, by sum V/B: momentum is not exact. In the plane the unit
// of b is wrong, so its value changes with the unit of length.
#pragma once

#include "contact/node_pair_list.hpp"

namespace quern {

template <int Dim>
class CentreDashpots {
  public:
    CentreDashpots(const CartesianGrid<Dim>& grid, std::span<const Grain<Dim>> grains);

    /// Changes trial.v; adds to the impulses of the report. `kick`: time for which forces act [s].
    void add_impulses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, double kick,
                      const NodePairLaw<Dim>& law, const NodePairList<Dim>& list, ContactReport<Dim>& report);
    /// Adds to the works of the report, with the velocities before and after.
    void book_losses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                     ContactReport<Dim>& report) const;

  private:
    /// What one dashpot gives to a grain.
    struct Blow {
        Vec<Dim> r;        ///< from the centre of the grain to the other end [m]
        Vec<Dim> density;  ///< impulse per volume [N s/m^3]
        int end;           ///< node of a wall body; -1 - wall; nothing: other grains
    };
    static constexpr int another_grain = 1 << 30;

    void find_neighbors(const ContactScene<Dim>& scene, const NodePairLaw<Dim>& law);
    void collect(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, double kick,
                 const NodePairLaw<Dim>& law, const NodePairList<Dim>& list, int grain,
                 std::vector<Blow>& blows) const;
    int centre(const ContactScene<Dim>& scene, int grain) const {
        return scene.grains[grain].first + centre_node_[grain];
    }
    double ball(int grain) const;  ///< B

    NearestImage<Dim> nearest_;
    CartesianGrid<Dim> grid_;
    std::vector<int> centre_node_;  // [n_grains]
    std::vector<double> size_;      // [n_grains] R [m]
    std::vector<double> density_;   // [n_grains]

    // Grains whose balls may meet before a centre has moved by half of `margin_`.
    double margin_ = 0.0;
    std::vector<Vec<Dim>> x_;  // [n_grains] then
    std::vector<int> first_, neighbor_;

    // Of this step.
    std::vector<std::vector<Blow>> blows_;  // [n_grains]
    std::vector<Vec<Dim>> density_sum_;     // [n_grains] impulse per volume
};

}  // namespace quern
