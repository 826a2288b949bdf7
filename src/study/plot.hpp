// `quern plot`: all plots of a run by one command, from the files that it left behind.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace quern {

struct PlotOptions {
    std::string directory;                ///< of a run
    std::string output = {};              ///< folder of the pictures; empty: DIR/plots
    std::vector<std::string> names = {};  ///< of plots; empty: all that the run has data for
    std::vector<std::string> frames =
        {};                      ///< numbers from 0, or last; empty: four of them, the last one alone
    std::string region = "all";  ///< of the plots that show one
};

struct PlotReport {
    std::vector<std::string> files;
    std::vector<std::pair<std::string, std::string>> left_out;  ///< plot, what it lacks
};

/// Name and content of every plot, in their order.
std::vector<std::pair<std::string, std::string>> plot_names();

/// Draws OUTPUT/NAME.png. Throws InputError for an unknown name, frame or region, and for a plot by name that
/// the run lacks the data for.
PlotReport plot(const PlotOptions& options);

}  // namespace quern
