// Directories and frames shared by the tests of this folder.
#pragma once

#include <stdlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "src/results/records.hpp"

namespace quern {

/// An empty directory that disappears with the object.
class ScratchDirectory {
  public:
    ScratchDirectory() {
        std::string pattern = (std::filesystem::temp_directory_path() / "quern_test_XXXXXX").string();
        path_ = mkdtemp(pattern.data());
    }
    ~ScratchDirectory() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    ScratchDirectory(const ScratchDirectory&) = delete;
    ScratchDirectory& operator=(const ScratchDirectory&) = delete;

    std::string path(const std::string& name = {}) const { return name.empty() ? path_ : path_ + "/" + name; }

  private:
    std::string path_;
};

inline std::string read_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Two square (cubic) grains of 10^dimension particles each, the second moving to the right; every number of
/// every array differs from its neighbours. In space they can break.
inline Frame make_sample_frame(int dimension, int number) {
    constexpr int n_side = 10;
    constexpr double dx = 0.01;
    Frame frame;
    frame.dimension = dimension;
    frame.step = 100 * number;
    frame.time = 0.1 * number;
    const int n_grain = dimension == 2 ? n_side * n_side : n_side * n_side * n_side;
    for (int p = 0; p < 2 * n_grain; ++p) {
        const int grain = p / n_grain, i = p % n_grain;
        const double at[3] = {dx * (i % n_side + 0.5) + (0.12 + 0.01 * number) * grain,
                              dx * (i / n_side % n_side + 0.5), dx * (i / (n_side * n_side) + 0.5)};
        for (int c = 0; c < dimension; ++c) {
            frame.position.push_back(at[c]);
            frame.velocity.push_back(static_cast<float>((c == 0 ? 1.0 : 0.1) * grain + 1e-3 * p));
        }
        frame.damage.push_back(static_cast<float>(p % 7) / 7.0F);
        if (dimension == 3) {
            frame.damage_z.push_back(static_cast<float>(p % 11) / 5.0F);
            frame.plastic_strain.push_back(static_cast<float>(p % 5) / 5.0F);
            frame.fragment.push_back(static_cast<std::int32_t>(p % 7));
        }
        for (int c = 0; c < (dimension == 2 ? 4 : 6); ++c)
            frame.stress.push_back(static_cast<float>(1e4 * (p - n_grain) + 10.0 * c + number));
        frame.grain.push_back(grain);
        frame.volume.push_back(dimension == 2 ? dx * dx : dx * dx * dx);
    }
    return frame;
}

}  // namespace quern
