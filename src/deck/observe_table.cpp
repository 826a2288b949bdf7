// Keys of what is observed.
#include "src/deck/deck_input.hpp"

namespace quern {
namespace {

constexpr Range a_count{1, 100000, false, false, false};

Table<ObserveRegion> region_table() {
    using T = ObserveRegion;
    Table<T> t;
    t.vector("from", &T::from, "m", any_number, "Lower corner of a box; left out: that between the walls");
    t.vector("to", &T::to, "m", any_number, "Its upper corner");
    t.formula("where", &T::where, {"x", "y", "z", "t"}, "Of the box only where this is not 0");
    t.finish = [](T& region, const Cursor& at, const Context& now) {
        if (region.from.has_value() != region.to.has_value())
            throw InputError(at.where(), region.from ? "from without to" : "to without from",
                             "both corners of a box, or neither");
        for (std::size_t a = 0; region.from && a < static_cast<std::size_t>(now.dimension); ++a)
            if (!((*region.from)[a] < (*region.to)[a]))
                throw InputError(at.where("to"), vector_text(*region.to, now.dimension),
                                 "a corner above " + vector_text(*region.from, now.dimension));
    };
    return t;
}

Table<ObserveProfile> profile_table() {
    using T = ObserveProfile;
    Table<T> t;
    t.word("axis", &T::axis, {"x", "y", "z"}, "Across the slices");
    t.integer("bins", &T::bins, a_count, "Number of slices");
    t.number("from", &T::from, "m", any_number, "Where the first begins; left out: at the wall or edge");
    t.number("to", &T::to, "m", any_number, "Where the last ends; left out: at the wall or edge");
    t.finish = [](T& profile, const Cursor& at, const Context& now) {
        if (profile.axis == Axis::z && now.dimension == 2)
            throw InputError(at.where("axis"), "z", "one of x, y", "the deck is 2D");
        if (profile.from && profile.to && !(*profile.from < *profile.to))
            throw InputError(at.where("to"), number_text(*profile.to) + " m",
                             "more than from, " + number_text(*profile.from) + " m");
    };
    return t;
}

}  // namespace

Table<ObserveDeck> observe_table() {
    using T = ObserveDeck;
    Table<T> t;
    t.named("regions", &T::regions, region_table(), "Regions by name, beside all");
    t.named("profiles", &T::profiles, profile_table(), "Profiles along an axis by name");
    t.number("force_bin", &T::force_bin, "", positive,
             "Bins of the distribution of normal forces, over the mean force");
    t.finish = [](T& observe, const Cursor& at, const Context&) {
        observe.on = true;
        for (const ObserveRegion& region : observe.regions)
            if (region.name == "all")
                throw InputError(at.where("regions.all"), "a region of this name", "another name",
                                 "all is the whole box between the walls");
    };
    return t;
}

}  // namespace quern
