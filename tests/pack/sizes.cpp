// Sizes: means and limits of each distribution, and the functions and random numbers below them.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "grid/error.hpp"
#include "src/pack/sizes.hpp"
#include "tests/pack/specs.hpp"

using namespace quern;

namespace {

SizeSpec distribution(SizeKind kind, double mean) {
    SizeSpec spec;
    spec.kind = kind;
    spec.min = 31e-6;
    spec.max = 250e-6;
    if (kind != SizeKind::uniform) spec.mean = mean;
    spec.deviation = 0.5;
    spec.modulus = 1.5;
    return spec;
}

double mean_of(const std::vector<double>& sizes) {
    return std::accumulate(sizes.begin(), sizes.end(), 0.0) / static_cast<double>(sizes.size());
}

}  // namespace

TEST_CASE("SizeDistribution: the mean is the one given, sizes stay within the limits") {
    portable::Random random(1);
    for (const SizeKind kind : {SizeKind::lognormal, SizeKind::power_law, SizeKind::weibull}) {
        CAPTURE(static_cast<int>(kind));
        const SizeDistribution sizes(distribution(kind, 57e-6));
        CHECK(sizes.mean() == doctest::Approx(57e-6).epsilon(1e-6));
        const std::vector<double> drawn = sizes.draw(2000, random);
        CHECK(std::abs(mean_of(drawn) / 57e-6 - 1.0) < 1e-3);  // measured 8e-5, bound 1e-3
        CHECK(*std::min_element(drawn.begin(), drawn.end()) >= 31e-6);
        CHECK(*std::max_element(drawn.begin(), drawn.end()) <= 250e-6);
    }
}

TEST_CASE("SizeDistribution: uniform sizes have the mean of their limits and of their squares") {
    const SizeDistribution sizes(distribution(SizeKind::uniform, 0.0));
    const double a = 31e-6, b = 250e-6;
    CHECK(sizes.mean() == doctest::Approx(0.5 * (a + b)).epsilon(1e-6));
    CHECK(sizes.mean_square() == doctest::Approx((a * a + a * b + b * b) / 3.0).epsilon(1e-6));
    CHECK(sizes.quantile(0.25) == doctest::Approx(a + 0.25 * (b - a)).epsilon(1e-6));
}

TEST_CASE("SizeDistribution: a power law has its exponent") {
    SizeSpec spec = distribution(SizeKind::power_law, 0.0);
    spec.mean.reset();
    spec.exponent = 3.0;
    const SizeDistribution sizes(spec);
    // Share below d: (a^-2 - d^-2)/(a^-2 - b^-2).
    const double a = std::pow(31e-6, -2), b = std::pow(250e-6, -2);
    for (const double share : {0.1, 0.5, 0.9, 0.999})
        CHECK(sizes.quantile(share) == doctest::Approx(std::pow(a - share * (a - b), -0.5)).epsilon(1e-5));
}

TEST_CASE("SizeDistribution: a lognormal far from its limits has the median and deviation it should") {
    SizeSpec spec = distribution(SizeKind::lognormal, 1.0);
    spec.min = 1e-3;
    spec.max = 1e3;
    spec.deviation = 0.3;
    const SizeDistribution sizes(spec);
    const double median = std::exp(-0.5 * 0.09);
    CHECK(sizes.quantile(0.5) == doctest::Approx(median).epsilon(1e-4));
    CHECK(std::log(sizes.quantile(0.841344746) / median) == doctest::Approx(0.3).epsilon(1e-3));
}

TEST_CASE("SizeDistribution: Weibull sizes far from their limits have the share they should") {
    SizeSpec spec = distribution(SizeKind::weibull, 1.0);
    spec.min = 1e-4;
    spec.max = 1e2;
    spec.modulus = 2.0;
    const SizeDistribution sizes(spec);
    const double scale = 1.0 / std::tgamma(1.5);
    for (const double share : {0.2, 0.5, 0.9})
        CHECK(sizes.quantile(share) ==
              doctest::Approx(scale * std::sqrt(-std::log(1.0 - share))).epsilon(1e-3));
}

TEST_CASE("SizeDistribution: a list gives each size as often") {
    SizeSpec spec;
    spec.values = {3.0, 1.0, 2.0};
    portable::Random random(7);
    std::vector<double> drawn = SizeDistribution(spec).draw(6, random);
    std::sort(drawn.begin(), drawn.end());
    CHECK(drawn == std::vector<double>{1.0, 1.0, 2.0, 2.0, 3.0, 3.0});
}

TEST_CASE("SizeDistribution: a mean that the limits do not allow is refused") {
    // The larger the scale, the nearer to a density ~ d^(k-1), whose mean is below the upper limit.
    CHECK_THROWS_WITH_AS(SizeDistribution(distribution(SizeKind::weibull, 240e-6)),
                         doctest::Contains("the nearest is"), InputError);
}

TEST_CASE("portable: functions agree with the library's") {
    double worst[5] = {};
    for (int i = -400; i <= 400; ++i) {
        const double x = 0.0173 * i, up = std::exp(0.5 * x);
        const auto see = [&](int k, double got, double expected) {
            worst[k] = std::max(worst[k], std::abs(got - expected) / std::max(1.0, std::abs(expected)));
        };
        see(0, portable::exp(x), std::exp(x));
        see(1, portable::log(up), std::log(up));
        see(2, portable::direction(x).cos, std::cos(x));
        see(3, portable::direction(x).sin, std::sin(x));
        see(4, portable::angle_of(2.0 * std::cos(0.45 * x), 2.0 * std::sin(0.45 * x)),
            std::atan2(std::sin(0.45 * x), std::cos(0.45 * x)));
    }
    for (const double error : worst) CHECK(error < 5e-15);  // measured 8e-16, bound 5e-15
}

TEST_CASE("portable: bits of functions and random numbers are known") {
    // Machines with and without fused multiply-add must agree: this is the hash of both.
    portable::Random random(2026);
    std::uint64_t hash = 14695981039346656037ull;
    for (int i = 0; i < 1000; ++i) {
        const double u = random.uniform();
        for (const double value : {u, portable::exp(u), portable::log(1.0 + u), portable::direction(u).sin,
                                   portable::angle_of(u, 1.0 - u)})
            hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211ull;
    }
    CHECK(hash == 15527486702097994729ull);
}
