// Which of several values is best, by how much, and whether that is more than noise: in plain sentences.
#pragma once

#include <string>
#include <vector>

#include "src/study/measure.hpp"

namespace quern {

/// A value of one variant.
struct Contender {
    std::string name;
    double value = 0.0;
    double noise = 0.0;  ///< relative
};

/// Two values a <= b are equally good if b <= a (1 + noise_a)(1 + noise_b), or if both are at most round-off.
struct Verdict {
    std::vector<std::string> best;  ///< one name, or all that are equally good; as many as contenders: a tie
    double factor = 0.0;            ///< next value over the largest of the best; infinite: over 0; NaN: a tie
    std::string text;               ///< "`a` (1.2), 3 times less than `b` (3.6)"
};

/// Of a quantity where less is better. Contenders without a number do not take part; none with fewer than
/// two.
Verdict judge(std::vector<Contender> contenders, double round_off);

/// "3.2 times", "12 %" above 1: "3.2 times less", "12 % less".
std::string how_much_less(double factor);

}  // namespace quern
