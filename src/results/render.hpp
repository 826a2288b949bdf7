// Pictures of particles and charts of numbers, drawn off screen by VTK.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "src/results/particle_picture.hpp"

namespace quern {

struct RenderOptions {
    std::string directory;  ///< of a finished run
    std::string file;       ///< .png; with frame = "all": pattern, number goes before ".png"
    std::string field =
        "speed";  ///< speed, velocity_x.., damage, damage_z, plastic_strain, grain,
                  ///< fragment, von_mises, pressure, stress_xx.., principal_difference, displacement
    std::string frame = "last";                 ///< last, all, or a number from 0
    std::optional<double> low = {}, high = {};  ///< of the colours; none: by what the frames hold
    bool dark = false;                          ///< black where nothing is; fields from zero up glow
    int width = 1200, height = 900;
};

/// Draws frames of DIR/results.h5. Returns the files written. Throws InputError for an unknown field or
/// frame (naming the valid ones), OutputError if nothing can be drawn.
std::vector<std::string> render(const RenderOptions& options);

/// Draws one frame of DIR/results.h5 in grey with lines over it. Throws as render.
void draw_network(const std::string& directory, std::size_t frame, const std::vector<PictureLink>& links,
                  const std::string& file);

/// A line of a chart.
struct ChartLine {
    std::string label;
    std::vector<double> x, y;
    int color = 0;  ///< index into the colour cycle
    bool dashed = false;
    bool markers = false;
    bool line = true;
    bool bar = false;  ///< a part of the bars at its x, upon the parts of the lines before; no log_y
};

struct Chart {
    std::string title, x_label, y_label;
    std::vector<ChartLine> lines;
    bool log_x = false, log_y = false;
    bool legend = true;
    std::vector<std::string> categories = {};  ///< names of x = 0, 1, ... instead of numbers; no log_x
};

/// Draws charts in a grid of `columns`, each about 560 x 420 pixels, into one PNG.
void draw_charts(const std::vector<Chart>& charts, int columns, const std::string& file);

}  // namespace quern
