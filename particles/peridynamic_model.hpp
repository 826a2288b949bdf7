// The closed set of internal-force models of peridynamic grains: visit once a group, then call directly.
#pragma once

#include <variant>

#include "particles/bond_based.hpp"
#include "particles/correspondence.hpp"
#include "particles/lps.hpp"

namespace quern {

template <int Dim>
using PeridynamicModel = std::variant<Lps<Dim>, BondBased<Dim>, Correspondence<Dim>>;

/// The model that material.model names (peridem: Lps with the options of the material), for one shape. Throws
/// InputError as its constructor does.
template <int Dim>
PeridynamicModel<Dim> make_model(const Shape<Dim>& shape, const Material& material,
                                 const KernelChoice& kernel = {}) {
    if (material.model == ForceModel::bond_based) return BondBased<Dim>(shape, material, kernel);
    if (material.model == ForceModel::correspondence) return Correspondence<Dim>(shape, material, kernel);
    return Lps<Dim>(shape, material, kernel);
}

}  // namespace quern
