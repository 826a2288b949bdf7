// Keys of cracks and of zones without failure.
#include "src/deck/deck_input.hpp"

namespace quern {
namespace {

/// A word that is no number.
bool is_group_name(const Cursor& at, const Context& now) {
    return at.node().kind == Node::Kind::scalar &&
           !now.parameters.resolve(at.node(), at.where(), Parameters::Wanted::number).number;
}

/// Which grains, and what places are measured in.
template <class T>
void add_target(Table<T>& t, const char* about) {
    const Key grains = grain_ids_key("grains", about);
    t.add(
        grains,
        [grains](T& target, const Cursor& at, const Context& now) {
            read_grain_ids(target.grains, target.groups, at, now, grains);
        },
        [](const T& target, int) { return target.grains.empty() ? "all" : ids_text(target.grains); });
    t.text("shape", &T::shape, "Of these only grains of this shape");
    t.word("frame", &T::frame, {"world", "shape"},
           "Places at t = 0, or places in the shape: from its centre of mass, at scale 1 and angle 0");
}

void finish_crack(CrackDeck& crack, const Cursor& at, const Context& now) {
    crack.place = at.place();
    Numbers3 along{}, normal{};
    for (std::size_t i = 0; i < 3; ++i) along[i] = crack.to[i] - crack.from[i];
    for (std::size_t i = 0; i < 3; ++i)
        normal[i] =
            along[(i + 1) % 3] * crack.edge[(i + 2) % 3] - along[(i + 2) % 3] * crack.edge[(i + 1) % 3];
    const double length = std::hypot(along[0], along[1], along[2]);
    const double width = std::hypot(crack.edge[0], crack.edge[1], crack.edge[2]);
    if (length == 0.0) throw InputError(at.where("to"), "the same point as from", "the other end");
    if (now.dimension == 2 || std::hypot(normal[0], normal[1], normal[2]) > 1e-9 * length * width) return;
    throw InputError(at.where("edge"), vector_text(crack.edge, 3) + ", along from - to",
                     "an edge that spans a plane with from - to");
}

}  // namespace

Table<CrackDeck> crack_table() {
    using T = CrackDeck;
    Table<T> t;
    add_target(t, "Grains it cuts");
    t.vector("from", &T::from, "m", any_number, "One end").require();
    t.vector("to", &T::to, "m", any_number, "The other end").require();
    t.vector("edge", &T::edge, "m", any_number, "Second edge of the parallelogram that begins with from - to")
        .require()
        .in_dimension(3);
    t.finish = finish_crack;
    return t;
}

Table<NoFailDeck> no_fail_table() {
    using T = NoFailDeck;
    Table<T> t;
    add_target(t, "Grains it protects");
    t.formula("region", &T::region, {"x", "y", "z"}, "Bonds with an end where this is not 0 never break")
        .require();
    t.finish = [](T& zone, const Cursor& at, const Context&) { zone.place = at.place(); };
    return t;
}

Key grain_ids_key(const char* name, const char* about) {
    return {.name = name, .form = Form::ids, .range = not_negative, .about = about};
}

void read_grain_ids(std::vector<int>& ids, std::vector<std::string>& groups, const Cursor& at,
                    const Context& now, const Key& key) {
    if (says(at, now, "all")) return;
    Key entry = key;
    if (at.node().kind == Node::Kind::scalar && is_group_name(at, now)) {
        groups.push_back(read_text(at, now, entry));
        return;
    }
    if (at.node().kind != Node::Kind::list || at.node().items.empty()) {
        const bool list = at.node().kind == Node::Kind::list;
        throw InputError(at.where(), list ? "an empty list" : at.node().description(), key.expectation(2));
    }
    entry.form = Form::integer;
    for (std::size_t i = 0; i < at.node().items.size(); ++i) {
        if (is_group_name(at.entry(i), now))
            groups.push_back(read_text(at.entry(i), now, entry));
        else
            ids.push_back(read_integer(at.entry(i), now, entry));
    }
}

}  // namespace quern
