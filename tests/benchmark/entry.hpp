// What a measurement is, how it is printed and stored, and what the machine could have done at best.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace quern::bench {

/// One measured thing. `ns` is the time of one unit; bytes and flops are those of one unit, too.
struct Entry {
    std::string kind;  ///< "kernel", "stage", "problem" or "method"
    std::string name;
    int threads = 1;
    std::string unit;        ///< "bond", "particle", "slot", ...
    double count = 0;        ///< units in one call
    double bytes = 0;        ///< every array that is read or written, once a call; 0: not counted
    double flops = 0;        ///< of the formula, a root and a division one each; 0: not counted
    std::vector<double> ns;  ///< one a repetition
    double memory = 0;       ///< peak of the process over that before set-up [bytes a particle]; 0: unknown
    std::vector<std::pair<std::string, double>> sizes;  ///< grains, particles, bonds, ...

    double median() const;
    double spread() const;                       ///< distance of the quartiles over the median
    double size(const std::string& name) const;  ///< of `sizes`; 0 if it is not there
};

/// Measured by the same program, before everything else.
struct Roofline {
    int threads = 1;
    double triad = 0;        ///< a = b + s c, arrays of 64 MiB [GB/s]
    double triad_cache = 0;  ///< the same, arrays of 256 KiB [GB/s]
    double fma = 0;          ///< double precision [GFlop/s]
};

/// Shortest time that memory and arithmetic allow over the measured one; 0 if neither bytes nor flops are
/// known.
double roofline_fraction(const Entry& entry, const std::vector<Roofline>& rooflines);

struct Report {
    std::vector<std::pair<std::string, std::string>> machine;
    std::vector<Roofline> rooflines;
    std::vector<Entry> entries;
};

std::string table_head();
std::string table_row(const Entry& entry, const std::vector<Roofline>& rooflines);
std::string report_json(const Report& report);

}  // namespace quern::bench
