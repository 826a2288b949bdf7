// Energy that bonds set free where a lattice is pulled apart along a plane, over its fracture energy.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string folder = EXAMPLE_DIR;
constexpr double fracture_energy = 0.002;  ///< of the decks [J/m^2]

/// A plane through the square lattice by its direction.
struct Plane {
    int a, b;
    double period() const { return std::hypot(a, b); }
    double degrees() const { return std::atan2(b, a) * 180.0 / std::numbers::pi; }
};

/// What is set in the deck besides the plane.
struct Material {
    std::string label;
    std::vector<std::string> overrides;
    double bound;  ///< of |G/Gc - 1|; 0: shown only
};

class Report {
  public:
    explicit Report(const ReportOptions& options) : options_(options) {
        fmt::print("{:52} {:>10} {:>10}\n", "case", "angle", "G/Gc");
    }

    /// Energy set free [J/m; 3D: J].
    double released(const std::string& deck, const std::vector<std::string>& overrides) {
        std::vector<std::string> all;
        for (const std::string& item : overrides) all.push_back("params." + item);
        const RunRecord run = run_case(folder + "/" + deck, all, options_.directory + "/run");
        residual_ = std::max(residual_, run.summary.residual_relative);
        return run.summary.energy.fracture;
    }

    /// G/Gc: two windows whose difference is whole periods of the lattice along the plane.
    double plane(const Plane& plane, const Material& material) {
        const double first = plane.period() * std::ceil(8.0 / plane.period());
        const double more = plane.period() * std::ceil(8.0 / plane.period());
        std::vector<std::string> overrides = material.overrides;
        overrides.push_back(fmt::format("a={}", plane.a));
        overrides.push_back(fmt::format("b={}", plane.b));
        overrides.push_back("");
        double energy[2];
        for (int k = 0; k < 2; ++k) {
            overrides.back() = fmt::format("window={}", first + k * more);
            energy[k] = released("plane.yaml", overrides);
        }
        const double ratio = (energy[1] - energy[0]) / more / fracture_energy;
        const std::string name = fmt::format("square, plane ({} {}), {}", plane.a, plane.b, material.label);
        fmt::print("{:52} {:10.2f} {:10.4f}\n", name, plane.degrees(), ratio);
        table_.add(name, {plane.degrees(), ratio});
        if (material.bound > 0.0)
            checks_.at_most_later(name + ": |G/Gc - 1|", std::abs(ratio - 1.0), material.bound);
        return ratio;
    }

    /// The same in space: four windows, of which the edges cancel.
    void space(const std::array<int, 3>& p, const std::array<int, 3>& q, const Material& material) {
        const auto norm = [](const std::array<int, 3>& v) { return std::hypot(v[0], v[1], v[2]); };
        std::vector<std::string> overrides = material.overrides;
        for (const auto& [letter, v] : {std::pair{'p', p}, std::pair{'q', q}})
            for (int k = 0; k < 3; ++k) overrides.push_back(fmt::format("{}_{}={}", letter, "xyz"[k], v[k]));
        const double first_p = norm(p) * std::ceil(2.4 / norm(p)),
                     first_q = norm(q) * std::ceil(2.4 / norm(q));
        double sum = 0.0;
        for (int k = 0; k < 4; ++k) {
            std::vector<std::string> all = overrides;
            all.push_back(fmt::format("p={}", first_p * (1 + k % 2)));
            all.push_back(fmt::format("q={}", first_q * (1 + k / 2)));
            sum += (k == 1 || k == 2 ? -1.0 : 1.0) * released("space.yaml", all);
        }
        const double ratio = sum / (first_p * first_q) / fracture_energy;
        const std::string name = fmt::format("cubic, plane of ({} {} {}) and ({} {} {}), {}", p[0], p[1],
                                             p[2], q[0], q[1], q[2], material.label);
        fmt::print("{:52} {:>10} {:10.4f}\n", name, "", ratio);
        table_.add(name, {std::nan(""), ratio});
        checks_.at_most_later(name + ": |G/Gc - 1|", std::abs(ratio - 1.0), material.bound);
    }

    int verdict() {
        table_.write(options_.directory, "energy_release");
        fmt::print("\n");
        checks_.at_most_later("energy residual, largest of all", residual_, 1e-3);
        return checks_.verdict();
    }

  private:
    ReportOptions options_;
    ReportTable table_{{"degrees", "ratio"}};
    ReportChecks checks_;
    double residual_ = 0.0;
};

int body(const ReportOptions& options) {
    Report report(options);
    const std::vector<Plane> all = {{1, 0}, {4, 1}, {2, 1}, {3, 2}, {1, 1}};
    const std::vector<Plane> few = {{1, 0}, {2, 1}, {1, 1}};
    const std::vector<Plane>& planes = options.short_mode ? few : all;
    std::vector<Material> materials = {{"as in the deck", {}, 0.03}};
    if (!options.short_mode)
        materials = {{"as in the deck", {}, 0.03},
                     {"integrals (calibration none)", {"calibration=none"}, 0.0},
                     {"horizon 4 dx", {"m=4.015"}, 0.03},
                     {"influence 1/r", {"influence=inverse"}, 0.045},
                     {"bond-based", {"model=bond_based"}, 0.03},
                     {"nu 0.1", {"nu=0.1"}, 0.0},
                     {"nu 0.4", {"nu=0.4"}, 0.0},
                     {"nu 0.1, by energy", {"nu=0.1", "by=energy"}, 0.03},
                     {"nu 0.25, by energy", {"by=energy"}, 0.03},
                     {"nu 0.4, by energy", {"nu=0.4", "by=energy"}, 0.03}};
    Chart chart{
        "Energy set free over fracture energy", "angle of the plane to the lattice [deg]", "G/Gc", {}};
    for (const Material& material : materials) {
        ChartLine line{material.label, {}, {}, static_cast<int>(chart.lines.size())};
        line.markers = true;
        for (const Plane& plane : planes) {
            line.x.push_back(plane.degrees());
            line.y.push_back(report.plane(plane, material));
        }
        chart.lines.push_back(line);
    }
    if (!options.short_mode) {
        report.space({1, 0, 0}, {0, 1, 0}, {"as in the deck", {}, 0.045});
        report.space({1, -1, 0}, {0, 0, 1}, {"as in the deck", {}, 0.03});
        report.space({1, 0, 0}, {0, 1, 0}, {"horizon 4 dx", {"m=4.015", "size=16"}, 0.03});
        for (const std::string nu : {"0.1", "0.4"}) {
            const std::vector<std::string> by_energy = {"nu=" + nu, "by=energy"};
            report.space({1, 0, 0}, {0, 1, 0}, {"nu " + nu + ", by energy", by_energy, 0.045});
            report.space({1, -1, 0}, {0, 0, 1}, {"nu " + nu + ", by energy", by_energy, 0.03});
        }
        draw_charts({chart}, 1, options.directory + "/release.png");
    }
    return report.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "energy_release", body);
}
