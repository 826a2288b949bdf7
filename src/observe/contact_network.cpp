#include "src/observe/contact_network.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace quern {

template <int Dim>
Coordination coordination(std::span<const PairForce<Dim>> pairs, std::span<const std::uint8_t> wall) {
    const std::size_t n = wall.size();
    Coordination found{std::vector<int>(n, 0), std::vector<std::uint8_t>(n, 0), {}};
    const auto solid = [&](int grain) { return grain < 0 || wall[static_cast<std::size_t>(grain)]; };
    const auto gone = [&](int grain) {
        return !solid(grain) && found.rattler[static_cast<std::size_t>(grain)];
    };
    const auto count = [&](bool held, std::vector<int>& counts) {
        counts.assign(n, 0);
        for (const PairForce<Dim>& pair : pairs) {
            if (held && (gone(pair.first) || gone(pair.second))) continue;
            for (const int grain : {pair.first, pair.second})
                if (!solid(grain)) ++counts[static_cast<std::size_t>(grain)];
        }
    };
    count(false, found.pairs);
    found.pairs_held = found.pairs;
    for (bool more = true; more;) {
        more = false;
        for (std::size_t g = 0; g < n; ++g)
            if (!wall[g] && !found.rattler[g] && found.pairs_held[g] < 2) found.rattler[g] = more = true;
        if (more) count(true, found.pairs_held);
    }
    return found;
}

template <int Dim>
Mat<Dim> fabric(std::span<const PairForce<Dim>> pairs) {
    Mat<Dim> sum = Mat<Dim>::Zero();
    int n = 0;
    for (const PairForce<Dim>& pair : pairs) {
        if (pair.second < 0) continue;
        sum += pair.normal * pair.normal.transpose();
        ++n;
    }
    return n > 0 ? Mat<Dim>(sum / n) : sum;
}

double part_with_half_the_load(std::vector<double> loads) {
    for (double& load : loads) load = std::max(load, 0.0);
    std::sort(loads.begin(), loads.end(), std::greater<>());
    const double half = 0.5 * std::accumulate(loads.begin(), loads.end(), 0.0);
    if (!(half > 0.0)) return 0.0;
    double carried = 0.0, n = 0.0;
    for (const double load : loads) {
        if (carried + load >= half) return (n + (half - carried) / load) / static_cast<double>(loads.size());
        carried += load;
        ++n;
    }
    return 1.0;
}

template Coordination coordination<2>(std::span<const PairForce<2>>, std::span<const std::uint8_t>);
template Coordination coordination<3>(std::span<const PairForce<3>>, std::span<const std::uint8_t>);
template Mat<2> fabric<2>(std::span<const PairForce<2>>);
template Mat<3> fabric<3>(std::span<const PairForce<3>>);

}  // namespace quern
