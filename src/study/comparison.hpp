// All that `quern compare` has measured: what its tables, charts and sentences are made of.
#pragma once

#include <string>
#include <vector>

#include "src/deck/deck.hpp"
#include "src/study/measure.hpp"
#include "src/study/study_run.hpp"
#include "src/study/variants.hpp"
#include "src/study/verdicts.hpp"

namespace quern {

/// One variant at one level, and its repeats.
struct ComparedRun {
    std::size_t variant = 0, level = 0;
    Deck deck;
    std::vector<StudyRun> repeats;
    RunEnd end;             ///< of the first repeat that is not done, or "done"
    bool same_bits = true;  ///< all repeats ended in the same state
    RunFiles files;         ///< of the first repeat
    RunCost cost;
    std::vector<Quantity> quantities;  ///< empty unless done

    bool done() const { return end.outcome == "done"; }
    const Quantity* find(const std::string& key) const;
    double value(const std::string& key) const;  ///< NaN if it has none
};

struct Comparison {
    StudyBase base;
    std::vector<std::string> settings;
    std::vector<Variant> variants;
    std::vector<DroppedVariant> dropped;
    std::string over;                 ///< key that is varied; "" for none
    std::string over_name;            ///< its short name
    std::vector<std::string> levels;  ///< its values; one empty text for none
    int n_repeats = 1;
    std::string reference;  ///< as given, or the first variant
    bool reference_is_file = false;
    bool reference_is_truth = false;  ///< the user has named it: what is closer to it is better
    Trajectories trajectories;        ///< of the reference
    std::vector<ComparedRun> runs;    ///< level by level, variants in their order

    const ComparedRun& run(std::size_t level, std::size_t variant) const {
        return runs[level * variants.size() + variant];
    }
    std::size_t last_level() const { return levels.size() - 1; }
    std::string level_name(std::size_t level) const;  ///< "cells=12"; "" without levels
    bool is_reference(const ComparedRun& run) const;
    double level_number(std::size_t level) const;  ///< the value, or its place where values are no numbers
};

/// A file as a reader elsewhere would name it: from here if it lies below, or its own name.
std::string readable_path(const std::string& file);

/// Kinds of all quantities at a level, in the order of the report.
std::vector<QuantityKind> kinds_at(const Comparison& comparison, std::size_t level);

/// Verdict on a quantity at a level.
Verdict judge_at(const Comparison& comparison, std::size_t level, const QuantityKind& kind);

/// Slope of log|y| over log x by least squares; NaN with fewer than two points that have logarithms.
double log_slope(const std::vector<double>& x, const std::vector<double>& y);

/// Draws all charts into the folder. Returns the names of the files.
std::vector<std::string> draw_comparison(const Comparison& comparison, const std::string& folder);

std::string comparison_markdown(const Comparison& comparison, const std::vector<std::string>& plots);
std::string comparison_json(const Comparison& comparison, const std::vector<std::string>& plots);

}  // namespace quern
