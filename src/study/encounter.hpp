// Whom a grain met, and how fast they parted.
#pragma once

#include <vector>

#include "src/deck/deck.hpp"
#include "src/study/contacts.hpp"
#include "src/study/run_files.hpp"

namespace quern {

/// Restitution of the first of these contacts that has one (see restitution() of one contact). J [N s] is the
/// impulse of the contact force on the grain, mu the friction of a wall. The other body is the tracked grain
/// that received the opposite impulse, |J + J'| < 0.05 |J|, or the wall with the largest n.J, n its normal,
/// if |t.J| <= (mu + 0.05) n.J. Normal of the contact: that of the wall; between two disks or balls (no
/// periodic axes) the line of centres, sum |f_i| dt_i c_i over the contact, exact also with friction and for
/// a contact that turns; else the direction of J. NaN where there is no such body (a grain that is not
/// tracked, or several at a time).
double first_restitution(const Deck& deck, const RunFiles& run, int grain,
                         const std::vector<ContactTime>& contacts);

}  // namespace quern
