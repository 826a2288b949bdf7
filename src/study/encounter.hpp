// Whom a grain met, and how fast they parted.
#pragma once

#include <vector>

#include "src/deck/deck.hpp"
#include "src/study/contacts.hpp"
#include "src/study/run_files.hpp"

namespace quern {

/// Restitution of the first of these contacts that has one (see restitution() of one contact). The other body
/// is the tracked grain that received the opposite impulse, |J + J'| < 0.05 |J|, or the wall whose normal n
/// encloses the smallest angle with J, |t.J| <= (mu + 0.05) n.J. The normal is that of the wall, the line of
/// centres of two disks or balls at the middle of the contact (no periodic axes), or else the direction of J.
/// NaN where there is no such body (a grain that is not tracked, or several at a time).
double first_restitution(const Deck& deck, const RunFiles& run, int grain,
                         const std::vector<ContactTime>& contacts);

}  // namespace quern
