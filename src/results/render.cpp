#include "src/results/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "grid/error.hpp"
#include "src/results/frame_file.hpp"
#include "src/results/particle_picture.hpp"
#include "src/results/program.hpp"

namespace quern {

namespace {

constexpr const char* frames_per_second = "20";

std::vector<std::size_t> choose_frames(const std::string& choice, std::size_t n_frames,
                                       const std::string& path) {
    if (n_frames == 0) throw InputError(path, "no frames", "at least one frame");
    if (choice == "last") return {n_frames - 1};
    std::vector<std::size_t> frames;
    if (choice == "all") {
        for (std::size_t i = 0; i < n_frames; ++i) frames.push_back(i);
        return frames;
    }
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
    if (error != std::errc() || end != choice.data() + choice.size() || number >= n_frames)
        throw InputError("frame", fmt::format("'{}'", choice),
                         fmt::format("last, all, or a number from 0 to {}", n_frames - 1),
                         fmt::format("{} holds {} frames", path, n_frames));
    return {number};
}

/// Largest value of the colours; that of `damage_z` is such that broken bonds are in the upper half.
double top_of_colors(const Field& field, double largest) {
    if (field.name == "damage_z") return 2.0;
    return largest > 0.0 && field.name != "damage" ? largest : 1.0;
}

/// Range of colours and region shown, grown frame by frame.
class Extent {
  public:
    explicit Extent(int dimension) : dimension_(static_cast<std::size_t>(dimension)), box_(2 * dimension_) {
        std::fill_n(box_.begin(), dimension_, std::numeric_limits<double>::max());
        std::fill_n(box_.begin() + dimension, dimension_, std::numeric_limits<double>::lowest());
    }

    void add(const Frame& frame, const std::vector<double>& values) {
        for (const double value : values)
            if (std::isfinite(value)) largest_ = std::max(largest_, std::abs(value));
        for (std::size_t k = 0; k < frame.position.size(); ++k) {
            const double x = frame.position[k],
                         radius = particle_radius(frame.volume[k / dimension_], frame.dimension);
            if (!std::isfinite(x)) continue;
            const std::size_t c = k % dimension_;
            box_[c] = std::min(box_[c], x - radius);
            box_[dimension_ + c] = std::max(box_[dimension_ + c], x + radius);
        }
    }

    double largest() const { return largest_; }

    /// The box with a margin around it; the domain's where there is one.
    std::vector<double> region(const std::vector<double>& domain) const {
        std::vector<double> region = domain.empty() ? box_ : domain;
        double size = 0.0;
        for (std::size_t c = 0; c < dimension_; ++c) {
            if (region[c] > region[dimension_ + c]) region[c] = region[dimension_ + c] = 0.0;
            size = std::max(size, region[dimension_ + c] - region[c]);
        }
        const double margin = size > 0.0 ? 0.03 * size : 1.0;
        for (std::size_t c = 0; c < dimension_; ++c) {
            region[c] -= margin;
            region[dimension_ + c] += margin;
        }
        return region;
    }

  private:
    std::size_t dimension_;
    std::vector<double> box_;
    double largest_ = 0.0;
};

std::string without_suffix(const std::string& file) {
    return file.substr(0, file.size() - 4);
}

/// Makes a movie of the numbered pictures; false where ffmpeg is missing or fails.
bool make_movie(const std::string& file, const std::string& movie) {
    const std::string program = find_program("ffmpeg");
    if (program.empty()) return false;
    std::string pattern;
    for (const char c : without_suffix(file)) pattern.append(c == '%' ? 2 : 1, c);
    return run_program({program, "-y", "-framerate", frames_per_second, "-i", pattern + "_%05d.png", "-vf",
                        "crop=trunc(iw/2)*2:trunc(ih/2)*2",  // the codec wants even sizes
                        "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
                        movie});
}

}  // namespace

std::vector<std::string> render(const RenderOptions& options) {
    if (!options.file.ends_with(".png"))
        throw InputError("file", fmt::format("'{}'", options.file), "a name that ends in .png");
    if (std::min(options.width, options.height) < 200 || std::max(options.width, options.height) > 8000)
        throw InputError("size", fmt::format("{} x {}", options.width, options.height),
                         "200 to 8000 pixels a side");
    const std::string path = (std::filesystem::path(options.directory) / "results.h5").string();
    const FrameFileReader run(path);
    const Field field = find_field(options.field, run.dimension());
    const std::vector<std::size_t> frames = choose_frames(options.frame, run.n_frames(), path);

    const Frame first = run.read(0);
    Extent extent(run.dimension());
    for (const std::size_t i : frames) {
        const Frame frame = run.read(i);
        extent.add(frame, make_field_values(field, frame, first));
    }
    PictureOptions picture{.width = options.width,
                           .height = options.height,
                           .title = run.title(),
                           .field = field,
                           .region = extent.region(run.domain()),
                           .domain = run.domain(),
                           .periods = run.periods(),
                           .dimension = run.dimension()};
    if (options.dark && field.scale == ColorScale::sequential) picture.field.scale = ColorScale::glowing;
    picture.dark = options.dark;
    picture.high = options.high.value_or(top_of_colors(field, extent.largest()));
    picture.low = options.low.value_or(field.scale == ColorScale::diverging ? -picture.high : 0.0);
    if (!(picture.low < picture.high))
        throw InputError("range", fmt::format("{} to {}", picture.low, picture.high),
                         "an upper end above the lower one");

    std::vector<std::string> files;
    {
        ParticlePicture camera(picture);
        for (const std::size_t i : frames) {
            const Frame frame = run.read(i);
            files.push_back(options.frame == "all"
                                ? fmt::format("{}_{:05}.png", without_suffix(options.file), i)
                                : options.file);
            camera.write_png(frame, make_field_values(field, frame, first), files.back());
        }
    }
    const std::string movie = without_suffix(options.file) + ".mp4";
    if (options.frame == "all" && make_movie(options.file, movie)) files.push_back(movie);
    return files;
}

void draw_network(const std::string& directory, std::size_t frame, const std::vector<PictureLink>& links,
                  const std::string& file) {
    const std::string path = (std::filesystem::path(directory) / "results.h5").string();
    const FrameFileReader run(path);
    if (frame >= run.n_frames())
        throw InputError("frame", fmt::format("{}", frame), fmt::format("less than {}", run.n_frames()),
                         fmt::format("{} holds {} frames", path, run.n_frames()));
    const Frame shown = run.read(frame);
    Extent extent(run.dimension());
    extent.add(shown, {});
    ParticlePicture camera({.title = run.title(),
                            .field = {"grain", "", "", ColorScale::uniform},
                            .region = extent.region(run.domain()),
                            .domain = run.domain(),
                            .periods = run.periods(),
                            .dimension = run.dimension(),
                            .links = links});
    camera.write_png(shown, std::vector<double>(shown.n(), 0.0), file);
}

}  // namespace quern
