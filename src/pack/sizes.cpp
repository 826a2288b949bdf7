#include "src/pack/sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "grid/error.hpp"

namespace quern {
namespace {

constexpr int n_steps = 4096;

/// ln of the number of grains per ln size, up to a constant.
double log_density(const SizeSpec& spec, double parameter, double log_size) {
    switch (spec.kind) {
        case SizeKind::lognormal: {
            const double z = (log_size - parameter) / spec.deviation;
            return -0.5 * z * z;
        }
        case SizeKind::power_law:
            return (1.0 - parameter) * log_size;
        case SizeKind::weibull:
            return spec.modulus * log_size - portable::exp(spec.modulus * (log_size - parameter));
        default:
            return log_size;
    }
}

}  // namespace

SizeDistribution::SizeDistribution(const SizeSpec& spec) {
    if (spec.kind == SizeKind::list || spec.kind == SizeKind::file) {
        discrete_ = true;
        sizes_ = spec.values;
        std::sort(sizes_.begin(), sizes_.end());
        for (const double d : sizes_) {
            mean_ += d / static_cast<double>(sizes_.size());
            mean_square_ += d * d / static_cast<double>(sizes_.size());
        }
        return;
    }
    if (!spec.mean) {
        tabulate(spec, spec.exponent.value_or(0.0));
        return;
    }
    const double range = portable::log(spec.max) - portable::log(spec.min), wide = 200.0 * range + 50.0;
    double low = portable::log(spec.min) - wide, high = portable::log(spec.max) + wide;
    const bool falls = spec.kind == SizeKind::power_law;  // the larger the exponent, the smaller the mean
    if (falls) low = -1000.0, high = 1000.0;
    for (int i = 0; i < 120; ++i) {
        const double middle = 0.5 * (low + high);
        tabulate(spec, middle);
        (falls == (mean_ > *spec.mean) ? low : high) = middle;
    }
    if (std::abs(mean_ - *spec.mean) < 1e-6 * *spec.mean) return;
    Place place = spec.place;
    place.key += ".mean";
    throw InputError(
        place.text(), fmt::format("{} m", *spec.mean),
        fmt::format("a mean that such a distribution has within its limits; the nearest is {:.6g} m", mean_));
}

void SizeDistribution::tabulate(const SizeSpec& spec, double parameter) {
    const double low = portable::log(spec.min), step = (portable::log(spec.max) - low) / n_steps;
    std::vector<double> weight(n_steps);
    double largest = -1e300;
    for (int i = 0; i < n_steps; ++i) {
        weight[i] = log_density(spec, parameter, low + (i + 0.5) * step);
        largest = std::max(largest, weight[i]);
    }
    const double growth = portable::exp(step);
    sizes_.assign(1, spec.min);
    share_.assign(1, 0.0);
    double sum = 0.0, first = 0.0, second = 0.0;
    for (int i = 0; i < n_steps; ++i) {
        const double w = weight[i] - largest < -700.0 ? 0.0 : portable::exp(weight[i] - largest);
        sizes_.push_back(i + 1 == n_steps ? spec.max : sizes_.back() * growth);
        const double d = 0.5 * (sizes_[i] + sizes_[i + 1]);
        sum += w;
        first += w * d;
        second += w * d * d;
        share_.push_back(sum);
    }
    for (double& share : share_) share /= sum;
    mean_ = first / sum;
    mean_square_ = second / sum;
}

double SizeDistribution::quantile(double share) const {
    if (discrete_) {
        const auto n = sizes_.size();
        return sizes_[std::min(n - 1, static_cast<std::size_t>(share * static_cast<double>(n)))];
    }
    const auto above = std::upper_bound(share_.begin(), share_.end() - 1, share);
    const std::size_t i = static_cast<std::size_t>(above - share_.begin()) - 1;
    const double part = (share - share_[i]) / std::max(share_[i + 1] - share_[i], 1e-300);
    return sizes_[i] + std::clamp(part, 0.0, 1.0) * (sizes_[i + 1] - sizes_[i]);
}

std::vector<double> SizeDistribution::draw(int n, portable::Random& random) const {
    std::vector<double> sizes;
    for (int i = 0; i < n; ++i) sizes.push_back(quantile((i + random.uniform()) / n));
    for (int i = n - 1; i > 0; --i) std::swap(sizes[i], sizes[random.below(i + 1)]);
    return sizes;
}

}  // namespace quern
