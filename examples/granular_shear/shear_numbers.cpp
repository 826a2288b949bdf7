#include "examples/granular_shear/shear_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grid/error.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/frame_file.hpp"
#include "src/study/observed.hpp"
#include "src/study/run_files.hpp"

namespace quern::granular_shear {

namespace {

constexpr double begun = 0.1;  ///< shear from which means are taken

struct Moments {
    double n = 0, sum = 0, squares = 0;
    void add(double x) {
        if (std::isnan(x)) return;
        ++n, sum += x, squares += x * x;
    }
    double mean() const { return sum / n; }
    double deviation() const { return std::sqrt(std::max(0.0, squares / n - mean() * mean())) / mean(); }
};

/// What the moving edge receives: pushed outwards (x+) by the pressure, held back (y-) by the traction.
void read_edge(const std::string& directory, double width, double height, ShearNumbers& numbers) {
    const ObservedTable reactions(directory, "reactions");
    const std::vector<std::size_t> rows = reactions.rows_of("constraints[1]");
    Moments pressure, traction;
    for (const std::size_t row : rows) {
        const double shear = reactions.column("uy")[row] / width;
        numbers.shear.push_back(shear);
        numbers.pressure.push_back(reactions.column("fx")[row] / height);
        numbers.traction.push_back(-reactions.column("fy")[row] / height);
        if (shear < begun) continue;
        pressure.add(numbers.pressure.back());
        traction.add(numbers.traction.back());
    }
    numbers.pressure_mean = pressure.mean();
    numbers.pressure_deviation = pressure.deviation();
    numbers.traction_mean = traction.mean();
    numbers.traction_deviation = traction.deviation();
}

/// Displacements of columns at the frames nearest to 25, 50 and 75 % of shear, and the band at the last.
void read_columns(const std::string& directory, double width, double speed, ShearNumbers& numbers) {
    const ObservedTable profiles(directory, "profiles");
    const std::vector<double> times = profiles.times();
    for (const double shear : {0.25, 0.5, 0.75}) {
        const double time = *std::min_element(times.begin(), times.end(), [&](double a, double b) {
            return std::abs(a * speed / width - shear) < std::abs(b * speed / width - shear);
        });
        numbers.shears_shown.push_back(time * speed / width);
        const std::vector<std::size_t> rows = profiles.rows(time, "columns");
        numbers.way.push_back(profiles.pick("uy", rows));
        numbers.column.clear();
        for (const std::size_t row : rows)
            numbers.column.push_back(0.5 * (profiles.column("from")[row] + profiles.column("to")[row]));
    }
    const std::vector<double>& u = numbers.way.back();
    const double edge = numbers.shears_shown.back() * width;
    const double column = numbers.column[1] - numbers.column[0];
    double sum = 0;
    for (std::size_t k = 0; k < u.size(); ++k)
        if (numbers.column[k] > 0 && numbers.column[k] < width && !std::isnan(u[k])) sum += u[k] * column;
    numbers.band = 2 * sum / edge / numbers.diameter;
    double inner = width;
    for (std::size_t k = u.size(); k-- > 0;) {
        if (numbers.column[k] > width) continue;
        if (u[k] < 0.1 * edge) break;
        inner = numbers.column[k];
    }
    numbers.band_tenth = (width - inner) / numbers.diameter;
}

/// Where the material has flowed. Frames have no grains that are held apart: all count.
void read_flow(const std::string& directory, double width, double speed, ShearNumbers& numbers) {
    const FrameFileReader frames(directory + "/results.h5");
    std::size_t k = 0;
    while (k + 1 < frames.n_frames() &&
           frames.read(k).time * speed / width < numbers.shears_shown.back() - 1e-9)
        ++k;
    const Frame frame = frames.read(k);
    double all = 0, flowed = 0, strain = 0, near = 0;
    for (std::size_t i = 0; i < frame.plastic_strain.size(); ++i) {
        const double alpha = static_cast<double>(frame.plastic_strain[i]);
        all += frame.volume[i];
        if (alpha > 0.1) flowed += frame.volume[i];
        strain += frame.volume[i] * alpha;
        if (frame.position[2 * i] > 2.0 / 3.0 * width) near += frame.volume[i] * alpha;
    }
    numbers.flowed = all > 0 ? flowed / all : 0;
    numbers.flowed_third = strain > 0 ? near / strain : 0;
}

/// Turns of the grains that are free: each frame against the one before, about the centres, the angle of the
/// rotation that is nearest to what the particles did.
void read_turns(const std::string& directory, const Deck& deck, ShearNumbers& numbers) {
    struct Sums {
        double volume = 0, x = 0, y = 0, x_before = 0, y_before = 0, cross = 0, dot = 0;
    };
    const FrameFileReader frames(directory + "/results.h5");
    std::vector<double> angle(deck.grains.size(), 0.0);
    Frame before = frames.read(0);
    for (std::size_t k = 1; k < frames.n_frames(); ++k) {
        Frame now = frames.read(k);
        std::vector<Sums> sums(angle.size());
        const auto grain = [&](std::size_t i) { return static_cast<std::size_t>(now.grain[i]); };
        for (std::size_t i = 0; i < now.n(); ++i) {
            Sums& s = sums[grain(i)];
            s.volume += now.volume[i];
            s.x += now.volume[i] * now.position[2 * i];
            s.y += now.volume[i] * now.position[2 * i + 1];
            s.x_before += now.volume[i] * before.position[2 * i];
            s.y_before += now.volume[i] * before.position[2 * i + 1];
        }
        for (std::size_t i = 0; i < now.n(); ++i) {
            Sums& s = sums[grain(i)];
            const double x = now.position[2 * i] - s.x / s.volume;
            const double y = now.position[2 * i + 1] - s.y / s.volume;
            const double x_before = before.position[2 * i] - s.x_before / s.volume;
            const double y_before = before.position[2 * i + 1] - s.y_before / s.volume;
            s.cross += now.volume[i] * (x_before * y - y_before * x);
            s.dot += now.volume[i] * (x_before * x + y_before * y);
        }
        for (std::size_t g = 0; g < angle.size(); ++g) angle[g] += std::atan2(sums[g].cross, sums[g].dot);
        before = std::move(now);
    }
    double squares = 0, n = 0, squares_large = 0, n_large = 0;
    for (std::size_t g = 0; g < angle.size(); ++g) {
        if (!deck.grains[g].group.empty()) continue;
        squares += angle[g] * angle[g], n += 1;
        if (2 * deck.grains[g].scale * deck.shapes[0].radius < numbers.diameter) continue;
        squares_large += angle[g] * angle[g], n_large += 1;
    }
    numbers.rotation = std::sqrt(squares / n);
    numbers.rotation_large = std::sqrt(squares_large / n_large);
}

void read_network(const std::string& directory, double width, double speed, ShearNumbers& numbers) {
    const ObservedTable regions(directory, "regions");
    Moments half, slope, error, coordination;
    for (const std::size_t row : regions.rows_of("sample")) {
        if (regions.column("time")[row] * speed / width < begun) continue;
        half.add(regions.column("half_load")[row]);
        slope.add(regions.column("tail_slope")[row]);
        error.add(regions.column("tail_error")[row]);
        coordination.add(regions.column("coordination_held")[row]);
    }
    numbers.half_load = half.mean();
    numbers.tail_slope = slope.mean();
    numbers.tail_error = error.mean();
    numbers.coordination = coordination.mean();
}

}  // namespace

ShearNumbers measure_shear(const std::string& directory) {
    const Deck deck = read_deck(directory + "/deck.resolved.yaml");
    const RunFiles files = read_run(directory);
    if (!files.summary.exists()) throw InputError(directory, "no summary.json", "a run that is done");
    ShearNumbers numbers;
    // The sample is as high as the period, and as wide: 1.2 mm.
    const double height = deck.grid.extent[1], width = height;
    for (const GrainDeck& grain : deck.grains) numbers.diameter += 2 * grain.scale * deck.shapes[0].radius;
    numbers.diameter /= static_cast<double>(deck.grains.size());
    const double speed = (*deck.constraints[1].velocity[1])(0, 0, 0, 0);
    read_edge(directory, width, height, numbers);
    read_columns(directory, width, speed, numbers);
    read_flow(directory, width, speed, numbers);
    read_turns(directory, deck, numbers);
    read_network(directory, width, speed, numbers);
    const RunSummary& summary = files.summary;
    numbers.work = summary.number("energy.external_work");
    numbers.plastic = summary.number("energy.plastic");
    numbers.friction = summary.number("energy.friction");
    numbers.contact = summary.number("energy.contact_loss");
    numbers.transfer = summary.number("energy.transfer_loss");
    numbers.stored = summary.number("energy.kinetic") + summary.number("energy.elastic") +
                     summary.number("energy.contact_elastic");
    numbers.residual = summary.number("energy.residual_relative");
    numbers.steps = summary.number("steps");
    numbers.wall_seconds = summary.number("wall_seconds");
    numbers.ns_per_particle_step = summary.number("ns_per_particle_step");
    return numbers;
}

}  // namespace quern::granular_shear
