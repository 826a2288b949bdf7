#include "src/results/colors.hpp"

#include <vtkColorTransferFunction.h>
#include <vtkMath.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>

namespace quern {

namespace {

constexpr std::size_t table_size = 256;

/// viridis at eleven even stations; between them VTK interpolates in CIELAB.
constexpr double viridis[][3] = {{0.267, 0.005, 0.329}, {0.283, 0.141, 0.458}, {0.254, 0.265, 0.530},
                                 {0.207, 0.372, 0.553}, {0.164, 0.471, 0.558}, {0.128, 0.567, 0.551},
                                 {0.135, 0.659, 0.518}, {0.267, 0.749, 0.441}, {0.478, 0.821, 0.318},
                                 {0.741, 0.873, 0.150}, {0.993, 0.906, 0.144}};

/// After inferno (N. Smith and S. van der Walt, matplotlib), at five even stations.
constexpr double inferno[][3] = {{0.0, 0.0, 0.0},
                                 {0.342, 0.062, 0.429},
                                 {0.736, 0.216, 0.330},
                                 {0.978, 0.558, 0.035},
                                 {0.988, 0.998, 0.645}};

Rgb to_bytes(const double* rgb) {
    const auto byte = [](double c) {
        return static_cast<unsigned char>(std::lround(255.0 * std::clamp(c, 0.0, 1.0)));
    };
    return {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])};
}

std::vector<Rgb> make_table(ColorScale scale) {
    vtkNew<vtkColorTransferFunction> map;
    if (scale == ColorScale::diverging) {
        map->SetColorSpaceToDiverging();
        map->AddRGBPoint(0.0, 0.230, 0.299, 0.754);
        map->AddRGBPoint(1.0, 0.706, 0.016, 0.150);
    } else if (scale == ColorScale::glowing) {
        map->SetColorSpaceToLab();
        for (int i = 0; i <= 4; ++i) map->AddRGBPoint(0.25 * i, inferno[i][0], inferno[i][1], inferno[i][2]);
    } else {
        map->SetColorSpaceToLab();
        for (int i = 0; i <= 10; ++i) map->AddRGBPoint(0.1 * i, viridis[i][0], viridis[i][1], viridis[i][2]);
    }
    std::vector<Rgb> table(table_size);
    for (std::size_t i = 0; i < table_size; ++i) {
        double rgb[3];
        map->GetColor(static_cast<double>(i) / (table_size - 1), rgb);
        table[i] = to_bytes(rgb);
    }
    return table;
}

Rgb category_color(double number) {
    constexpr double golden_ratio = 0.6180339887498949;
    constexpr double brightness[] = {0.85, 0.62, 0.95}, saturation[] = {0.70, 0.75, 0.42};
    const double hue = number * golden_ratio - std::floor(number * golden_ratio);
    const auto shade = static_cast<std::size_t>(std::fmod(std::abs(number), 3.0));
    double rgb[3];
    vtkMath::HSVToRGB(hue, saturation[shade], brightness[shade], rgb, rgb + 1, rgb + 2);
    return to_bytes(rgb);
}

}  // namespace

ColorMap::ColorMap(ColorScale scale, double low, double high)
    : scale_(scale), low_(low), high_(high), table_(make_table(scale)) {}

Rgb ColorMap::color(double value) const {
    if (!std::isfinite(value)) return {128, 128, 128};
    if (scale_ == ColorScale::uniform) return {205, 205, 205};
    if (scale_ == ColorScale::categorical) return category_color(value);
    const double fraction = std::clamp((value - low_) / (high_ - low_), 0.0, 1.0);
    return table_[static_cast<std::size_t>(std::lround(fraction * (table_size - 1)))];
}

Rgb cycle_color(int index) {
    constexpr Rgb cycle[] = {{0, 114, 178}, {213, 94, 0},   {0, 158, 115},   {204, 121, 167},
                             {230, 159, 0}, {86, 180, 233}, {128, 128, 128}, {0, 0, 0}};
    return cycle[static_cast<std::size_t>(index) % std::size(cycle)];
}

}  // namespace quern
