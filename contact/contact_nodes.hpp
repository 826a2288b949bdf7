// Grid nodes where something can touch, and what each grain has there.
//
// A node is a contact node if surface particles of two grains, or of one grain near a wall, have it in the
// support of their linear functions. Each grain at a contact node owns a slot: the particles around the
// node, their mass and inertia. Memory follows slots: nothing is stored per grain and node.
//
// Finding the nodes takes longer than filling their slots, so they are found with a skin to spare and kept
// until a particle or a wall has moved by the skin; and of those found, a contact rule may put aside
// the ones whose surfaces are further apart than two skins can close (keep_only). Neither changes a result:
// what a slot holds is computed from the positions of each step, and a node that was put aside has no
// contact before the next search.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/contact.hpp"
#include "grid/node_pages.hpp"
#include "grid/shape_functions.hpp"

namespace quern {

/// One particle in the support of a node.
template <int Dim>
struct Support {
    int particle;
    int surface;  ///< index into Shape::surface, or -1
    double N;     ///< linear shape function
    double w;     ///< weight of the slot: N, or N^2 at the surface and q N^2 inside
    double mw;    ///< m_p w_p [kg]
    Vec<Dim> d;   ///< x_p - x_a [m]
};

/// One grain at one contact node.
template <int Dim>
struct Slot {
    int grain;
    int node;               ///< contact node
    IntVec<Dim> index;      ///< node, not wrapped: where the grain sees it
    std::size_t candidate;  ///< first of the particles that may come near before the next search
    int n_candidates;
    const Support<Dim>* support;
    int n_support;
    double m;     ///< sum m_p w_p [kg]
    Vec<Dim> xb;  ///< sum m_p w_p d_p / m, from the node [m]
    Eigen::Matrix<double, n_spin<Dim>, n_spin<Dim>>
        Y;              ///< inverse of sum m_p w_p (|r|^2 1 - r r^T); 0: degenerate
    bool rotates;       ///< Y is usable
    double volume;      ///< sum N_p V_p
    Vec<Dim> gradient;  ///< sum V_p grad_a B(x_a - x_p), quadratic B-spline: points into the grain
};

/// A particle that a slot may need.
struct Candidate {
    int particle, surface;
};

/// Options of the search, fixed for a run.
struct ContactNodeOptions {
    bool all_nodes = false;        ///< every node of every grain is kept (flip coupling)
    bool all_particles = false;    ///< interior particles make contact nodes as well (seed rule)
    double wall_reach = 0.75;      ///< nodes nearer to a wall than this have a slot [h]
    bool nodal = false;            ///< w = N: slots carry nodal momentum (flip coupling, seed rule)
    double interior_weight = 1.0;  ///< q, unless nodal
    double skin = 0.0;             ///< a search lasts until something has moved this far [h]
};

template <int Dim>
class ContactNodes {
  public:
    ContactNodes(const CartesianGrid<Dim>& grid, const ContactNodeOptions& options)
        : grid_(grid), options_(options), marks_(grid, 0) {}

    /// Finds contact nodes, unless those of an earlier search still serve, and fills slots for the positions
    /// in `scene`. Positions must be inside the grid.
    void find(const ContactScene<Dim>& scene);
    /// Whether the last `find` searched: then all nodes are there, and `keep_only` may put some aside.
    bool searched() const { return searched_; }
    /// Forgets nodes until the next search. `wanted` [n_nodes].
    void keep_only(const std::vector<std::uint8_t>& wanted);
    double skin() const { return options_.skin; }

    const CartesianGrid<Dim>& grid() const { return grid_; }
    std::vector<Slot<Dim>>& slots() { return slots_; }
    const std::vector<Slot<Dim>>& slots() const { return slots_; }
    int n_nodes() const { return n_nodes_; }

    /// Slots of a node, ordered by where their mass is, not by the number of the grain.
    std::span<const int> slots_of(int node) const {
        return {node_slots_.data() + node_begin_[node], node_slots_.data() + node_begin_[node + 1]};
    }
    /// Slots of a grain are [first, last).
    std::pair<int, int> slots_of_grain(int grain) const {
        return {grain_slots_[grain], grain_slots_[grain + 1]};
    }

  private:
    struct Window {  ///< box of nodes around a grain
        IntVec<Dim> lo, size;
        int local(const IntVec<Dim>& node) const {
            int i = 0;
            for (int a = Dim - 1; a >= 0; --a) i = i * size[a] + node[a] - lo[a];
            return i;
        }
        IntVec<Dim> node(int i) const {
            IntVec<Dim> n;
            for (int a = 0; a < Dim; ++a, i /= size[a - 1]) n[a] = lo[a] + i % size[a];
            return n;
        }
        int n() const { return size.prod(); }
    };
    struct Scratch {  ///< of one thread
        std::vector<int> window;
        std::vector<std::uint8_t> near_cell;
        std::vector<std::pair<int, Candidate>> near;  ///< slot of the grain, particle
    };

    bool moved(const ContactScene<Dim>& scene) const;
    void search(const ContactScene<Dim>& scene);
    void mark_touched(const ContactScene<Dim>& scene);
    void select(const ContactScene<Dim>& scene);
    void number_nodes();
    void index_nodes();
    void order_slots();
    void list_candidates(const ContactScene<Dim>& scene, int grain, Scratch& scratch);
    void fill_slots(const ContactScene<Dim>& scene, int grain);
    IntVec<Dim> wrapped(const IntVec<Dim>& node) const {
        IntVec<Dim> w;
        for (int a = 0; a < Dim; ++a) w[a] = grid_.wrapped(a, node[a]);
        return w;
    }
    bool near_wall(const ContactScene<Dim>& scene, const IntVec<Dim>& node) const;

    CartesianGrid<Dim> grid_;
    ContactNodeOptions options_;
    NodePages<Dim, std::int32_t> marks_;  ///< number of grains at a node; later -1 - contact node

    std::vector<Window> windows_;                     ///< [n_grains]
    std::vector<std::vector<int>> touched_;           ///< [n_grains] nodes as local window index, ascending
    std::vector<int> n_selected_;                     ///< [n_grains] of touched_, moved to its front
    std::vector<std::vector<Candidate>> candidates_;  ///< [n_grains] slot after slot, ascending
    std::vector<std::vector<Support<Dim>>> support_;  ///< [n_grains] slot after slot
    std::vector<int> grain_slots_, node_begin_, node_slots_, fill_;
    int n_nodes_ = 0;
    bool searched_ = false;
    std::vector<Vec<Dim>> x_searched_;     ///< [n] positions at the last search
    std::vector<Vec<Dim>> wall_searched_;  ///< [n_walls] points of the walls then
    std::vector<Slot<Dim>> slots_;
    std::vector<Scratch> scratch_;
};

}  // namespace quern
