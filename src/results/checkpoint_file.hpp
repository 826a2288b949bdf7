// Checkpoints on disk: arrays by name, whole or not at all.
//
// An HDF5 file, one dataset an array. The attribute `hash` is that of all names and bytes: what was cut off
// or altered is not read.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "grid/error.hpp"

namespace quern {

/// Arrays by name. The same calls save and load, in the same order, so that the two cannot drift apart.
class Checkpoint {
  public:
    enum class Type { real, integer, byte };
    struct Item {
        std::string name;
        Type type;
        std::vector<std::byte> bytes;
    };

    Checkpoint() = default;  ///< to be filled
    /// To be read; `place` is for messages.
    Checkpoint(std::vector<Item> items, std::string place)
        : items_(std::move(items)), place_(std::move(place)), loading_(true) {}

    bool loading() const { return loading_; }
    const std::vector<Item>& items() const { return items_; }

    /// Arrays of double, std::int64_t, std::uint8_t, or of structs of doubles alone. Loading throws
    /// InputError if the next array has another name or type, or, for a span, another size.
    template <class T>
    void vector(const std::string& name, std::vector<T>& values) {
        if (loading_) values.resize(size_of_next(name) / sizeof(T));
        array(name, std::span<T>(values));
    }
    template <class T>
    void array(const std::string& name, std::span<T> values) {
        pass(name, type_of<T>(), {reinterpret_cast<std::byte*>(values.data()), values.size_bytes()});
    }
    template <class T>
    void value(const std::string& name, T& value) {
        array(name, std::span<T>(&value, 1));
    }

  private:
    template <class T>
    static constexpr Type type_of() {
        if constexpr (std::is_same_v<T, std::uint8_t>)
            return Type::byte;
        else if constexpr (std::is_same_v<T, std::int64_t>)
            return Type::integer;
        else {
            static_assert(sizeof(T) % sizeof(double) == 0 && !std::is_integral_v<T>);
            return Type::real;
        }
    }
    std::size_t size_of_next(const std::string& name) const;  ///< [bytes]
    void pass(const std::string& name, Type type, std::span<std::byte> bytes);

    std::vector<Item> items_;
    std::string place_;
    bool loading_ = false;
    std::size_t next_ = 0;
};

/// Writes DIR/checkpoint.h5 under a temporary name, then renames it; what had the name before becomes
/// DIR/checkpoint.previous.h5. Throws OutputError.
void write_checkpoint(const std::string& directory, const Checkpoint& checkpoint);

/// DIR/checkpoint.h5, or if that is missing, cut off or altered the one before; `refused` then says why, else
/// it is empty. Throws InputError if neither can be used.
Checkpoint read_checkpoint(const std::string& directory, std::string& refused);

}  // namespace quern
