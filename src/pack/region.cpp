#include "src/pack/region.hpp"

#include <numbers>

namespace quern {

double Region::area() const {
    return circle ? std::numbers::pi * radius * radius : length(0) * length(1);
}

}  // namespace quern
