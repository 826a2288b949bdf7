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
    const std::size_t n_grains = scene.grains.size();
    windows_.resize(n_grains);
    touched_.resize(n_grains);
    support_.resize(n_grains);
    n_selected_.resize(n_grains);
    scratch_.resize(static_cast<std::size_t>(parallel::n_threads()));
    mark_touched(scene);
    select(scene);
    number_nodes();
    parallel::for_each(n_grains, [&](std::size_t g) {
        fill_slots(scene, static_cast<int>(g), scratch_[static_cast<std::size_t>(parallel::thread_id())]);
    });
    parallel::for_each(
        static_cast<std::size_t>(n_nodes()),
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
        Window& window = windows_[g];  // one more layer all around for the quadratic stencil
        window.lo = lo - IntVec<Dim>::Ones();
        window.size = hi - lo + IntVec<Dim>::Constant(4);
        scratch.window.assign(static_cast<std::size_t>(window.n()), 0);
        auto mark = [&](int p) {
            const LinearStencil<Dim> stencil(grid_.in_cells(scene.x[p]));
            for (int k = 0; k < stencil.size; ++k) scratch.window[window.local(stencil.node(k))] = 1;
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
        return options_.all_particles ? distance <= options_.wall_reach * grid_.h()
                                      : std::abs(distance) <= options_.wall_reach * grid_.h();
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
    int n_contact_nodes = 0;
    node_begin_.assign(1, 0);
    for (std::size_t g = 0; g < n_grains; ++g) {
        for (int k = 0; k < n_selected_[g]; ++k) {
            Slot<Dim>& slot = slots_[grain_slots_[g] + k];
            slot.grain = static_cast<int>(g);
            slot.index = windows_[g].node(touched_[g][k]);
            std::int32_t& mark = marks_[wrapped(slot.index)];
            if (mark >= 0) {
                mark = -1 - n_contact_nodes++;
                node_begin_.push_back(0);
            }
            slot.node = -1 - mark;
            ++node_begin_[slot.node + 1];
        }
    }
    std::partial_sum(node_begin_.begin(), node_begin_.end(), node_begin_.begin());
    node_slots_.resize(slots_.size());
    std::vector<int>& fill = scratch_[0].count;
    fill.assign(node_begin_.begin(), node_begin_.end());
    for (std::size_t s = 0; s < slots_.size(); ++s) node_slots_[fill[slots_[s].node]++] = static_cast<int>(s);
    parallel::for_each(n_grains, [&](std::size_t g) {
        for (const int i : touched_[g])
            std::atomic_ref<std::int32_t>(marks_[wrapped(windows_[g].node(i))])
                .store(0, std::memory_order_relaxed);
    });
}

/// Particles in cells near a slot, in their order.
template <int Dim>
void ContactNodes<Dim>::find_near_particles(const ContactScene<Dim>& scene, const Grain<Dim>& grain,
                                            const Window& window, Scratch& scratch) const {
    const std::vector<SurfacePoint<Dim>>& surface = grain.shape->surface;
    std::size_t next_surface = 0;
    scratch.near.clear();
    for (int i = 0; i < grain.count; ++i) {
        const bool on_surface = next_surface < surface.size() && surface[next_surface].node == i;
        const int surface_index = on_surface ? static_cast<int>(next_surface++) : -1;
        const Vec<Dim> in_cells = grid_.in_cells(scene.x[grain.first + i]);
        if (scratch.near_cell[window.local(CartesianGrid<Dim>::cell(in_cells))])
            scratch.near.push_back({grain.first + i, surface_index, in_cells});
    }
}

template <int Dim>
void ContactNodes<Dim>::fill_slots(const ContactScene<Dim>& scene, int g, Scratch& scratch) {
    const auto [first, last] = slots_of_grain(g);
    if (first == last) return;
    const Grain<Dim>& grain = scene.grains[g];
    const Window& window = windows_[g];
    const double h = grid_.h();
    scratch.window.assign(static_cast<std::size_t>(window.n()), -1);
    scratch.near_cell.assign(static_cast<std::size_t>(window.n()), 0);
    for (int s = first; s < last; ++s) {
        Slot<Dim>& slot = slots_[s];
        scratch.window[window.local(slot.index)] = s - first;
        slot.n_support = 0;
        slot.volume = 0.0;
        slot.gradient.setZero();
        // Cells whose quadratic stencils can reach the node: up to two below it, one above.
        for (int k = 0; k < power(4, Dim); ++k) {
            IntVec<Dim> cell;
            bool inside = true;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= 4) {
                cell[a] = slot.index[a] - 2 + rest % 4;
                inside = inside && cell[a] >= window.lo[a] && cell[a] < window.lo[a] + window.size[a];
            }
            if (inside) scratch.near_cell[window.local(cell)] = 1;
        }
    }
    find_near_particles(scene, grain, window, scratch);
    for (const NearParticle<Dim>& near : scratch.near) {
        const QuadraticStencil<Dim> stencil(near.in_cells);
        const IntVec<Dim> cell = CartesianGrid<Dim>::cell(near.in_cells);
        const double volume = scene.volume[near.particle];
        for (int k = 0; k < stencil.size; ++k) {
            const IntVec<Dim> node = stencil.node(k);
            const int local = scratch.window[window.local(node)];
            if (local < 0) continue;
            Slot<Dim>& slot = slots_[first + local];
            slot.gradient -= volume / h * stencil.gradient(k);  // by the node: minus by the point
            const IntVec<Dim> offset = node - cell;
            if (offset.minCoeff() >= 0 && offset.maxCoeff() <= 1) ++slot.n_support;
        }
    }
    scratch.count.resize(static_cast<std::size_t>(last - first));
    int total = 0;
    for (int s = first; s < last; ++s) {
        scratch.count[s - first] = total;
        total += slots_[s].n_support;
    }
    std::vector<Support<Dim>>& support = support_[g];
    support.resize(static_cast<std::size_t>(total));
    for (const NearParticle<Dim>& near : scratch.near) {
        const LinearStencil<Dim> stencil(near.in_cells);
        for (int k = 0; k < stencil.size; ++k) {
            const int local = scratch.window[window.local(stencil.node(k))];
            if (local < 0) continue;
            Slot<Dim>& slot = slots_[first + local];
            const double N = stencil.N[k];
            const double w =
                options_.nodal ? N : (near.surface >= 0 ? 1.0 : options_.interior_weight) * N * N;
            support[scratch.count[local]++] = {near.particle, near.surface, N, w,
                                               scene.x[near.particle] - grid_.node_position(slot.index)};
            slot.volume += N * scene.volume[near.particle];
        }
    }
    int begin = 0;
    for (int s = first; s < last; ++s) {
        Slot<Dim>& slot = slots_[s];
        slot.support = support.data() + begin;
        begin += slot.n_support;
        slot.m = 0.0;
        slot.xb.setZero();
        for (int k = 0; k < slot.n_support; ++k) {
            const Support<Dim>& e = slot.support[k];
            slot.m += scene.mass[e.particle] * e.w;
            slot.xb += scene.mass[e.particle] * e.w * e.d;
        }
        if (slot.m > 0.0) slot.xb /= slot.m;
        Mat<Dim> second = Mat<Dim>::Zero();
        for (int k = 0; k < slot.n_support; ++k) {
            const Support<Dim>& e = slot.support[k];
            const Vec<Dim> r = e.d - slot.xb;
            second += scene.mass[e.particle] * e.w * r * r.transpose();
        }
        slot.rotates = invert_inertia(second, slot.m, h, slot.Y);
    }
}

template class ContactNodes<2>;
template class ContactNodes<3>;

}  // namespace quern
