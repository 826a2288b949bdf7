#include "contact/node_pair_list.hpp"

#include <algorithm>
#include <limits>

#include "grid/parallel.hpp"

namespace quern {

namespace {

constexpr double layers = 1.5;  ///< depth of the nodes that take part below the surface nodes [spacings]

struct Largest {
    double value = 0.0;
    Largest& operator+=(const Largest& other) {
        value = std::max(value, other.value);
        return *this;
    }
};

}  // namespace

template <int Dim>
bool NodePairList<Dim>::update(const ContactScene<Dim>& scene) {
    if (serves(scene)) return false;
    search(scene);
    return true;
}

template <int Dim>
bool NodePairList<Dim>::serves(const ContactScene<Dim>& scene) {
    if (!searched_ || outdated_ || skin() == 0.0) return false;
    const bool known = std::isfinite(scene.travelled);
    if (known && scene.travelled >= search_by_) return false;
    if (known && scene.travelled < check_at_) return true;
    double moved = parallel::sum(particle_.size(), Largest{}, [&](std::size_t row) {
                       return Largest{(scene.x[particle_[row]] - x_[row]).squaredNorm()};
                   }).value;
    for (std::size_t w = 0; w < wall_x_.size(); ++w)
        moved = std::max(moved, (scene.walls[w].point - wall_x_[w]).squaredNorm());
    const double left = 0.5 * skin() - std::sqrt(moved);
    if (known) check_at_ = scene.travelled + left;
    return left > 0.0;
}

template <int Dim>
const std::vector<int>& NodePairList<Dim>::surface_nodes(const Shape<Dim>& shape) {
    for (const auto& [known, nodes] : surface_nodes_)
        if (known == &shape) return nodes;
    std::vector<Vec<Dim>> points;
    for (const SurfacePoint<Dim>& point : shape.surface) points.push_back(shape.X[point.node]);
    const double depth = layers * shape.dx;
    PointCells<Dim> cells;
    cells.sort(points, depth, nullptr);
    std::vector<int> near;
    for (int i = 0; i < shape.n_nodes(); ++i) {
        bool found = false;
        cells.visit_near(shape.X[i], [&](int s) {
            found = found || (points[s] - shape.X[i]).squaredNorm() <= depth * depth;
        });
        if (found) near.push_back(i);
    }
    return surface_nodes_.emplace_back(&shape, std::move(near)).second;
}

template <int Dim>
void NodePairList<Dim>::choose_rows(const ContactScene<Dim>& scene) {
    particle_.clear();
    grain_.clear();
    grain_rows_.assign(1, 0);
    row_of_.assign(scene.x.size(), -1);
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        const Grain<Dim>& grain = scene.grains[g];
        const auto add = [&](int node) {
            row_of_[grain.first + node] = n_rows();
            particle_.push_back(grain.first + node);
            grain_.push_back(static_cast<int>(g));
        };
        if (law_->options().particles == PairParticles::all || broken(static_cast<int>(g)))
            for (int i = 0; i < grain.count; ++i) add(i);
        else
            for (const int i : surface_nodes(*grain.shape)) add(i);
        grain_rows_.push_back(n_rows());
    }
}

template <int Dim>
void NodePairList<Dim>::search(const ContactScene<Dim>& scene) {
    std::swap(row_of_, old_row_of_);
    std::swap(first_, old_first_);
    std::swap(partner_, old_partner_);
    std::swap(slip_, old_slip_);
    choose_rows(scene);
    const std::size_t n_rows = particle_.size();
    x_.resize(n_rows);
    for (std::size_t row = 0; row < n_rows; ++row) x_[row] = scene.x[particle_[row]];
    wall_x_.clear();
    for (const Wall<Dim>& wall : scene.walls) wall_x_.push_back(wall.point);
    cells_.sort(x_, law_->largest_radius() + skin(), &grid_);

    blocks_.resize((n_rows + rows_per_block - 1) / rows_per_block);
    parallel::for_each(blocks_.size(), [&](std::size_t b) {
        Block& block = blocks_[b];
        block.found.clear();
        block.count.clear();
        const int begin = static_cast<int>(b) * rows_per_block;
        for (int row = begin; row < std::min(begin + rows_per_block, static_cast<int>(n_rows)); ++row) {
            const std::size_t before = block.found.size();
            find_partners(scene, row, block);
            block.count.push_back(static_cast<int>(block.found.size() - before));
        }
    });
    first_.assign(1, 0);
    for (const Block& block : blocks_)
        for (const int count : block.count) first_.push_back(first_.back() + count);
    listed_.clear();
    grain_listed_.assign(1, 0);
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        for (int row = grain_rows_[g]; row < grain_rows_[g + 1]; ++row)
            if (first_[row] < first_[row + 1]) listed_.push_back(row);
        grain_listed_.push_back(static_cast<int>(listed_.size()));
    }
    const std::size_t n = static_cast<std::size_t>(first_.back());
    partner_.resize(n);
    radius_.resize(n);
    stiffness_.resize(n);
    slip_.resize(keeps_slip() ? n : 0);
    parallel::for_each(blocks_.size(), [&](std::size_t b) {
        std::size_t e = static_cast<std::size_t>(first_[b * rows_per_block]);
        for (const Found& found : blocks_[b].found) {
            partner_[e] = found.partner;
            radius_[e] = found.radius;
            stiffness_[e] = found.stiffness;
            if (keeps_slip()) slip_[e] = found.slip;
            ++e;
        }
    });
    searched_ = true;
    outdated_ = false;
    check_at_ = scene.travelled + 0.5 * skin();
    search_by_ = std::numeric_limits<double>::infinity();
}

/// Whether two nodes of a grain are no longer held together by a bond of their own.
template <int Dim>
bool NodePairList<Dim>::parted(const ContactScene<Dim>& scene, int g, int node, int other) const {
    const Grain<Dim>& grain = scene.grains[g];
    const double length = grain.scale * (grain.shape->X[node] - grain.shape->X[other]).norm();
    if (length > law_->body(g).horizon) return true;
    const BrokenBond bond{std::min(node, other), std::max(node, other)};
    return std::binary_search(broken_[g].begin(), broken_[g].end(), bond);
}

template <int Dim>
void NodePairList<Dim>::find_partners(const ContactScene<Dim>& scene, int row, Block& block) const {
    const int p = particle_[row], g = grain_[row];
    const Vec<Dim>& x = x_[row];
    const double V = scene.volume[p], margin = skin();
    const std::size_t before = block.found.size();
    const auto add = [&](int partner, double radius, double stiffness) {
        block.found.push_back({partner, radius, stiffness, Vec<Dim>::Zero()});
    };
    const double wall_radius = law_->radius(g, p, g, p), wall_stiffness = law_->stiffness(g, g) * V * V;
    for (std::size_t w = scene.walls.size(); w-- > 0;)
        if (!scene.grains[g].wall && 2.0 * scene.walls[w].distance(x) < wall_radius + 2.0 * margin)
            add(-1 - static_cast<int>(w), wall_radius, wall_stiffness);
    const bool meets_itself = law_->options().self_contact && broken(g);
    const double self_radius = law_->self_radius(g);
    int of_grain = -1;
    double K = 0.0;
    cells_.visit_near(x, [&](int s) {
        const int h = grain_[s], q = particle_[s];
        if (h == g ? !meets_itself || q == p : scene.grains[g].wall && scene.grains[h].wall) return;
        const double R = h == g ? self_radius : law_->radius(g, p, h, q), reach = R + margin;
        if (nearest_(x, x_[s]).squaredNorm() > reach * reach) return;
        const int first = scene.grains[g].first;
        if (h == g && !parted(scene, g, p - first, q - first)) return;
        if (of_grain != h) K = law_->stiffness(g, of_grain = h);
        add(q, R, K * V * scene.volume[q]);
    });
    const auto ascending = [](const Found& a, const Found& b) { return a.partner < b.partner; };
    const auto begin = [&] { return block.found.begin() + static_cast<std::ptrdiff_t>(before); };
    std::sort(begin(), block.found.end(), ascending);
    const int old = old_row_of_.empty() || !keeps_slip() ? -1 : old_row_of_[p];
    if (old < 0) return;
    for (int e = old_first_[old]; e < old_first_[old + 1]; ++e) {
        if (old_slip_[e].isZero(0.0)) continue;
        const auto found =
            std::lower_bound(begin(), block.found.end(), Found{old_partner_[e], 0, 0, {}}, ascending);
        // One that has left goes on for a step, in which its spring is let go and accounted for.
        if (found == block.found.end() || found->partner != old_partner_[e]) {
            const int q = old_partner_[e];
            const double k =
                q < 0 ? wall_stiffness : law_->stiffness(g, grain_[row_of_[q]]) * V * scene.volume[q];
            block.found.insert(found, {q, 0.0, k, old_slip_[e]});
        } else {
            found->slip = old_slip_[e];
        }
    }
}

template <int Dim>
double NodePairList<Dim>::set_broken(const ContactScene<Dim>& scene, int g, std::vector<BrokenBond> bonds) {
    broken_.resize(scene.grains.size());
    const Grain<Dim>& grain = scene.grains[g];
    const double R = law_->self_radius(g), K = law_->stiffness(g, g);
    double energy = 0.0, nearest = std::numeric_limits<double>::infinity();
    for (const BrokenBond& bond : bonds) {
        if (std::binary_search(broken_[g].begin(), broken_[g].end(), bond)) continue;
        const int p = grain.first + bond.first, q = grain.first + bond.second;
        const double over = R - nearest_(scene.x[p], scene.x[q]).norm();
        nearest = std::min(nearest, -over);
        if (over > 0.0) energy += 0.5 * K * scene.volume[p] * scene.volume[q] * over * over;
    }
    // Both ends move by no more than `travelled` grows: until then a list without the new pairs serves.
    if (broken_[g].empty() || !std::isfinite(scene.travelled)) outdated_ = true;
    search_by_ = std::min(search_by_, scene.travelled + 0.5 * std::max(nearest, 0.0));
    broken_[g] = std::move(bonds);
    return energy;
}

template <int Dim>
void NodePairList<Dim>::save(PairMemory<Dim>& memory) const {
    for (int row = 0; row < n_rows() && keeps_slip(); ++row)
        for (int e = first_[row]; e < first_[row + 1]; ++e)
            if (!slip_[e].isZero(0.0)) {
                memory.particle.push_back(particle_[row]);
                memory.partner.push_back(partner_[e]);
                memory.slip.push_back(slip_[e]);
            }
}

template <int Dim>
void NodePairList<Dim>::recall(const PairMemory<Dim>& memory, std::size_t n_particles) {
    searched_ = false;
    row_of_.assign(n_particles, -1);
    first_.assign(1, 0);
    partner_.assign(memory.partner.begin(), memory.partner.end());
    slip_ = memory.slip;
    for (std::size_t k = 0; k < memory.particle.size(); ++k) {
        int& row = row_of_[static_cast<std::size_t>(memory.particle[k])];
        if (row < 0) {
            row = static_cast<int>(first_.size()) - 1;
            first_.push_back(first_.back());
        }
        ++first_.back();
    }
}

template class NodePairList<2>;
template class NodePairList<3>;

}  // namespace quern
