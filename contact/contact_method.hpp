// The closed set of contact methods: visit once a step, then call directly.
#pragma once

#include <variant>

#include "contact/grid_contact.hpp"
#include "contact/node_pair_contact.hpp"

namespace quern {

template <int Dim>
using ContactMethod = std::variant<GridContact<Dim>, NodePairContact<Dim>>;

}  // namespace quern
