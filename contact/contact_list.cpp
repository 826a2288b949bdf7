#include "contact/contact_list.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace quern {

namespace {

/// The lower grain first; a wall is always second.
template <int Dim>
void order(ContactPoint<Dim>& point) {
    if (point.second < 0 || point.first <= point.second) return;
    std::swap(point.first, point.second);
    std::swap(point.at_first, point.at_second);
    point.normal = -point.normal;
    point.impulse = -point.impulse;
}

/// Which image of the second grain it is.
template <int Dim>
IntVec<Dim> image(const ContactPoint<Dim>& point, const Vec<Dim>& box) {
    IntVec<Dim> periods;
    for (int a = 0; a < Dim; ++a)
        periods[a] = static_cast<int>(std::lround((point.at_second[a] - point.at_first[a]) / box[a]));
    return periods;
}

/// Grains by number, then walls by number.
std::tuple<int, bool, int> key(int first, int second) {
    return {first, second < 0, second < 0 ? -1 - second : second};
}

}  // namespace

template <int Dim>
std::vector<PairForce<Dim>> pair_forces(std::vector<ContactPoint<Dim>> points, double dt,
                                        const Vec<Dim>& box) {
    for (ContactPoint<Dim>& point : points) order(point);
    const auto before = [&](const ContactPoint<Dim>& a, const ContactPoint<Dim>& b) {
        const auto key_a = key(a.first, a.second), key_b = key(b.first, b.second);
        if (key_a != key_b) return key_a < key_b;
        const IntVec<Dim> at = image(a, box), bt = image(b, box);
        return std::lexicographical_compare(at.data(), at.data() + Dim, bt.data(), bt.data() + Dim);
    };
    std::stable_sort(points.begin(), points.end(), before);
    std::vector<PairForce<Dim>> pairs;
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
        while (end < points.size() && !before(points[begin], points[end])) ++end;
        PairForce<Dim> pair;
        pair.first = points[begin].first;
        pair.second = points[begin].second;
        Vec<Dim> impulse = Vec<Dim>::Zero();
        double weight = 0.0;
        for (std::size_t k = begin; k < end; ++k) {
            const ContactPoint<Dim>& point = points[k];
            const double along = point.impulse.dot(point.normal);
            impulse += point.impulse;
            pair.normal += along * point.normal;
            pair.at_first += along * point.at_first;
            pair.at_second += along * point.at_second;
            if (point.slips) pair.slipping += along;
            weight += along;
            ++pair.n_points;
        }
        if (!(weight > 0.0) || pair.normal.isZero(0.0)) continue;
        pair.normal.normalize();
        pair.at_first /= weight;
        pair.at_second /= weight;
        pair.slipping /= weight;
        const Vec<Dim> force = impulse / dt;
        pair.normal_force = force.dot(pair.normal);
        pair.tangential_force = force - pair.normal_force * pair.normal;
        pairs.push_back(pair);
    }
    return pairs;
}

template std::vector<PairForce<2>> pair_forces<2>(std::vector<ContactPoint<2>>, double, const Vec<2>&);
template std::vector<PairForce<3>> pair_forces<3>(std::vector<ContactPoint<3>>, double, const Vec<3>&);

}  // namespace quern
