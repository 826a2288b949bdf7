#include "src/results/hdf5_handle.hpp"

#include <cstdlib>
#include <system_error>

namespace quern {

namespace {

/// Called from the innermost entry outwards: keeps the first text, prefers one with an errno.
herr_t note_entry(unsigned, const H5E_error2_t* entry, void* data) {
    auto& reason = *static_cast<std::string*>(data);
    const std::string text = entry->desc ? entry->desc : "";
    if (const auto at = text.find("errno = "); at != std::string::npos) {
        reason = std::generic_category().message(std::atoi(text.c_str() + at + 8));
        return 1;
    }
    if (reason.empty()) reason = text;
    return 0;
}

}  // namespace

void silence_hdf5() {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string hdf5_reason() {
    std::string reason;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, note_entry, &reason);
    return reason.empty() ? "HDF5 gives no reason" : reason;
}

}  // namespace quern
