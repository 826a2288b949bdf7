#include "src/import/peridem_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "src/deck/names.hpp"

namespace quern {
namespace {

constexpr std::size_t most_in_deck = 20;  ///< bodies that stand in the deck itself, not in a table

/// K + 4 G/3 from any two moduli [Pa].
double longitudinal_modulus(const PeridemMaterial& m) {
    if (m.bulk && m.shear) return *m.bulk + 4.0 / 3.0 * *m.shear;
    if (m.bulk && m.young) return 3.0 * *m.bulk * (3.0 * *m.bulk + *m.young) / (9.0 * *m.bulk - *m.young);
    if (m.shear && m.young) return *m.shear * (4.0 * *m.shear - *m.young) / (3.0 * *m.shear - *m.young);
    const double nu = *m.poisson;
    if (m.bulk) return 3.0 * *m.bulk * (1.0 - nu) / (1.0 + nu);
    if (m.shear) return 2.0 * *m.shear * (1.0 - nu) / (1.0 - 2.0 * nu);
    return *m.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
}

/// A step that no run survives: waves cross three times the least distance of two nodes [s].
double hopeless_step(const PeridemDeck& deck, const PeridemBodies& bodies) {
    double fastest = 0.0;
    for (const PeridemZone& zone : deck.zones)
        fastest = std::max(fastest, std::sqrt(longitudinal_modulus(zone.material) / zone.material.density));
    return 3.0 * least_distance(bodies) / fastest;
}

/// Names of shapes by zone and size, and the files of their meshes.
class ShapeBook {
  public:
    ShapeBook(const PeridemDeck& deck, const PeridemBodies& bodies, ImportedHorizon horizon)
        : deck_(deck), horizon_(horizon) {
        for (const PeridemBody& body : bodies.bodies) add(body);
    }

    /// A body whose horizon does not stay as given scales the shape of its zone.
    bool scales(const PeridemBody& body) const {
        return body.in_table &&
               (horizon_ == ImportedHorizon::scaled || zone_of(body).material.horizon == 0.0);
    }
    const std::string& name(const PeridemBody& body) const { return names_.at(key(body)); }
    std::string section() const { return fmt::format("shapes:\n{}", text_); }
    const std::vector<ImportedFile>& files() const { return files_; }
    int n_shapes() const { return static_cast<int>(names_.size()); }

  private:
    using Key = std::pair<int, double>;

    const PeridemZone& zone_of(const PeridemBody& body) const {
        return deck_.zones[static_cast<std::size_t>(body.zone)];
    }
    Key key(const PeridemBody& body) const { return {body.zone, scales(body) ? 1.0 : body.scale}; }

    void add(const PeridemBody& body) {
        const Key which = key(body);
        if (names_.contains(which)) return;
        const PeridemZone& zone = zone_of(body);
        std::string name = fmt::format("zone_{}", body.zone + 1);
        if (which.second != 1.0) {
            name += fmt::format("_{:.6g}um", 1e6 * which.second * zone.radius);
            std::replace(name.begin(), name.end(), '.', '_');
            std::replace(name.begin(), name.end(), '+', '_');
            for (int k = 2; used_.contains(name); ++k) name += fmt::format("_{}", k);
        }
        used_.insert(name);
        names_[which] = name;
        const std::string unit =
            which.second == 1.0 ? "" : fmt::format(", unit: {}", number_text(which.second));
        text_ +=
            fmt::format("  {}: {{type: mesh, file: {}{}}}\n", name, quoted(mesh_file(zone, body.zone)), unit);
    }

    const std::string& mesh_file(const PeridemZone& zone, int number) {
        const auto known = file_of_.find(zone.mesh);
        if (known != file_of_.end()) return known->second;
        std::string name = std::filesystem::path(zone.mesh).filename().string();
        for (const ImportedFile& other : files_)
            if (other.name == name) name = fmt::format("zone_{}_{}", number + 1, name);
        files_.push_back({name, zone.mesh, ""});
        return file_of_[zone.mesh] = name;
    }

    const PeridemDeck& deck_;
    ImportedHorizon horizon_;
    std::map<Key, std::string> names_;
    std::set<std::string> used_;
    std::map<std::string, std::string> file_of_;
    std::vector<ImportedFile> files_;
    std::string text_;
};

/// Bodies one by one, or, where they are many, in tables.
class GrainWriter {
  public:
    GrainWriter(const PeridemDeck& deck, const PeridemBodies& bodies, const ShapeBook& shapes,
                const ImportedMaterials& materials)
        : deck_(deck), bodies_(bodies.bodies), shapes_(shapes), materials_(materials) {}

    std::string section(const std::string& stem, std::vector<ImportedFile>& files) const {
        std::string text = "grains:\n";
        int n_tables = 0;
        for (std::size_t first = 0; first < bodies_.size();) {
            std::size_t last = first;
            while (last < bodies_.size() && fits_table(bodies_[last]) && same_table(first, last)) ++last;
            if (last - first > most_in_deck) {
                const std::string number = n_tables > 0 ? fmt::format("_{}", n_tables + 1) : "";
                ++n_tables;
                const std::string name = fmt::format("{}_grains{}.csv", stem, number);
                files.push_back({name, "", table(first, last)});
                text += fmt::format("  - {{file: {}{}}} # {} to {}\n", quoted(name),
                                    wall(bodies_[first]) ? ", wall: true" : "", first, last - 1);
                first = last;
            } else {
                for (last = std::max(last, first + 1); first < last; ++first) text += entry(first);
            }
        }
        return text;
    }

  private:
    bool wall(const PeridemBody& body) const { return deck_.zones[static_cast<std::size_t>(body.zone)].wall; }
    bool fits_table(const PeridemBody& body) const { return body.in_table; }
    bool same_table(std::size_t a, std::size_t b) const { return wall(bodies_[a]) == wall(bodies_[b]); }
    static bool moves(const PeridemBody& body) { return body.velocity != Numbers3{}; }

    std::string entry(std::size_t id) const {
        const PeridemBody& body = bodies_[id];
        std::string text = fmt::format("  - {{shape: {}, material: {}, position: {}", shapes_.name(body),
                                       materials_.name[static_cast<std::size_t>(body.zone)],
                                       vector_text(body.centre, deck_.dimension));
        if (shapes_.scales(body) && body.scale != 1.0)
            text += fmt::format(", scale: {}", number_text(body.scale));
        if (body.angle != 0.0)
            text += deck_.dimension == 2 ? fmt::format(", angle: {}", number_text(body.angle))
                                         : fmt::format(", angle: [0, 0, {}]", number_text(body.angle));
        if (moves(body)) text += fmt::format(", velocity: {}", vector_text(body.velocity, deck_.dimension));
        if (wall(body)) text += ", wall: true";
        return fmt::format("{}}} # {}\n", text, id);
    }

    std::string table(std::size_t first, std::size_t last) const {
        bool moving = false, scaled = false;
        for (std::size_t id = first; id < last; ++id) {
            moving = moving || moves(bodies_[id]);
            scaled = scaled || shapes_.scales(bodies_[id]);
        }
        const bool flat = deck_.dimension == 2;
        std::string text =
            fmt::format("# Imported from PeriDEM: {}; centres of mass\nshape,material,{},{}{}{}\n",
                        std::filesystem::path(deck_.particles).filename().string(), flat ? "x,y" : "x,y,z",
                        flat ? "angle" : "angle_z", scaled ? ",scale" : "",
                        moving ? (flat ? ",vx,vy" : ",vx,vy,vz") : "");
        const std::size_t n = static_cast<std::size_t>(deck_.dimension);
        for (std::size_t id = first; id < last; ++id) {
            const PeridemBody& body = bodies_[id];
            text += fmt::format("{},{}", shapes_.name(body),
                                materials_.name[static_cast<std::size_t>(body.zone)]);
            for (std::size_t a = 0; a < n; ++a) text += fmt::format(",{}", number_text(body.centre[a]));
            text += fmt::format(",{}", number_text(body.angle));
            if (scaled) text += fmt::format(",{}", number_text(shapes_.scales(body) ? body.scale : 1.0));
            for (std::size_t a = 0; moving && a < n; ++a)
                text += fmt::format(",{}", number_text(body.velocity[a]));
            text += "\n";
        }
        return text;
    }

    const PeridemDeck& deck_;
    const std::vector<PeridemBody>& bodies_;
    const ShapeBook& shapes_;
    const ImportedMaterials& materials_;
};

std::string output_section(const PeridemDeck& deck, const PeridemBodies& bodies, bool fixed_step) {
    std::string text;
    const auto interval = [&](const char* name, double value) {
        if (value > 0.0 && fixed_step) text += fmt::format("{}: {}, ", name, number_text(value));
    };
    interval("interval", deck.frame_interval);
    interval("history_interval", deck.row_interval);
    const std::string some = bodies.watched ? ids_text({*bodies.watched}) : "[]";
    const std::string track = bodies.bodies.size() <= most_in_deck ? "all" : some;
    return fmt::format("output: {{{}track: {}}}\n", text, track);
}

/// Each key once, zones and sets without their numbers.
std::string unused_keys(const ImportNotes& notes) {
    static const std::regex numbered("(Zone|Set)_[0-9]+");
    std::vector<std::string> keys;
    for (const std::string& name : notes.unused) {
        const std::string key = std::regex_replace(name, numbered, "$1_*");
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
    return join(keys);
}

/// Words in lines of at most 110 characters that begin with `first`, then with `next`.
std::string wrapped(const std::string& text, const std::string& first, const std::string& next) {
    std::string result, line = first;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        if (line.size() + 1 + word.size() > 110) {
            result += line + "\n";
            line = next;
        }
        line += fmt::format(" {}", word);
        begin = end + 1;
    }
    return result + line + "\n";
}

std::string head(const PeridemDeck& deck, const ImportNotes& notes) {
    std::string text = wrapped(fmt::format("Imported from PeriDEM: {}", deck.file), "#", "#  ");
    const std::string unused = unused_keys(notes);
    if (!unused.empty()) text += wrapped(fmt::format("Not used: {}", unused), "#", "#  ");
    if (!notes.differs.empty()) text += "# Differs from PeriDEM:\n";
    for (const std::string& sentence : notes.differs) text += wrapped(sentence, "# -", "#  ");
    return text;
}

}  // namespace

ImportedDeck write_imported_deck(const PeridemDeck& deck, const PeridemBodies& bodies,
                                 ImportedHorizon horizon, const std::string& stem, ImportNotes& notes) {
    const double limit = hopeless_step(deck, bodies);
    const bool fixed_step = deck.step <= limit;
    if (!fixed_step)
        notes.add_difference(fmt::format(
            "time.step and output: auto, because the step of the deck, {:.3g} s, is far above what "
            "is stable (below {:.2g} s)",
            deck.step, limit));
    const ShapeBook shapes(deck, bodies, horizon);
    const bool any_scaled =
        std::any_of(bodies.bodies.begin(), bodies.bodies.end(), [&](const PeridemBody& body) {
            return body.scale != 1.0 && shapes.scales(body) &&
                   deck.zones[static_cast<std::size_t>(body.zone)].material.horizon > 0.0;
        });
    if (any_scaled)
        notes.add_difference(
            "the horizon of a grain grows with its size (--horizon scaled); PeriDEM's does not");
    const ImportedMaterials materials = group_materials(deck);

    ImportedDeck result;
    result.files = shapes.files();
    result.n_shapes = shapes.n_shapes();
    const std::string held = loads_section(deck, bodies, fixed_step, notes);
    const std::string title = deck.test_name.empty() ? "PeriDEM deck" : deck.test_name + " (PeriDEM)";
    std::string body = fmt::format("title: {}\ndimension: {}\n", quoted(title), deck.dimension);
    const bool by_name = held.find("dt}") != std::string::npos;
    if (by_name) body += fmt::format("params: {{dt: {}}}\n", number_text(deck.step));
    body += fmt::format("time: {{end: {}, step: {}}}\n", number_text(deck.end),
                        !fixed_step ? "auto"
                        : by_name   ? "\"${dt}\""
                                    : number_text(deck.step));
    body += fmt::format("gravity: {}\n", vector_text(deck.gravity, deck.dimension));
    body += materials_section(deck, bodies, materials);
    body += shapes.section();
    body += grid_section(deck, bodies);
    body += contact_section(deck, materials);
    body += held;
    body += output_section(deck, bodies, fixed_step);
    body += GrainWriter(deck, bodies, shapes, materials).section(stem, result.files);
    result.text = head(deck, notes) + body;
    return result;
}

}  // namespace quern
