#include "src/study/verdicts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/deck/names.hpp"
#include "src/study/table.hpp"

namespace quern {

namespace {

std::string with_value(const Contender& one) {
    return fmt::format("`{}` ({})", one.name, readable(one.value));
}

std::string list(const std::vector<Contender>& some) {
    std::string text;
    for (std::size_t i = 0; i < some.size(); ++i)
        text += (i == 0 ? "" : i + 1 == some.size() ? " and " : ", ") + with_value(some[i]);
    return text;
}

}  // namespace

std::string how_much_less(double factor) {
    if (std::isinf(factor)) return "infinitely less";
    if (factor < 2.0) return fmt::format("{:.2g} % less", 100.0 * (1.0 - 1.0 / factor));
    return fmt::format("{} times less", factor < 9.95  ? fmt::format("{:.1f}", factor)
                                        : factor < 1e4 ? fmt::format("{:.0f}", factor)
                                                       : fmt::format("{:.0e}", factor));
}

Verdict judge(std::vector<Contender> contenders, double round_off) {
    std::erase_if(contenders, [](const Contender& one) { return !std::isfinite(one.value); });
    if (contenders.size() < 2) return {};
    for (Contender& one : contenders) one.value = std::abs(one.value);
    std::stable_sort(contenders.begin(), contenders.end(),
                     [](const Contender& a, const Contender& b) { return a.value < b.value; });
    const Contender& least = contenders.front();
    const auto first_worse =
        std::find_if(contenders.begin() + 1, contenders.end(), [&](const Contender& one) {
            return one.value > round_off && one.value > least.value * (1.0 + least.noise) * (1.0 + one.noise);
        });
    const std::vector<Contender> best(contenders.begin(), first_worse), worse(first_worse, contenders.end());
    Verdict verdict;
    for (const Contender& one : best) verdict.best.push_back(one.name);
    const bool small = round_off > 0.0 && best.back().value <= round_off;
    const std::string reason =
        small ? fmt::format("at most {}, the round-off", readable(round_off)) : "within the noise";
    if (worse.empty()) {
        verdict.factor = std::numeric_limits<double>::quiet_NaN();
        verdict.text = fmt::format("a tie, {}: {}", reason, list(best));
        return verdict;
    }
    verdict.factor = worse.front().value / best.back().value;
    verdict.text = best.size() == 1 ? with_value(best.front())
                                    : fmt::format("{} are equally good ({})", list(best), reason);
    for (std::size_t i = 0; i < worse.size(); ++i)
        verdict.text += fmt::format(", {} than {}", how_much_less(worse[i].value / best.back().value),
                                    with_value(worse[i]));
    return verdict;
}

}  // namespace quern
