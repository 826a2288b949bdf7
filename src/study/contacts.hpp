// What the contact force on a grain and the motion of its centre say about its contacts.
#pragma once

#include <cstddef>
#include <vector>

namespace quern {

/// A time in contact: the rows [begin, end) of a table carry force.
struct ContactTime {
    std::size_t begin = 0, end = 0;
    bool starts_inside = false, ends_inside = false;  ///< there is a row without force before it, after it
    double duration = 0;                              ///< [s]
};

/// Force of all contacts of a grain over a run. f_i [N; 2D: N/m] is the size of the mean force over the time
/// from row i-1 to row i, F = max f_i.
///
///     in contact: f_i > 0.001 F. Two times in contact are one where the gap between them is shorter than
///     half of the longer of the two: a force that chatters is one contact, a bounce is two. duration = from
///     the middle of the row before the first to the middle of the last row   (ends are unknown by
///                half a row either way)
///     mean     = sum f_i dt_i / sum dt_i over the times in contact
///     chatter  = (|f_0| + sum |f_i - f_(i-1)| + |f_last|) / (2 F n),  n: times in contact
///                1 for a force that only rises and then only falls, in each contact
struct ForceMeasures {
    double peak = 0, mean = 0, chatter = 0;
    double in_contact = 0;  ///< sum of the durations [s]
    std::vector<ContactTime> contacts;
};

/// `time` rises; both of one length.
ForceMeasures measure_force(const std::vector<double>& time, const std::vector<double>& force);

/// Coefficient of restitution: minus the ratio of the relative normal velocities of two centres after a
/// contact and before it. `approach`: of the two bodies at each row, positive when they come closer. NaN
/// unless the contact begins and ends within the run, and the bodies approach before it.
double restitution(const ContactTime& contact, const std::vector<double>& approach);

}  // namespace quern
