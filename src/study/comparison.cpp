#include "src/study/comparison.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

namespace quern {

const Quantity* ComparedRun::find(const std::string& key) const {
    const auto at = std::find_if(quantities.begin(), quantities.end(),
                                 [&](const Quantity& quantity) { return quantity.kind.key == key; });
    return at == quantities.end() ? nullptr : &*at;
}

double ComparedRun::value(const std::string& key) const {
    const Quantity* quantity = find(key);
    return quantity ? quantity->value : std::numeric_limits<double>::quiet_NaN();
}

std::string Comparison::level_name(std::size_t level) const {
    return over.empty() ? std::string() : over_name + "=" + levels[level];
}

bool Comparison::is_reference(const ComparedRun& run) const {
    return !reference_is_file && variants[run.variant].name == reference && run.level == last_level();
}

double Comparison::level_number(std::size_t level) const {
    std::vector<double> numbers;
    for (const std::string& text : levels) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error == std::errc() && end == text.data() + text.size()) numbers.push_back(value);
    }
    return numbers.size() == levels.size() ? numbers[level] : static_cast<double>(level + 1);
}

std::string readable_path(const std::string& file) {
    std::error_code error;
    const std::filesystem::path from_here = std::filesystem::proximate(file, error);
    const bool below = !error && !from_here.empty() && *from_here.begin() != "..";
    return below ? from_here.string() : std::filesystem::path(file).filename().string();
}

std::vector<QuantityKind> kinds_at(const Comparison& comparison, std::size_t level) {
    std::vector<QuantityKind> kinds;
    // Of all variants: one that has failed has none, the reference has no differences to itself.
    for (std::size_t v = 0; v < comparison.variants.size(); ++v) {
        auto place = kinds.begin();
        for (const Quantity& quantity : comparison.run(level, v).quantities) {
            const auto known = std::find_if(kinds.begin(), kinds.end(), [&](const QuantityKind& kind) {
                return kind.key == quantity.kind.key;
            });
            place = known == kinds.end() ? kinds.insert(place, quantity.kind) + 1 : known + 1;
        }
    }
    return kinds;
}

Verdict judge_at(const Comparison& comparison, std::size_t level, const QuantityKind& kind) {
    if (!kind.less_is_better) return {};
    std::vector<Contender> contenders;
    for (std::size_t v = 0; v < comparison.variants.size(); ++v)
        if (const Quantity* quantity = comparison.run(level, v).find(kind.key))
            contenders.push_back({comparison.variants[v].name, quantity->value, quantity->kind.noise});
    return judge(std::move(contenders), kind.round_off);
}

double log_slope(const std::vector<double>& x, const std::vector<double>& y) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!(x[i] > 0.0) || !std::isfinite(y[i]) || y[i] == 0.0) continue;
        const double u = std::log(x[i]), v = std::log(std::abs(y[i]));
        ++n, sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    const double spread = n * sxx - sx * sx;
    if (n < 2 || !(spread > 1e-12 * n * sxx)) return std::numeric_limits<double>::quiet_NaN();
    return (n * sxy - sx * sy) / spread;
}

}  // namespace quern
