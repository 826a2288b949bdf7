#include "contact/contact_nodes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <climits>
#include <numeric>

#include "grid/parallel.hpp"

namespace quern {

namespace {

/// Below this smallest moment of inertia [m h^2] a slot is a point or a line and does not turn.
constexpr double degenerate_inertia = 1e-3;

bool invert_inertia(const Mat<2>& second, double m, double h, Eigen::Matrix<double, 1, 1>& Y) {
    const double inertia = second.trace();
    const bool usable = m > 0.0 && inertia >= degenerate_inertia * m * h * h;
    Y(0, 0) = usable ? 1.0 / inertia : 0.0;
    return usable;
}

bool invert_inertia(const Mat<3>& second, double m, double h, Mat<3>& Y) {
    const Mat<3> inertia = second.trace() * Mat<3>::Identity() - second;
    Eigen::SelfAdjointEigenSolver<Mat<3>> eigen;
    eigen.computeDirect(inertia, Eigen::EigenvaluesOnly);
    const bool usable = m > 0.0 && eigen.eigenvalues()[0] >= degenerate_inertia * m * h * h;
    Y = usable ? Mat<3>(inertia.inverse()) : Mat<3>(Mat<3>::Zero());
    return usable;
}

template <int Dim>
bool lower_first(const Vec<Dim>& a, const Vec<Dim>& b) {
    return std::lexicographical_compare(a.data(), a.data() + Dim, b.data(), b.data() + Dim);
}

}  // namespace

template <int Dim>
void ContactNodes<Dim>::find(const ContactScene<Dim>& scene) {
    searched_ = !(options_.skin > 0.0) || moved(scene);
    if (searched_) search(scene);
    parallel::for_each(scene.grains.size(), [&](std::size_t g) { fill_slots(scene, static_cast<int>(g)); });
    if (searched_) index_nodes();
    order_slots();
}

template <int Dim>
bool ContactNodes<Dim>::moved(const ContactScene<Dim>& scene) const {
    if (x_searched_.size() != scene.x.size() || wall_searched_.size() != scene.walls.size()) return true;
    const double skin = options_.skin * grid_.h();
    for (std::size_t w = 0; w < scene.walls.size(); ++w)
        if (std::abs(scene.walls[w].normal.dot(scene.walls[w].point - wall_searched_[w])) > skin) return true;
    const int n_moved = parallel::sum(
        scene.grains.size(), 0,
        [&](std::size_t g) {
            const Grain<Dim>& grain = scene.grains[g];
            double furthest = 0.0;
            for (int p = grain.first; p < grain.first + grain.count; ++p)
                furthest = std::max(furthest, (scene.x[p] - x_searched_[p]).squaredNorm());
            return furthest > skin * skin ? 1 : 0;
        },
        32);
    return n_moved > 0;
}

template <int Dim>
void ContactNodes<Dim>::search(const ContactScene<Dim>& scene) {
    const std::size_t n_grains = scene.grains.size();
    windows_.resize(n_grains);
    touched_.resize(n_grains);
    candidates_.resize(n_grains);
    support_.resize(n_grains);
    n_selected_.resize(n_grains);
    scratch_.resize(static_cast<std::size_t>(parallel::n_threads()));
    mark_touched(scene);
    select(scene);
    number_nodes();
    parallel::for_each(n_grains, [&](std::size_t g) {
        list_candidates(scene, static_cast<int>(g),
                        scratch_[static_cast<std::size_t>(parallel::thread_id())]);
    });
    if (options_.skin > 0.0) x_searched_.assign(scene.x.begin(), scene.x.end());
    wall_searched_.clear();
    for (const Wall<Dim>& wall : scene.walls) wall_searched_.push_back(wall.point);
}

template <int Dim>
void ContactNodes<Dim>::keep_only(const std::vector<std::uint8_t>& wanted) {
    std::vector<int>& number = fill_;
    number.assign(static_cast<std::size_t>(n_nodes_), -1);
    n_nodes_ = 0;
    for (std::size_t a = 0; a < number.size(); ++a)
        if (wanted[a]) number[a] = n_nodes_++;
    std::size_t n_kept = 0;
    for (std::size_t g = 0; g + 1 < grain_slots_.size(); ++g) {
        const int first = grain_slots_[g];
        grain_slots_[g] = static_cast<int>(n_kept);
        for (int s = first; s < grain_slots_[g + 1]; ++s)
            if (number[slots_[s].node] >= 0) {
                slots_[n_kept] = slots_[s];
                slots_[n_kept].node = number[slots_[s].node];
                ++n_kept;
            }
    }
    grain_slots_.back() = static_cast<int>(n_kept);
    slots_.resize(n_kept);
    index_nodes();
    order_slots();
}

/// Slots of every node.
template <int Dim>
void ContactNodes<Dim>::index_nodes() {
    node_begin_.assign(static_cast<std::size_t>(n_nodes_) + 1, 0);
    for (const Slot<Dim>& slot : slots_) ++node_begin_[slot.node + 1];
    std::partial_sum(node_begin_.begin(), node_begin_.end(), node_begin_.begin());
    node_slots_.resize(slots_.size());
    fill_.assign(node_begin_.begin(), node_begin_.end());
    for (std::size_t s = 0; s < slots_.size(); ++s)
        node_slots_[fill_[slots_[s].node]++] = static_cast<int>(s);
}

/// Slots of a node, ordered by where their mass is now.
template <int Dim>
void ContactNodes<Dim>::order_slots() {
    parallel::for_each(
        static_cast<std::size_t>(n_nodes_),
        [&](std::size_t a) {
            std::sort(node_slots_.begin() + node_begin_[a], node_slots_.begin() + node_begin_[a + 1],
                      [&](int i, int j) { return lower_first<Dim>(slots_[i].xb, slots_[j].xb); });
        },
        256);
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

template <int Dim>
void ContactNodes<Dim>::select(const ContactScene<Dim>& scene) {
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
    const std::size_t n_grains = scene.grains.size();
    parallel::for_each(n_grains, [&](std::size_t g) {
        for (const int i : touched_[g])
            std::atomic_ref<std::int32_t>(marks_[wrapped(windows_[g].node(i))])
                .fetch_add(1, std::memory_order_relaxed);
    });
    parallel::for_each(n_grains, [&](std::size_t g) {  // selected ones to the front, both parts ascending
        const auto wanted = [&](int i) {
            const IntVec<Dim> node = windows_[g].node(i);
            return options_.all_nodes || marks_[wrapped(node)] > 1 || near_wall(scene, node);
        };
        const auto end = std::stable_partition(touched_[g].begin(), touched_[g].end(), wanted);
        n_selected_[g] = static_cast<int>(end - touched_[g].begin());
    });
}

template <int Dim>
void ContactNodes<Dim>::number_nodes() {
    const std::size_t n_grains = windows_.size();
    grain_slots_.assign(n_grains + 1, 0);
    std::partial_sum(n_selected_.begin(), n_selected_.end(), grain_slots_.begin() + 1);
    slots_.resize(static_cast<std::size_t>(grain_slots_.back()));
    n_nodes_ = 0;
    for (std::size_t g = 0; g < n_grains; ++g) {
        for (int k = 0; k < n_selected_[g]; ++k) {
            Slot<Dim>& slot = slots_[grain_slots_[g] + k];
            slot.grain = static_cast<int>(g);
            slot.index = windows_[g].node(touched_[g][k]);
            std::int32_t& mark = marks_[wrapped(slot.index)];
            if (mark >= 0) mark = -1 - n_nodes_++;
            slot.node = -1 - mark;
        }
    }
    parallel::for_each(n_grains, [&](std::size_t g) {
        for (const int i : touched_[g])
            std::atomic_ref<std::int32_t>(marks_[wrapped(windows_[g].node(i))])
                .store(0, std::memory_order_relaxed);
    });
}

/// Particles that have a slot in reach of their quadratic functions, or will before the next search.
template <int Dim>
void ContactNodes<Dim>::list_candidates(const ContactScene<Dim>& scene, int g, Scratch& scratch) {
    const auto [first, last] = slots_of_grain(g);
    if (first == last) return;
    const Grain<Dim>& grain = scene.grains[g];
    const Window& window = windows_[g];
    scratch.window.assign(static_cast<std::size_t>(window.n()), -1);
    scratch.near_cell.assign(static_cast<std::size_t>(window.n()), 0);
    constexpr int reach = 2, side = 2 * reach;  // cells of particles near a node: two to each side of it
    for (int s = first; s < last; ++s) {
        Slot<Dim>& slot = slots_[s];
        scratch.window[window.local(slot.index)] = s - first;
        slot.n_candidates = 0;
        for (int k = 0; k < power(side, Dim); ++k) {
            IntVec<Dim> cell;
            bool inside = true;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= side) {
                cell[a] = slot.index[a] - reach + rest % side;
                inside = inside && cell[a] >= window.lo[a] && cell[a] < window.lo[a] + window.size[a];
            }
            if (inside) scratch.near_cell[window.local(cell)] = 1;
        }
    }
    scratch.near.clear();
    const std::vector<SurfacePoint<Dim>>& surface = grain.shape->surface;
    const double furthest = 1.5 + options_.skin;
    std::size_t next_surface = 0;
    for (int i = 0; i < grain.count; ++i) {
        const bool on_surface = next_surface < surface.size() && surface[next_surface].node == i;
        const int surface_index = on_surface ? static_cast<int>(next_surface++) : -1;
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
            const int slot = scratch.window[window.local(node)];
            if (slot < 0) continue;
            scratch.near.push_back({slot, {grain.first + i, surface_index}});
            ++slots_[first + slot].n_candidates;
        }
    }
    std::size_t total = 0;
    for (int s = first; s < last; ++s) {
        slots_[s].candidate = total;
        total += static_cast<std::size_t>(slots_[s].n_candidates);
        slots_[s].n_candidates = 0;
    }
    candidates_[g].resize(total);
    support_[g].resize(total);
    for (const auto& [slot, candidate] : scratch.near) {
        Slot<Dim>& to = slots_[first + slot];
        candidates_[g][to.candidate + static_cast<std::size_t>(to.n_candidates++)] = candidate;
    }
}

template <int Dim>
void ContactNodes<Dim>::fill_slots(const ContactScene<Dim>& scene, int g) {
    const double h = grid_.h();
    const auto [first, last] = slots_of_grain(g);
    Support<Dim>* support = support_[g].data();
    for (int s = first; s < last; ++s) {
        Slot<Dim>& slot = slots_[s];
        const Candidate* const candidate = candidates_[g].data() + slot.candidate;
        const Vec<Dim> x_node = grid_.node_position(slot.index);
        const Vec<Dim> index = slot.index.template cast<double>();
        int n = 0;
        double volume = 0.0, m = 0.0;
        Vec<Dim> gradient = Vec<Dim>::Zero(), xb = Vec<Dim>::Zero();
        for (int k = 0; k < slot.n_candidates; ++k) {
            const auto [p, surface] = candidate[k];
            const Vec<Dim> t = grid_.in_cells(scene.x[p]) - index;
            if (t.cwiseAbs().maxCoeff() >= 1.5) continue;
            const double V = scene.volume[p];
            gradient -= V / h * quadratic_gradient<Dim>(t);  // by the node: minus by the point
            if (t.minCoeff() < -1.0 || t.maxCoeff() >= 1.0) continue;
            double N = 1.0;
            for (int a = 0; a < Dim; ++a) N *= 1.0 - std::abs(t[a]);
            const double w = options_.nodal ? N : (surface >= 0 ? 1.0 : options_.interior_weight) * N * N;
            const Vec<Dim> d = scene.x[p] - x_node;
            const double mw = scene.mass[p] * w;
            support[n++] = {p, surface, N, w, mw, d};
            volume += N * V;
            m += mw;
            xb += mw * d;
        }
        if (m > 0.0) xb /= m;
        Mat<Dim> second = Mat<Dim>::Zero();
        for (int k = 0; k < n; ++k) {
            const Vec<Dim> r = support[k].d - xb;
            second += support[k].mw * r * r.transpose();
        }
        slot.support = support;
        slot.n_support = n;
        slot.volume = volume;
        slot.gradient = gradient;
        slot.m = m;
        slot.xb = xb;
        slot.rotates = invert_inertia(second, m, h, slot.Y);
        support += n;
    }
}

template class ContactNodes<2>;
template class ContactNodes<3>;

}  // namespace quern
