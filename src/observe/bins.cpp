#include "src/observe/bins.hpp"

#include <algorithm>
#include <cmath>

namespace quern {

void split(const Slices& slices, double x, double size, std::vector<SlicePart>& parts) {
    parts.clear();
    const double width = slices.width();
    const double low = (x - 0.5 * size - slices.from) / width, high = low + size / width;
    const double per_width = width / size;
    int first = static_cast<int>(std::floor(low)), last = static_cast<int>(std::floor(high));
    if (!slices.periodic) {
        first = std::max(first, 0);
        last = std::min(last, slices.n - 1);
    }
    for (int k = first; k <= last; ++k) {
        const double part = (std::min(high, k + 1.0) - std::max(low, static_cast<double>(k))) * per_width;
        if (part > 0.0) parts.push_back({((k % slices.n) + slices.n) % slices.n, part});
    }
}

}  // namespace quern
