// Grid nodes where something can touch, and what each grain has there.
//
// A node is a contact node if surface particles of two grains, or of one grain near a wall, have it in the
// support of their linear functions. A grain at a contact node is a site: which particles may come near. Of
// the sites only those of nodes that are awake own a slot: the particles around the node now, their mass and
// inertia. Memory follows sites: nothing is stored per grain and node.
//
//     search   finds nodes and sites with a skin to spare; they serve until something has moved by the skin
//     choose   asks the contact rule for the free path of every node: how far bodies may move before they
//              can meet there. A node sleeps until they have gone that far
//     fill     slots of the nodes that are awake, from the positions of each step
//
// None of it changes a result: what a slot holds is computed from the positions of each step, and a node that
// sleeps has no contact.
//
// Nodes are kept page by page (node_pages.hpp), pages by colour: pages of one colour share no particle, and
// what belongs to the nodes of a page lies together in memory.
#pragma once

#include <cstdint>
#include <limits>

#include "contact/contact.hpp"
#include "contact/fill_slot.hpp"
#include "grid/node_pages.hpp"
#include "grid/parallel.hpp"

namespace quern {

/// Options of the search, fixed for a run.
struct ContactNodeOptions {
    bool all_nodes = false;      ///< every node of every grain is kept (flip coupling)
    bool all_particles = false;  ///< interior particles make contact nodes as well (seed rule)
    bool only_surface = false;   ///< slots are without interior particles (surface rule)
    double wall_reach = 0.75;    ///< nodes nearer to a wall than this have a slot [h]
    SlotWeights weights;         ///< nodal: slots carry nodal momentum (flip coupling, seed rule)
    double skin = 0.0;           ///< a search lasts until something has moved this far [h]
};

template <int Dim>
class ContactNodes {
  public:
    ContactNodes(const CartesianGrid<Dim>& grid, const ContactNodeOptions& options)
        : grid_(grid), options_(options), marks_(grid, 0) {}

    /// Finds nodes and sites, unless those of an earlier search still serve. `ahead` [m]: how far anything
    /// would go in this step without contact. Positions must be inside the grid.
    void find(const ContactScene<Dim>& scene, double ahead);
    /// Grains are others than before: the next `find` searches.
    void forget() { windows_.clear(); }
    /// Whether the last `find` searched.
    bool searched() const { return searched_; }
    bool may_sleep() const { return options_.skin > 0.0; }
    /// Whether nodes may have to wake: then `choose` comes before `fill`.
    bool chooses() const { return searched_ || travelled_ >= choose_at_; }
    /// Decides which nodes are awake. free_path(std::span<const Slot>) [h] is asked in parallel, for the
    /// slots of one node.
    template <class FreePath>
    void choose(const ContactScene<Dim>& scene, FreePath&& free_path);
    /// All nodes are awake.
    void choose_all();
    /// Fills slots for the positions in `scene`: of one page, or of all.
    void fill(const ContactScene<Dim>& scene, int page);
    void fill(const ContactScene<Dim>& scene);

    const CartesianGrid<Dim>& grid() const { return grid_; }
    const std::vector<Slot<Dim>>& slots() const { return slots_; }

    /// Nodes that are awake.
    int n_nodes() const { return static_cast<int>(node_slots_.size()) - 1; }
    /// Slots of a node, ordered by where their mass is, not by the number of the grain.
    std::span<const int> slots_of(int node) const {
        return {slot_order_.data() + node_slots_[node], slot_order_.data() + node_slots_[node + 1]};
    }
    /// Slots of a grain.
    std::span<const int> slots_of_grain(int grain) const {
        return {slot_of_grain_.data() + grain_slots_[grain], slot_of_grain_.data() + grain_slots_[grain + 1]};
    }
    bool has_sites(int grain) const { return grain_sites_[grain] < grain_sites_[grain + 1]; }

    static constexpr std::size_t few_slots = 128;
    static constexpr int n_colours = NodePages<Dim, std::int32_t>::n_colours;
    int n_pages() const { return static_cast<int>(pages_.size()); }
    /// Loops over pages that are shorter than this stay on one thread: those of a few slots always.
    std::size_t serial_below() const { return slots_.size() < few_slots ? pages_.size() + 1 : 2; }
    /// Pages of a colour are [first, last).
    std::pair<int, int> pages_of_colour(int colour) const {
        return {colour_pages_[colour], colour_pages_[colour + 1]};
    }
    /// Nodes of a page that are awake are [first, last).
    std::pair<int, int> nodes_of_page(int page) const { return {page_nodes_[page], page_nodes_[page + 1]}; }
    std::pair<int, int> slots_of_page(int page) const { return {page_slots_[page], page_slots_[page + 1]}; }

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
    struct Site {
        int grain;
        int node;           ///< contact node, asleep or awake
        IntVec<Dim> index;  ///< node, not wrapped: where the grain sees it
        int candidate;      ///< first of the particles of the grain that may come near before the next search
        int n_candidates;
    };
    struct Page {
        std::size_t place;  ///< in the grid
        int number;         ///< in marks_
        int colour;
    };
    struct Scratch {  ///< of one thread
        std::vector<int> window;
        std::vector<std::uint8_t> near_cell;
        std::vector<std::pair<int, Candidate>> near;  ///< site of the grain, particle
        std::vector<Slot<Dim>> slots;
        std::vector<Support<Dim>> support;
    };

    void search(const ContactScene<Dim>& scene);
    void mark_touched(const ContactScene<Dim>& scene);
    void make_pages();
    void number_nodes(const ContactScene<Dim>& scene);
    void make_sites();
    void list_candidates(const ContactScene<Dim>& scene, int grain, Scratch& scratch);
    void wake();
    /// How far the nearest surface particle is from having the node in its support [h].
    double distance_to_surface(const ContactScene<Dim>& scene, const Site& site) const;
    std::span<const Candidate> candidates_of(const Site& site) const {
        return {candidates_[site.grain].data() + site.candidate, static_cast<std::size_t>(site.n_candidates)};
    }
    IntVec<Dim> wrapped(const IntVec<Dim>& node) const {
        IntVec<Dim> w;
        for (int a = 0; a < Dim; ++a) w[a] = grid_.wrapped(a, node[a]);
        return w;
    }
    bool near_wall(const ContactScene<Dim>& scene, const IntVec<Dim>& node) const;

    CartesianGrid<Dim> grid_;
    ContactNodeOptions options_;

    // Of the last search.
    NodePages<Dim, std::int32_t> marks_;  ///< number of grains at a node; then 1 + contact node, or 0
    std::vector<Page> pages_;
    std::vector<int> colour_pages_;
    std::vector<Window> windows_;                     ///< [n_grains]
    std::vector<std::vector<int>> touched_;           ///< [n_grains] nodes as local window index, ascending
    std::vector<Site> sites_;                         ///< grain after grain
    std::vector<int> grain_sites_;                    ///< [n_grains + 1] into sites_
    std::vector<std::vector<Candidate>> candidates_;  ///< [n_grains] site after site, ascending
    std::vector<int> found_begin_, found_sites_;      ///< sites of each node found
    std::vector<int> page_found_;                     ///< [n_pages + 1] nodes found
    bool searched_ = false;
    double travelled_ = 0.0;                    ///< by the end of this step [m]
    double search_at_ = 0.0, choose_at_ = 0.0;  ///< of `travelled` [m]
    double path_between_choices_ = 0.0;         ///< [m]

    // Of the last choice.
    std::vector<double> wake_at_;                   ///< [n_found] of `travelled` [m]
    std::vector<std::uint8_t> awake_;               ///< [n_found]
    std::vector<int> page_nodes_;                   ///< [n_pages + 1] into nodes that are awake
    std::vector<int> page_slots_;                   ///< [n_pages + 1] into slots_
    std::vector<int> node_slots_, slot_order_;      ///< slots of each node that is awake
    std::vector<int> grain_slots_, slot_of_grain_;  ///< slots of each grain
    std::vector<std::vector<Candidate>> near_;      ///< [n_pages] slot after slot
    std::vector<int> n_near_;                       ///< [n_slots]

    std::vector<Slot<Dim>> slots_;                    ///< node after node
    std::vector<std::vector<Support<Dim>>> support_;  ///< [n_pages] slot after slot
    std::vector<Scratch> scratch_;
};

template <int Dim>
template <class FreePath>
void ContactNodes<Dim>::choose(const ContactScene<Dim>& scene, FreePath&& free_path) {
    const double path = path_between_choices_;
    parallel::for_each(
        pages_.size(),
        [&](std::size_t page) {
            Scratch& scratch = scratch_[static_cast<std::size_t>(parallel::thread_id())];
            for (int i = page_found_[page]; i < page_found_[page + 1]; ++i) {
                awake_[i] = wake_at_[i] <= travelled_ + path;
                if (!awake_[i]) continue;
                const std::span sites(found_sites_.data() + found_begin_[i],
                                      found_sites_.data() + found_begin_[i + 1]);
                std::size_t n = 0;
                for (const int s : sites) n += static_cast<std::size_t>(sites_[s].n_candidates);
                scratch.slots.resize(sites.size());
                scratch.support.resize(std::max(scratch.support.size(), n));
                Support<Dim>* support = scratch.support.data();
                for (std::size_t k = 0; k < sites.size(); ++k) {
                    const Site& site = sites_[sites[k]];
                    Slot<Dim>& slot = scratch.slots[k];
                    slot.grain = site.grain;
                    slot.index = site.index;
                    fill_slot<Dim>(scene, grid_, options_.weights, candidates_of(site), slot, support);
                    slot.away = distance_to_surface(scene, site);
                    support += slot.n_support;
                }
                wake_at_[i] =
                    scene.travelled + free_path(std::span<const Slot<Dim>>(scratch.slots)) * grid_.h();
                awake_[i] = wake_at_[i] <= travelled_ + path;
            }
        },
        serial_below());
    choose_at_ = travelled_ + path;
    wake();
}

}  // namespace quern
