// Contact of each pair of zones.
#include <fmt/format.h>

#include "grid/error.hpp"
#include "src/import/peridem_deck.hpp"

namespace quern {
namespace {

const SectionKeys pair_keys = {
    {"Contact_Radius_Factor", "Contact_Radius", "Damping_On", "Friction_On", "Kn", "V_Max", "Delta_Max",
     "Epsilon", "Friction_Coeff", "Kn_Factor", "Beta_n_Factor", "Copy_Contact_Data"},
    {}};

std::string pair_name(std::size_t i, std::size_t j) {
    return fmt::format("Zone_{}{}", i + 1, j + 1);
}

PeridemContact read_pair(const Section& pair, bool walls) {
    PeridemContact c;
    if (pair.has("Contact_Radius_Factor"))
        c.radius_factor = pair.number("Contact_Radius_Factor", positive);
    else
        c.radius = pair.number("Contact_Radius", positive);
    if (pair.has("Kn")) {
        c.stiffness = pair.number("Kn", walls ? not_negative : positive);
    } else {
        const double ratio = pair.number("V_Max", positive) / pair.number_or("Delta_Max", 1.0, positive);
        c.stiffness = ratio * ratio;
    }
    c.stiffness *= pair.number_or("Kn_Factor", 1.0, positive);
    c.damping_factor = pair.number_or("Beta_n_Factor", 1.0, not_negative);
    const bool damped = pair.flag_or("Damping_On", true);
    if (damped) c.restitution = pair.number("Epsilon", {0.0, 1.0, true, false, false});
    if (c.damping_factor == 0.0) c.restitution = c.damping_factor = 1.0;
    if (pair.flag_or("Friction_On", true)) c.friction = pair.number("Friction_Coeff", not_negative);
    return c;
}

}  // namespace

void read_peridem_contact(const Section& root, PeridemDeck& deck) {
    if (!root.has("Contact") && deck.zones.size() == 1) {
        root.notes().add_difference("there is no section Contact: one zone without contact");
        return;
    }
    const std::size_t n = deck.zones.size();
    SectionKeys keys;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i; j < n; ++j) keys.used.push_back(pair_name(i, j));
    const Section contact(root, "Contact", keys);
    deck.contact.assign(n, std::vector<PeridemContact>(n));
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i; j < n; ++j) {
            const Section pair(contact, pair_name(i, j), pair_keys);
            PeridemContact& c = deck.contact[i][j];
            if (pair.has("Copy_Contact_Data")) {
                const std::vector<int> from = pair.integers("Copy_Contact_Data");
                const auto row = [&](std::size_t k) { return static_cast<std::size_t>(from[k] - 1); };
                const bool earlier = from.size() == 2 && from[0] >= 1 && from[1] >= from[0] &&
                                     (row(0) < i || (row(0) == i && row(1) < j)) && row(1) < n;
                if (!earlier)
                    pair.refuse("Copy_Contact_Data", "two zones [i, j] with i <= j, read before this pair");
                c = deck.contact[row(0)][row(1)];
            } else {
                c = read_pair(pair, deck.zones[i].wall && deck.zones[j].wall);
            }
            deck.contact[j][i] = c;
        }
}

}  // namespace quern
