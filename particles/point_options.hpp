// How grains of material points see the grid.
#pragma once

namespace quern {

enum class PointFunctions { linear, gimp, quadratic };

struct PointOptions {
    PointFunctions functions = PointFunctions::gimp;
    int order = 2;  ///< terms of q, see PointField
};

}  // namespace quern
