#include "contact/contact_nodes.hpp"

#include <algorithm>
#include <atomic>
#include <climits>
#include <numeric>

namespace quern {

namespace {

constexpr double furthest_candidate = 1.5;  ///< reach of the quadratic functions [h]
/// Contact may make a body this much faster than what moves without it.
constexpr double faster_by_contact = 2.0;
/// The more steps between two choices, the more nodes are awake that need not be.
constexpr double steps_between_choices = 4.0;

template <int Dim>
bool lower_first(const Vec<Dim>& a, const Vec<Dim>& b) {
    return std::lexicographical_compare(a.data(), a.data() + Dim, b.data(), b.data() + Dim);
}

}  // namespace

template <int Dim>
void ContactNodes<Dim>::find(const ContactScene<Dim>& scene, double ahead) {
    ahead *= faster_by_contact;
    travelled_ = scene.travelled + ahead;
    const double skin = options_.skin * grid_.h();
    path_between_choices_ = std::clamp(steps_between_choices * ahead, 0.005 * skin, 0.5 * skin);
    searched_ = !(skin > 0.0) || windows_.size() != scene.grains.size() || scene.travelled >= search_at_;
    if (!searched_) return;
    search(scene);
    search_at_ = scene.travelled + skin;
}

template <int Dim>
void ContactNodes<Dim>::search(const ContactScene<Dim>& scene) {
    const std::size_t n_grains = scene.grains.size();
    windows_.resize(n_grains);
    touched_.resize(n_grains);
    candidates_.resize(n_grains);
    scratch_.resize(static_cast<std::size_t>(parallel::n_threads()));
    mark_touched(scene);
    make_pages();
    number_nodes(scene);
    make_sites();
    parallel::for_each(n_grains, [&](std::size_t g) {
        list_candidates(scene, static_cast<int>(g),
                        scratch_[static_cast<std::size_t>(parallel::thread_id())]);
    });
    wake_at_.assign(found_begin_.size() - 1, -std::numeric_limits<double>::infinity());
    awake_.resize(wake_at_.size());
}

template <int Dim>
void ContactNodes<Dim>::mark_touched(const ContactScene<Dim>& scene) {
    parallel::for_each(scene.grains.size(), [&](std::size_t g) {
        const Grain<Dim>& grain = scene.grains[g];
        Scratch& scratch = scratch_[static_cast<std::size_t>(parallel::thread_id())];
        IntVec<Dim> lo = IntVec<Dim>::Constant(INT_MAX), hi = IntVec<Dim>::Constant(INT_MIN);
        for (int p = grain.first; p < grain.first + grain.count; ++p) {
            const IntVec<Dim> cell = CartesianGrid<Dim>::cell(grid_.in_cells(scene.x[p]));
            lo = lo.cwiseMin(cell);
            hi = hi.cwiseMax(cell);
        }
        Window& window = windows_[g];  // one more layer all around for the skin
        window.lo = lo - IntVec<Dim>::Ones();
        window.size = hi - lo + IntVec<Dim>::Constant(4);
        scratch.window.assign(static_cast<std::size_t>(window.n()), 0);
        const double skin = options_.skin;
        auto mark = [&](int p) {
            const Vec<Dim> in_cells = grid_.in_cells(scene.x[p]);
            const IntVec<Dim> cell = CartesianGrid<Dim>::cell(in_cells);
            IntVec<Dim> first, count;
            for (int a = 0; a < Dim; ++a) {
                const double f = in_cells[a] - cell[a];
                first[a] = cell[a] - (f < skin ? 1 : 0);
                count[a] = cell[a] + 2 + (f > 1.0 - skin ? 1 : 0) - first[a];
            }
            for (int k = 0; k < count.prod(); ++k) {
                IntVec<Dim> node = first;
                for (int a = 0, rest = k; a < Dim; rest /= count[a], ++a) node[a] += rest % count[a];
                scratch.window[window.local(node)] = 1;
            }
        };
        if (options_.all_particles || options_.all_nodes)
            for (int p = grain.first; p < grain.first + grain.count; ++p) mark(p);
        else
            for (const SurfacePoint<Dim>& point : grain.shape->surface) mark(grain.first + point.node);
        touched_[g].clear();
        for (int i = 0; i < window.n(); ++i)
            if (scratch.window[i]) touched_[g].push_back(i);
    });
}

template <int Dim>
bool ContactNodes<Dim>::near_wall(const ContactScene<Dim>& scene, const IntVec<Dim>& node) const {
    const Vec<Dim> x = grid_.node_position(node);
    return std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Wall<Dim>& wall) {
        const double distance = wall.distance(x);
        const double reach = (options_.wall_reach + options_.skin) * grid_.h();
        return options_.all_particles ? distance <= reach : std::abs(distance) <= reach;
    });
}

/// Pages for all nodes of all windows, ordered by colour and place.
template <int Dim>
void ContactNodes<Dim>::make_pages() {
    marks_.clear();
    for (const Window& window : windows_) {
        IntVec<Dim> last = window.lo + window.size - IntVec<Dim>::Ones();
        IntVec<Dim> node = window.lo;
        const auto advance = [&](int a) {  // to the next page: the last one of a periodic axis may be cut
            const int w = grid_.wrapped(a, node[a]);
            const int step = std::min(marks_.side - w % marks_.side, grid_.n_nodes()[a] - w);
            node[a] = std::min(last[a], node[a] + step);
        };
        if constexpr (Dim == 2) {
            for (node[1] = window.lo[1];; advance(1)) {
                for (node[0] = window.lo[0];; advance(0)) {
                    marks_.require(wrapped(node));
                    if (node[0] == last[0]) break;
                }
                if (node[1] == last[1]) break;
            }
        } else {
            for (node[2] = window.lo[2];; advance(2)) {
                for (node[1] = window.lo[1];; advance(1)) {
                    for (node[0] = window.lo[0];; advance(0)) {
                        marks_.require(wrapped(node));
                        if (node[0] == last[0]) break;
                    }
                    if (node[1] == last[1]) break;
                }
                if (node[2] == last[2]) break;
            }
        }
    }
    pages_.clear();
    for (int i = 0; i < marks_.n_pages(); ++i) pages_.push_back({marks_.place(i), i, marks_.colour(i)});
    std::sort(pages_.begin(), pages_.end(), [](const Page& a, const Page& b) {
        return a.colour != b.colour ? a.colour < b.colour : a.place < b.place;
    });
    colour_pages_.assign(marks_.n_colours + 1, 0);
    for (const Page& page : pages_) ++colour_pages_[page.colour + 1];
    std::partial_sum(colour_pages_.begin(), colour_pages_.end(), colour_pages_.begin());
}

/// Numbers the nodes where something can touch, page by page.
template <int Dim>
void ContactNodes<Dim>::number_nodes(const ContactScene<Dim>& scene) {
    parallel::for_each(windows_.size(), [&](std::size_t g) {
        for (const int i : touched_[g])
            std::atomic_ref<std::int32_t>(marks_[wrapped(windows_[g].node(i))])
                .fetch_add(1, std::memory_order_relaxed);
    });
    page_found_.assign(pages_.size() + 1, 0);
    std::vector<int> n_sites(pages_.size() + 1, 0);
    parallel::for_each(pages_.size(), [&](std::size_t k) {
        const std::span<std::int32_t> marks = marks_.values(pages_[k].number);
        for (int i = 0; i < marks_.page_size; ++i) {
            if (marks[i] == 0) continue;
            const bool wanted = options_.all_nodes || marks[i] > 1 ||
                                near_wall(scene, grid_.node(marks_.node(pages_[k].number, i)));
            if (!wanted) {
                marks[i] = 0;
                continue;
            }
            ++page_found_[k + 1];
            n_sites[k + 1] += marks[i];
        }
    });
    std::partial_sum(page_found_.begin(), page_found_.end(), page_found_.begin());
    std::partial_sum(n_sites.begin(), n_sites.end(), n_sites.begin());
    found_begin_.resize(static_cast<std::size_t>(page_found_.back()) + 1);
    found_begin_.back() = n_sites.back();
    parallel::for_each(pages_.size(), [&](std::size_t k) {
        int found = page_found_[k], site = n_sites[k];
        const std::span<std::int32_t> marks = marks_.values(pages_[k].number);
        for (int colour = 0; colour < power(2, Dim); ++colour)
            for (int i = 0; i < marks_.page_size; ++i) {
                if (marks[i] == 0 || marks_.parity(i) != colour) continue;
                found_begin_[found] = site;
                site += marks[i];
                marks[i] = ++found;
            }
    });
}

template <int Dim>
void ContactNodes<Dim>::make_sites() {
    const std::size_t n_grains = windows_.size();
    grain_sites_.assign(n_grains + 1, 0);
    parallel::for_each(n_grains, [&](std::size_t g) {
        grain_sites_[g + 1] =
            static_cast<int>(std::count_if(touched_[g].begin(), touched_[g].end(),
                                           [&](int i) { return marks_[wrapped(windows_[g].node(i))] > 0; }));
    });
    std::partial_sum(grain_sites_.begin(), grain_sites_.end(), grain_sites_.begin());
    sites_.resize(static_cast<std::size_t>(grain_sites_.back()));
    parallel::for_each(n_grains, [&](std::size_t g) {
        Site* site = sites_.data() + grain_sites_[g];
        for (const int i : touched_[g]) {
            const IntVec<Dim> index = windows_[g].node(i);
            const std::int32_t mark = marks_[wrapped(index)];
            if (mark > 0) *site++ = {static_cast<int>(g), mark - 1, index, 0, 0};
        }
    });
    found_sites_.resize(sites_.size());
    std::vector<int> next(found_begin_.begin(), found_begin_.end() - 1);
    for (std::size_t s = 0; s < sites_.size(); ++s)
        found_sites_[next[sites_[s].node]++] = static_cast<int>(s);
}

/// Particles that have a site in reach of their quadratic functions, or will before the next search.
template <int Dim>
void ContactNodes<Dim>::list_candidates(const ContactScene<Dim>& scene, int g, Scratch& scratch) {
    candidates_[g].clear();
    const int first = grain_sites_[g], last = grain_sites_[g + 1];
    if (first == last) return;
    const Grain<Dim>& grain = scene.grains[g];
    const Window& window = windows_[g];
    scratch.window.assign(static_cast<std::size_t>(window.n()), -1);
    scratch.near_cell.assign(static_cast<std::size_t>(window.n()), 0);
    constexpr int reach = 2, side = 2 * reach;  // cells of particles near a node: two to each side of it
    for (int s = first; s < last; ++s) {
        const Site& site = sites_[s];
        scratch.window[window.local(site.index)] = s;
        for (int k = 0; k < power(side, Dim); ++k) {
            IntVec<Dim> cell;
            bool inside = true;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= side) {
                cell[a] = site.index[a] - reach + rest % side;
                inside = inside && cell[a] >= window.lo[a] && cell[a] < window.lo[a] + window.size[a];
            }
            if (inside) scratch.near_cell[window.local(cell)] = 1;
        }
    }
    scratch.near.clear();
    const std::vector<SurfacePoint<Dim>>& surface = grain.shape->surface;
    const double furthest = furthest_candidate + options_.skin;
    std::int32_t next_surface = 0;
    for (std::int32_t i = 0; i < grain.count; ++i) {
        const bool on_surface =
            next_surface < static_cast<std::int32_t>(surface.size()) && surface[next_surface].node == i;
        const Candidate candidate = on_surface ? -1 - next_surface++ : i;
        if (options_.only_surface && !on_surface) continue;
        const Vec<Dim> in_cells = grid_.in_cells(scene.x[grain.first + i]);
        const IntVec<Dim> cell = CartesianGrid<Dim>::cell(in_cells);
        if (!scratch.near_cell[window.local(cell)]) continue;
        for (int k = 0; k < power(side, Dim); ++k) {
            IntVec<Dim> node;
            bool near = true;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= side) {
                node[a] = cell[a] - reach + 1 + rest % side;
                near = near && std::abs(in_cells[a] - node[a]) <= furthest && node[a] >= window.lo[a] &&
                       node[a] < window.lo[a] + window.size[a];
            }
            if (!near) continue;
            const int s = scratch.window[window.local(node)];
            if (s < 0) continue;
            scratch.near.push_back({s, candidate});
            ++sites_[s].n_candidates;
        }
    }
    int total = 0;
    for (int s = first; s < last; ++s) {
        sites_[s].candidate = total;
        total += sites_[s].n_candidates;
        sites_[s].n_candidates = 0;
    }
    candidates_[g].resize(static_cast<std::size_t>(total));
    for (const auto& [s, candidate] : scratch.near)
        candidates_[g][sites_[s].candidate + sites_[s].n_candidates++] = candidate;
}

template <int Dim>
void ContactNodes<Dim>::choose_all() {
    std::fill(awake_.begin(), awake_.end(), std::uint8_t{1});
    choose_at_ = travelled_;
    wake();
}

/// Makes slots for the nodes that are awake.
template <int Dim>
void ContactNodes<Dim>::wake() {
    const auto n_sites = [&](int i) { return found_begin_[i + 1] - found_begin_[i]; };
    page_nodes_.assign(pages_.size() + 1, 0);
    page_slots_.assign(pages_.size() + 1, 0);
    parallel::for_each(pages_.size(), [&](std::size_t k) {
        for (int i = page_found_[k]; i < page_found_[k + 1]; ++i)
            if (awake_[i]) {
                ++page_nodes_[k + 1];
                page_slots_[k + 1] += n_sites(i);
            }
    });
    std::partial_sum(page_nodes_.begin(), page_nodes_.end(), page_nodes_.begin());
    std::partial_sum(page_slots_.begin(), page_slots_.end(), page_slots_.begin());
    const std::size_t n_slots = static_cast<std::size_t>(page_slots_.back());
    node_slots_.resize(static_cast<std::size_t>(page_nodes_.back()) + 1);
    node_slots_.back() = page_slots_.back();
    n_near_.resize(n_slots);
    slot_order_.resize(n_slots);
    slots_.resize(n_slots);
    if (support_.size() < pages_.size()) {
        support_.resize(pages_.size());
        near_.resize(pages_.size());
    }
    parallel::for_each(pages_.size(), [&](std::size_t k) {
        int node = page_nodes_[k], slot = page_slots_[k];
        near_[k].clear();
        for (int i = page_found_[k]; i < page_found_[k + 1]; ++i) {
            if (!awake_[i]) continue;
            node_slots_[node++] = slot;
            for (int j = found_begin_[i]; j < found_begin_[i + 1]; ++j, ++slot) {
                const Site& site = sites_[found_sites_[j]];
                const std::span<const Candidate> candidates = candidates_of(site);
                slots_[slot].grain = site.grain;
                slots_[slot].index = site.index;
                slot_order_[slot] = slot;
                n_near_[slot] = site.n_candidates;
                near_[k].insert(near_[k].end(), candidates.begin(), candidates.end());
            }
        }
        support_[k].resize(near_[k].size());
    });
    grain_slots_.assign(windows_.size() + 1, 0);
    for (const Slot<Dim>& slot : slots_) ++grain_slots_[slot.grain + 1];
    std::partial_sum(grain_slots_.begin(), grain_slots_.end(), grain_slots_.begin());
    slot_of_grain_.resize(n_slots);
    std::vector<int> next(grain_slots_.begin(), grain_slots_.end() - 1);
    for (std::size_t s = 0; s < n_slots; ++s) slot_of_grain_[next[slots_[s].grain]++] = static_cast<int>(s);
}

template <int Dim>
void ContactNodes<Dim>::fill(const ContactScene<Dim>& scene, int page) {
    Support<Dim>* support = support_[page].data();
    const Candidate* near = near_[page].data();
    for (int s = page_slots_[page]; s < page_slots_[page + 1]; ++s) {
        fill_slot<Dim>(scene, grid_, options_.weights, {near, near + n_near_[s]}, slots_[s], support);
        support += slots_[s].n_support;
        near += n_near_[s];
    }
    for (int a = page_nodes_[page]; a < page_nodes_[page + 1]; ++a)
        std::sort(slot_order_.begin() + node_slots_[a], slot_order_.begin() + node_slots_[a + 1],
                  [&](int i, int j) {
                      const Vec<Dim>&a = slots_[i].xb, &b = slots_[j].xb;
                      return lower_first<Dim>(a, b) || (i < j && !lower_first<Dim>(b, a));
                  });
}

template <int Dim>
void ContactNodes<Dim>::fill(const ContactScene<Dim>& scene) {
    parallel::for_each(
        pages_.size(), [&](std::size_t page) { fill(scene, static_cast<int>(page)); }, serial_below());
}

template <int Dim>
double ContactNodes<Dim>::distance_to_surface(const ContactScene<Dim>& scene, const Site& site) const {
    const Grain<Dim>& grain = scene.grains[site.grain];
    const Vec<Dim> x_node = grid_.node_position(site.index);
    double least = furthest_candidate * grid_.h();
    for (const Candidate candidate : candidates_of(site)) {
        if (candidate >= 0) continue;
        const int p = grain.first + grain.shape->surface[-1 - candidate].node;
        least = std::min(least, (scene.x[p] - x_node).cwiseAbs().maxCoeff());
    }
    return std::max(least / grid_.h() - 1.0, 0.0);
}

template class ContactNodes<2>;
template class ContactNodes<3>;

}  // namespace quern
