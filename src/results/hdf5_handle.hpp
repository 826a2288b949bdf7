// HDF5 identifiers that close themselves, and HDF5 failures in words.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace quern {

/// Owns one HDF5 identifier.
class Hdf5Handle {
  public:
    using Close = herr_t (*)(hid_t);

    Hdf5Handle() = default;
    Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
    Hdf5Handle(Hdf5Handle&& other) noexcept
        : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
    Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Hdf5Handle() {
        if (id_ >= 0) close_(id_);
    }

    operator hid_t() const { return id_; }

    /// Closes now; false if HDF5 could not.
    bool close() { return id_ < 0 || close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }

  private:
    hid_t id_ = H5I_INVALID_HID;
    Close close_ = nullptr;
};

/// Keeps HDF5 from printing the error stack of this thread; the reason goes into our message instead.
void silence_hdf5();

/// Reason of the last HDF5 failure: the system's where HDF5 recorded an errno, else HDF5's innermost words.
std::string hdf5_reason();

}  // namespace quern
