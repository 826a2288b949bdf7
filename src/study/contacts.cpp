#include "src/study/contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quern {

namespace {

constexpr double threshold = 1e-3;   ///< of the peak: contact forces are zero between contacts
constexpr double longest_gap = 0.5;  ///< within a contact, over the longer of its parts

double size_of(const ContactTime& contact, const std::vector<double>& time) {
    const std::size_t first = contact.begin, last = contact.end - 1;
    const double start = first == 0 ? time[0] : 0.5 * (time[first - 1] + time[first]);
    const double stop = last == 0 || !contact.ends_inside ? time[last] : 0.5 * (time[last - 1] + time[last]);
    return stop - start;
}

/// Runs of rows above the threshold, joined over short gaps.
std::vector<ContactTime> find_contacts(const std::vector<double>& time, const std::vector<double>& force,
                                       double least) {
    std::vector<ContactTime> contacts;
    for (std::size_t i = 0; i < force.size(); ++i) {
        if (!(force[i] > least)) continue;
        ContactTime next{i, i};
        while (next.end < force.size() && force[next.end] > least) ++next.end;
        i = next.end;
        next.starts_inside = next.begin > 0;
        next.ends_inside = next.end < force.size();
        next.duration = size_of(next, time);
        while (!contacts.empty()) {
            const ContactTime& before = contacts.back();
            const double gap = time[next.begin - 1] - time[before.end - 1];
            if (gap >= longest_gap * std::max(before.duration, next.duration)) break;
            next.begin = before.begin;
            next.starts_inside = before.starts_inside;
            next.duration = size_of(next, time);
            contacts.pop_back();
        }
        contacts.push_back(next);
    }
    return contacts;
}

}  // namespace

ForceMeasures measure_force(const std::vector<double>& time, const std::vector<double>& force) {
    ForceMeasures measures;
    for (const double f : force) measures.peak = std::max(measures.peak, f);
    if (measures.peak <= 0.0) return measures;
    measures.contacts = find_contacts(time, force, threshold * measures.peak);
    double impulse = 0.0, span = 0.0;
    for (const ContactTime& contact : measures.contacts) {
        measures.in_contact += contact.duration;
        for (std::size_t i = std::max<std::size_t>(1, contact.begin); i < contact.end; ++i) {
            impulse += force[i] * (time[i] - time[i - 1]);
            span += time[i] - time[i - 1];
        }
    }
    measures.mean = span > 0.0 ? impulse / span : std::numeric_limits<double>::quiet_NaN();
    double variation = std::abs(force.front()) + std::abs(force.back());
    for (std::size_t i = 1; i < force.size(); ++i) variation += std::abs(force[i] - force[i - 1]);
    measures.chatter = variation / (2.0 * measures.peak * static_cast<double>(measures.contacts.size()));
    return measures;
}

double restitution(const ContactTime& contact, const std::vector<double>& approach) {
    double fastest = 0.0;
    for (const double v : approach) fastest = std::max(fastest, std::abs(v));
    if (!contact.starts_inside || !contact.ends_inside) return std::numeric_limits<double>::quiet_NaN();
    const double before = approach[contact.begin - 1], after = approach[contact.end - 1];
    if (!(before > 1e-3 * fastest)) return std::numeric_limits<double>::quiet_NaN();
    return -after / before;
}

}  // namespace quern
