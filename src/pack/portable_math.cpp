#include "src/pack/portable_math.hpp"

#include <cmath>
#include <numbers>

namespace quern::portable {

using std::numbers::pi;

double exp(double x) {
    // ln 2 in two parts, the first with zeros at its end, so that k times it is exact.
    constexpr double high = 0x1.62e42fee00000p-1, low = 0x1.a39ef35793c76p-33;
    if (x < -745.0) return 0.0;
    if (x > 709.0) x = 709.0;
    const double k = std::floor(x / std::numbers::ln2 + 0.5), r = (x - k * high) - k * low;
    double sum = 1.0;
    for (int i = 18; i > 0; --i) sum = 1.0 + r * sum / i;
    return std::ldexp(sum, static_cast<int>(k));
}

double log(double x) {
    int exponent = 0;
    double mantissa = std::frexp(x, &exponent);
    if (mantissa < std::numbers::sqrt2 / 2.0) {
        mantissa *= 2.0;
        --exponent;
    }
    const double z = (mantissa - 1.0) / (mantissa + 1.0), zz = z * z;
    double sum = 0.0;
    for (int i = 25; i > 0; i -= 2) sum = 1.0 / i + zz * sum;
    return exponent * std::numbers::ln2 + 2.0 * z * sum;
}

Direction direction(double angle) {
    angle -= 2.0 * pi * std::floor(angle / (2.0 * pi) + 0.5);
    const double a = angle / 8.0, aa = a * a;
    Direction d{0.0, 0.0};
    for (int i = 16; i > 0; i -= 2) {
        d.cos = 1.0 - aa / (i * (i - 1)) * (i == 16 ? 1.0 : d.cos);
        d.sin = 1.0 - aa / (i * (i + 1)) * (i == 16 ? 1.0 : d.sin);
    }
    d.sin *= a;
    for (int turn = 0; turn < 3; ++turn) d = {d.cos * d.cos - d.sin * d.sin, 2.0 * d.cos * d.sin};
    const double length = std::sqrt(d.cos * d.cos + d.sin * d.sin);
    return {d.cos / length, d.sin / length};
}

double angle_of(double x, double y) {
    const double r = std::sqrt(x * x + y * y);
    if (r == 0.0) return 0.0;
    // Half the angle is that of (x + r, y); of the two forms of its tangent the one that does not cancel.
    double hx = x >= 0.0 ? x + r : std::abs(y), hy = x >= 0.0 ? y : (y < 0.0 ? x - r : r - x);
    double t = hy / (hx + std::sqrt(hx * hx + hy * hy));
    for (int half = 0; half < 2; ++half) t = t / (1.0 + std::sqrt(1.0 + t * t));
    double sum = 0.0;
    for (int i = 27; i > 0; i -= 2) sum = 1.0 / i - t * t * sum;
    return 16.0 * t * sum;
}

}  // namespace quern::portable
