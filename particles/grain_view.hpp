// One grain as an internal-force model sees it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grid/vec.hpp"
#include "particles/von_mises.hpp"

namespace quern {

struct BondWork;

/// Which bonds of a grain are intact: one bit of a byte a bond. The other bits of the bytes belong to the
/// grains that share a batch with it (bond_batch.hpp). Made from bytes alone, it reads their lowest bit.
/// `place` [n_bonds]: byte of each bond, where the batch has more bonds than the grain (union_batch.hpp).
class BondBits {
  public:
    BondBits() = default;
    BondBits(std::span<const std::uint8_t> bytes, int bit = 0, const int* place = nullptr)
        : bytes_(bytes), place_(place), bit_(bit) {}
    BondBits(const std::vector<std::uint8_t>& bytes) : BondBits(std::span(bytes)) {}

    bool empty() const { return bytes_.empty(); }  ///< all intact
    bool operator[](int bond) const { return (bytes_[byte_of(bond)] >> bit_ & 1) != 0; }
    /// Clears the bond's bit in bytes that lie like its own.
    void clear_in(std::span<std::uint8_t> bytes, int bond) const {
        std::uint8_t& byte = bytes[byte_of(bond)];
        byte = static_cast<std::uint8_t>(byte & ~(1U << bit_));
    }
    std::span<const std::uint8_t> bytes() const { return bytes_; }
    /// The bits of the same grain in other bytes.
    BondBits in(std::span<const std::uint8_t> bytes) const { return {bytes, bit_, place_}; }

  private:
    std::size_t byte_of(int bond) const {
        return static_cast<std::size_t>(place_ == nullptr ? bond : place_[bond]);
    }

    std::span<const std::uint8_t> bytes_;
    const int* place_ = nullptr;
    int bit_ = 0;
};

/// Current state of one grain, read only. The grain is `scale` times its shape; n nodes, n_bonds bonds.
template <int Dim>
struct GrainView {
    double scale = 1.0;
    std::span<const Vec<Dim>> x;           ///< [n] current positions [m]
    std::span<const Vec<Dim>> v;           ///< [n] velocities [m/s]; read by damping only, else may be empty
    BondBits alive;                        ///< [n_bonds]; empty = all intact
    BondBits whole = {};                   ///< [n_bonds] what the cracks of the start have left; empty = all
    BondBits kept = {};                    ///< [n_bonds] bonds that never break; empty = none
    double strength = 1.0;                 ///< its critical stretch over that of its material
    std::span<const BondWork> works = {};  ///< [n_bonds] where bonds break by energy (bond_energy.hpp)
    std::span<const PlasticStrain<Dim>> plastic = {};  ///< [n]; read by plastic models only
};

}  // namespace quern
