#include "src/pack/make_packing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "grid/error.hpp"
#include "src/pack/measure.hpp"
#include "src/pack/sizes.hpp"
#include "src/pack/soft_grains.hpp"

namespace quern {
namespace {

using std::numbers::pi;

constexpr int largest_count = 200000;

std::string where(const PackSpec& spec, const char* key) {
    return Place{spec.file, 0, key}.text();
}

std::vector<Outline> make_outlines(const PackSpec& spec) {
    std::vector<Outline> outlines;
    for (const PackShape& shape : spec.shapes) outlines.push_back(make_outline(shape));
    if (outlines.empty()) {
        ShapeDeck disk;
        disk.radius = 0.5;
        outlines.push_back(make_outline(disk));
    }
    return outlines;
}

/// Outlines of n grains by their shares, largest remainders first, in random order.
std::vector<int> draw_outlines(const PackSpec& spec, int n, portable::Random& random) {
    if (spec.shapes.size() < 2) return std::vector<int>(static_cast<std::size_t>(n), 0);
    double sum = 0.0, before = 0.0;
    for (const PackShape& shape : spec.shapes) sum += shape.share;
    std::vector<int> outlines;
    for (std::size_t k = 0; k < spec.shapes.size(); ++k) {
        before += spec.shapes[k].share;
        const auto end = static_cast<std::size_t>(std::floor(n * before / sum + 0.5));
        while (outlines.size() < end) outlines.push_back(static_cast<int>(k));
    }
    outlines.resize(static_cast<std::size_t>(n), static_cast<int>(spec.shapes.size()) - 1);
    for (int i = n - 1; i > 0; --i) std::swap(outlines[i], outlines[random.below(i + 1)]);
    return outlines;
}

/// Area that grains lay over open edges: measured, 0.2 times the length of the edge and the mean size,
/// weighted by the sizes along it.
double area_over_edges(const PackSpec& spec, const SizeDistribution& sizes) {
    double length = 0.0;
    for (int axis = 0; axis < 2; ++axis)
        if (spec.region.open(axis)) length += 2.0 * spec.region.length(1 - axis);
    return 0.35 * length * sizes.mean_square() / sizes.mean();
}

int count_grains(const PackSpec& spec, const SizeDistribution& sizes) {
    if (spec.count > 0) return spec.count;
    const double area = *spec.solid_fraction * spec.region.area() + area_over_edges(spec, sizes);
    const double n = std::floor(area / (0.25 * pi * sizes.mean_square()) + 0.5);
    if (n >= 1.0 && n <= largest_count) return static_cast<int>(n);
    throw InputError(where(spec, "sizes"), fmt::format("about {:.0f} grains", n),
                     fmt::format("1 to {} grains", largest_count), "check the units");
}

/// Grains of the sizes drawn must fit the region, periodic ones without meeting their own images.
void check_sizes(const PackSpec& spec, const PackedGrains& grains) {
    double widest = 0.0;
    for (std::size_t i = 0; i < grains.size.size(); ++i)
        widest = std::max(widest, 2.2 * grains.reach(static_cast<int>(i)));
    const Region& region = spec.region;
    for (int axis = 0; axis < 2; ++axis) {
        const double needed = region.periodic(axis) ? 2.0 * widest : region.open(axis) ? 0.0 : widest;
        if (region.length(axis) > needed) continue;
        throw InputError(spec.region.place.text(),
                         fmt::format("{:.6g} m along {} for grains up to {:.6g} m", region.length(axis),
                                     axis == 0 ? "x" : "y", widest),
                         fmt::format("more than {:.6g} m", needed),
                         region.periodic(axis) ? "twice the largest grain" : "");
    }
}

PackedGrains scatter(const PackSpec& spec, const SizeDistribution& sizes, int n, portable::Random& random) {
    PackedGrains grains;
    grains.region = spec.region;
    grains.outlines = make_outlines(spec);
    grains.size = sizes.draw(n, random);
    grains.outline = draw_outlines(spec, n, random);
    check_sizes(spec, grains);
    while (grains.n() < n) {
        const double u = random.uniform(), v = random.uniform();
        const double x = spec.region.low[0] + u * spec.region.length(0);
        const double y = spec.region.low[1] + v * spec.region.length(1);
        const double dx = x - spec.region.centre[0], dy = y - spec.region.centre[1];
        if (spec.region.circle && dx * dx + dy * dy > spec.region.radius * spec.region.radius) continue;
        const portable::Direction turn = portable::direction(2.0 * pi * random.uniform());
        grains.x.push_back(x);
        grains.y.push_back(y);
        grains.c.push_back(turn.cos);
        grains.s.push_back(turn.sin);
    }
    return grains;
}

class Packer {
  public:
    Packer(const PackSpec& spec, PackedGrains grains, portable::Random& random, const PackProgress& progress)
        : progress_(progress), random_(random), soft_(std::move(grains)) {
        for (const double size : soft_.grains().size) area_ += 0.25 * pi * size * size;
        area_ /= spec.region.area();
    }

    /// Factor of all sizes at which the areas of whole grains make a fraction of the region.
    double factor_of(double fraction) const { return std::sqrt(fraction / area_); }
    double whole_fraction() const { return area_; }

    void grow(double fraction) {
        constexpr int n_steps = 40;
        for (int step = 0; step < n_steps; ++step) {
            const double now = fraction * (0.33 + 0.62 * step / (n_steps - 1));
            tell(growth_part * step / n_steps, now);
            set(factor_of(now));
            soft_.relax(500);
        }
    }

    /// No overlap at this factor, found with at most so many rounds.
    bool settle(double factor, int n_rounds) {
        constexpr int between_tries = 5;
        set(factor);
        if (soft_.relax(2000) == SoftGrains::Rest::free) return true;
        for (int round = 0; round < n_rounds; ++round) {
            // More compression where overlap is large anyway does not help.
            const double over = round < 20 ? 1.02 : 1.01;
            set(factor * std::sqrt(over));
            for (int sweep = 0; sweep < 3; ++sweep) soft_.exchange(random_, 0.05);
            soft_.relax(150);
            ++rounds_;
            tell(growth_part + (1.0 - growth_part) * round / n_rounds, area_ * factor * factor);
            if (round % between_tries != between_tries - 1) continue;
            const PackedGrains dense = soft_.grains();
            set(factor);
            if (soft_.relax(2000) == SoftGrains::Rest::free) return true;
            soft_.set_places(dense);
        }
        return false;
    }

    /// A factor below `factor` without overlap: down by 1 % of area until there is none, then up by 0.1 %.
    double loosen(double factor) {
        constexpr int n_steps = 3000;
        do {
            factor *= std::sqrt(0.99);
            set(factor);
        } while (soft_.relax(n_steps) != SoftGrains::Rest::free);
        for (;;) {
            const PackedGrains loose = soft_.grains();
            const double tighter = factor * std::sqrt(1.001);
            set(tighter);
            if (soft_.relax(n_steps) != SoftGrains::Rest::free) {
                soft_.set_places(loose);
                return factor;
            }
            factor = tighter;
        }
    }

    const PackedGrains& grains() const { return soft_.grains(); }
    int rounds() const { return rounds_; }

  private:
    static constexpr double growth_part = 0.1;

    void set(double factor) { soft_.set_factor(factor * (1.0 + SoftGrains::slack)); }
    void tell(double done, double fraction) const {
        if (progress_) progress_(done, fraction, soft_.deepest());
    }

    const PackProgress& progress_;
    portable::Random& random_;
    SoftGrains soft_;
    double area_ = 0.0;
    int rounds_ = 0;
};

/// Rounded, so that the last bits of the mathematics library do not come back into the packing.
double cut_fraction(const PackedGrains& grains, double factor) {
    return std::round(1e6 * solid_fraction(grains, factor)) / 1e6;
}

void check_factor(const PackSpec& spec, double factor, double fraction, int n) {
    if (spec.count == 0 || std::abs(factor - 1.0) <= 0.1) return;
    throw InputError(where(spec, "count"),
                     fmt::format("{} grains that fill {:.3g} of the region", n, fraction / (factor * factor)),
                     fmt::format("sizes that change by less than 10 % to fill {:.3g}", fraction),
                     fmt::format("count: {:.0f} would do", n * factor * factor));
}

}  // namespace

Packing make_packing(const PackSpec& spec, const PackProgress& progress) {
    portable::Random random(static_cast<std::uint64_t>(spec.seed));
    const SizeDistribution sizes(spec.sizes);
    const int n = count_grains(spec, sizes);
    Packer packer(spec, scatter(spec, sizes, n, random), random, progress);
    const double over_edges = area_over_edges(spec, sizes) / spec.region.area();
    Packing packing;
    packing.asked = spec.solid_fraction.value_or(packer.whole_fraction());
    double factor = spec.solid_fraction ? packer.factor_of(*spec.solid_fraction + over_edges) : 1.0;
    check_factor(spec, factor, packing.asked + over_edges, n);
    if (factor * factor * packer.whole_fraction() - over_edges > 0.99)
        throw InputError(where(spec, "count"),
                         fmt::format("{} grains that fill {:.3g} of the region", n, packer.whole_fraction()),
                         "grains that fill less than the region");
    packer.grow(factor * factor * packer.whole_fraction());
    packing.reached = packer.settle(factor, spec.rounds);
    bool open = spec.solid_fraction && (spec.region.open(0) || spec.region.open(1));
    for (int pass = 0; open && packing.reached && pass < 8; ++pass) {
        const double now = cut_fraction(packer.grains(), factor);
        if (std::abs(now - packing.asked) < 5e-5) break;
        factor *= std::sqrt(packing.asked / now);
        packing.reached = packer.settle(factor, spec.rounds);
    }
    if (!packing.reached) factor = packer.loosen(factor);

    packing.grains = packer.grains();
    wrap(packing.grains);
    packing.rounds = packer.rounds();
    for (double& size : packing.grains.size) size *= factor;
    packing.size_factor = factor;
    for (double depth = deepest_overlap(packing.grains); depth > 1e-9;
         depth = deepest_overlap(packing.grains)) {
        for (double& size : packing.grains.size) size *= 1.0 - 1.01 * depth;
        packing.size_factor *= 1.0 - 1.01 * depth;
        packing.shrink += 1.01 * depth;
    }
    packing.fraction = solid_fraction(packing.grains, 1.0);
    return packing;
}

}  // namespace quern
