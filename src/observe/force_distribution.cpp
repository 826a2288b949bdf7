#include "src/observe/force_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace quern {

ForceDistribution force_distribution(const std::vector<double>& forces, double width) {
    ForceDistribution found;
    found.width = width;
    if (forces.empty()) return found;
    const double n = static_cast<double>(forces.size());
    found.mean = std::accumulate(forces.begin(), forces.end(), 0.0) / n;
    double above = 0.0;
    for (const double force : forces) {
        const double f = force / found.mean;
        const std::size_t bin = static_cast<std::size_t>(f / width);
        if (bin >= found.counts.size()) found.counts.resize(bin + 1, 0);
        ++found.counts[bin];
        if (!(f > 1.0)) continue;
        above += f - 1.0;
        ++found.n_tail;
    }
    for (const int count : found.counts) found.density.push_back(count / (n * width));
    if (!(above > 0.0)) return found;
    found.slope = found.n_tail / above;
    found.slope_error = found.slope / std::sqrt(found.n_tail);
    return found;
}

}  // namespace quern
