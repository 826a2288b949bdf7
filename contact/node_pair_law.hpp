// The constants of node-pair contact: at which distance two nodes feel each other, how stiffly, how damped.
//
//     force       F = K (R - d) V_i V_j  on both nodes, apart, while d = |x_j - x_i| < R
//     K           `layer`       k/s^(n+2), k of K | K2
//                 `consistent`  18 k/(pi e^5) in space, 12 k/(pi e^4) in the plane, k of K | K2
//                 `published`   18 k/(pi e^5) in both, k of K
//                 `given`       a number
//     k           2 k_i k_j/(k_i + k_j), of the moduli of both grains
//     s, e        sqrt(dx_i dx_j), sqrt(e_i e_j), of their spacings dx and horizons e
//     R           `surface`     r_i + r_j,  r = max(depth of the node below the true surface, f dx/2)
//                 `published`   f h,  h smallest distance of two nodes of a grain, over all grains of the run
//     self        K of the grain with itself, R = f h of that grain
//     damping     c = 2 z sqrt(k_n m*),  k_n = K V_i V_j,  m* = m_i m_j/(m_i + m_j)
//     z           exp(-z acos(z)/sqrt(1 - z^2)) = restitution
//
//     K [N/m^7; 2D: N/m^6], R, d, s, e, dx, h [m], V [m^3; 2D: m^2], k [Pa], c [kg/s; 2D: kg/(m s)], n = 2 |
//     3, f = 0.95
//
// Source: Jha, Desai, Bhattacharya, Lipton, J. Mech. Phys. Solids 151 (2021) 104376, section 2.2;
// `consistent`: micromodulus c = 18 K/(pi e^4) of Silling & Askari, Comput. Struct. 83 (2005) 1526, over the
// horizon; in the plane the same derivation, equal strains eps that cost 2 K2 eps^2, gives c = 12 K2/(pi
// e^3).
//
// Differs: the paper takes the spatial K in the plane, too, where its value changes with the unit of length.
//
// `layer` is our own: a pair of nodes face to face has the stiffness k s^(n-2) of the layer of material
// between them, s thick and s wide; two half layers of unlike grains in series give the harmonic mean k.
// `consistent` is the stiffness of one bond, where dozens cross a section: e = 3 dx in the plane makes 0.047
// k a pair, as soft as twenty layers. Two disks of 24 nodes across that meet at 2 c_0/100 then go through
// each other by more than a spacing (rebound 0.62, contact lasts 1.8 times too long; `layer`: 0.92 without
// and 0.98 with friction, and the duration of Hertz within 1 %). Means of s and e are geometric, so that K
// V_i V_j does not depend on the spacings in the plane.
//
// R: a node in the middle of its cell is dx/2 below the surface; `surface` gives every node a ball that
// reaches the true surface, so that surfaces touch where they should (nodes face to face; nodes in the gaps
// of the other row 0.13 dx later). A node of a mesh may lie on the surface itself; springs need a range, so
// it gets half of f dx, which is what the paper has, and such grains touch a gap of about f dx early.
//
// z: dashpots act in approach only. The usual z = -ln e/sqrt(pi^2 + ln^2 e) is for both ways; with it two
// nodes would part with e^(acos(z)/pi), some sqrt(e).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "contact/contact.hpp"

namespace quern {

enum class PairStiffness { layer, consistent, published, given };
enum class PairRadius { surface, published };
enum class PairDamping { none, nodes, centres };
enum class PairFriction { history, slip, published };
enum class PairParticles { surface, all };

struct NodePairOptions {
    PairRadius radius = PairRadius::surface;
    double radius_factor = 0.95;  ///< f
    PairDamping damping = PairDamping::none;
    PairFriction friction_law = PairFriction::history;
    double tangential_ratio = 0.8;    ///< tangential over normal stiffness (history)
    double tangential_damping = 0.0;  ///< part of the critical one, while sticking (history)
    PairParticles particles = PairParticles::surface;
    bool self_contact = true;  ///< nodes on two sides of a crack repel
    double skin = 0.3;         ///< pairs are searched anew when a node has moved by half of it [largest R]
};

/// What holds between two materials.
struct PairLaw {
    PairStiffness rule = PairStiffness::layer;
    double stiffness = 0.0;         ///< K, where `given`
    double radius = 0.0;            ///< R [m]; 0: by the rule
    double radius_factor = 0.0;     ///< R over h; 0: by the rule
    double restitution = 1.0;       ///< of two nodes, in (0, 1]
    double damping_factor = 100.0;  ///< C of the dashpots between centres
};

/// The laws of all pairs of materials, symmetric.
class PairLaws {
  public:
    PairLaws(int n_materials, const PairLaw& law)
        : n_(n_materials), laws_(static_cast<std::size_t>(n_materials * n_materials), law) {}
    const PairLaw& operator()(int a, int b) const { return laws_[static_cast<std::size_t>(a * n_ + b)]; }
    void set(int a, int b, const PairLaw& law) {
        laws_[static_cast<std::size_t>(a * n_ + b)] = laws_[static_cast<std::size_t>(b * n_ + a)] = law;
    }

  private:
    int n_;
    std::vector<PairLaw> laws_;
};

/// What contact has to know of the inside of a grain; all for its size.
struct PairBody {
    double bulk_modulus = 0.0;    ///< K [Pa]
    double modulus = 0.0;         ///< K, in the plane K2 [Pa]
    double horizon = 0.0;         ///< [m]
    double least_distance = 0.0;  ///< h of this grain [m]
    double frequency = 0.0;       ///< highest of the free grain [rad/s]
    double bond_damping = 0.0;    ///< Kelvin-Voigt time [s]
};

/// Damping ratio z of a spring with a dashpot that acts in approach only, from the restitution e.
double approach_damping_ratio(double restitution);

template <int Dim>
class NodePairLaw {
  public:
    NodePairLaw(std::span<const Grain<Dim>> grains, std::span<const double> volume,
                std::vector<PairBody> bodies, const PairLaws& laws, const NodePairOptions& options);

    const NodePairOptions& options() const { return options_; }
    const PairLaw& law(int grain_a, int grain_b) const {
        return laws_(sides_[grain_a].material, sides_[grain_b].material);
    }
    const PairBody& body(int grain) const { return bodies_[grain]; }

    /// R of particle p of grain a and particle q of grain b [m].
    double radius(int a, int p, int b, int q) const {
        const PairLaw& pair = law(a, b);
        if (pair.radius > 0.0) return pair.radius;
        if (pair.radius_factor > 0.0) return pair.radius_factor * least_distance_;
        return node_radius_[p] + node_radius_[q];
    }
    /// r, or half of R where that does not depend on the node [m]: divides the distance of two nodes.
    double node_radius(int p) const { return node_radius_[p]; }
    double self_radius(int grain) const { return options_.radius_factor * bodies_[grain].least_distance; }
    double largest_radius() const { return largest_radius_; }
    /// R of the pairs that the published model has, between any two grains [m].
    double published_radius(int a, int b) const;
    /// K [N/m^7; 2D: N/m^6]
    double stiffness(int a, int b) const;
    /// z of the dashpots between nodes
    double damping_ratio(int a, int b) const {
        return damping_ratio_[static_cast<std::size_t>(sides_[a].material * n_materials_ +
                                                       sides_[b].material)];
    }
    /// b of the dashpots between centres, for the mass M (centre_dashpots.hpp).
    double centre_damping(int a, int b, double mass) const;
    /// Tangential stiffness over normal stiffness.
    double tangential_ratio() const {
        return options_.friction_law == PairFriction::history ? options_.tangential_ratio : 0.0;
    }

    /// Largest stable step [s] of a grain with contact before any is known. The frequencies of springs add as
    /// omega^2 <= omega_int^2 + omega_c^2: K and M^-1 are sums of positive matrices. Row sums of M^-1 K bound
    /// omega_c^2 by 2 sum_j k_ij/m_i. As many springs j are counted as nodes of a lattice of the other grain
    /// fit within R when a quarter of R overlaps,
    ///
    ///     n = sum over layers at g = R (3/4), R (3/4) + dx, ... of floor(1 + 2 sqrt(R^2 - g^2)/dx)^(n_dim -
    ///     1)
    ///
    /// two in the plane and four in space for R = dx. Tangential springs add nothing: they pull across.
    double stable_step(int grain) const;
    /// The step with omega^2 = omega_int^2 + `squared` and a rate of damping of tau omega_int^2 + `damped`
    /// [1/s]:
    ///
    ///     dt = 2/omega (sqrt(1 + z^2) - z),   z = rate/(2 omega)
    double step_with(int grain, double squared, double damped) const;

  private:
    struct Side {
        int material = 0;
        double density = 0.0, largest_volume = 0.0, largest_radius = 0.0, spacing = 0.0, mass = 0.0,
               size = 0.0;
    };
    /// What the grains of a material can do to others at most.
    struct Threat {
        int grain = -1;
        std::array<double, 3> push{};  ///< largest V l^(-p/2), for the rules before `given`
        double volume = 0.0, radius = 0.0, spacing = 0.0;
    };
    /// l^(-p/2) of a grain: K is proportional to it for both.
    double length_power(int grain, PairStiffness rule) const;

    std::vector<PairBody> bodies_;
    std::vector<Side> sides_;          // [n_grains]
    std::vector<Threat> threats_;      // one a material that has grains
    std::vector<double> node_radius_;  // [n] r [m]
    PairLaws laws_;
    NodePairOptions options_;
    int n_materials_ = 0;
    std::vector<double> damping_ratio_;  // [n_materials^2] z
    double least_distance_ = 0.0;        // h over all grains [m]
    double largest_radius_ = 0.0;        // [m]
};

}  // namespace quern
