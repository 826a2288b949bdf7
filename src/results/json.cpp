#include "src/results/json.hpp"

#include <fmt/format.h>

#include <cmath>

namespace quern {

namespace {

/// Bytes of the UTF-8 character that starts `text`; 0 where none does.
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(0);
    const std::size_t n = first < 0x80         ? 1
                          : first >> 5 == 0x6  ? 2
                          : first >> 4 == 0xe  ? 3
                          : first >> 3 == 0x1e ? 4
                                               : 0;
    if (n == 0 || n > text.size()) return 0;
    char32_t code = n == 1 ? first : first & (0xffu >> (n + 1));
    for (std::size_t i = 1; i < n; ++i) {
        if (byte(i) >> 6 != 0x2) return 0;
        code = code << 6 | (byte(i) & 0x3fu);
    }
    constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return code < smallest[n] || code > 0x10ffff || surrogate ? 0 : n;
}

/// An object or list with one member a line.
class Block {
  public:
    Block(char open, char close, int depth) : text_(1, open), close_(close), indent_(2 * (depth + 1), ' ') {}
    void add(std::string_view member) {
        text_ += fmt::format("{}\n{}{}", empty_ ? "" : ",", indent_, member);
        empty_ = false;
    }
    void add(std::string_view key, std::string_view value) {
        add(fmt::format("{}: {}", json_string(key), value));
    }
    std::string str() const {
        return empty_ ? text_ + close_ : fmt::format("{}\n{}{}", text_, indent_.substr(2), close_);
    }

  private:
    std::string text_;
    char close_;
    std::string indent_;
    bool empty_ = true;
};

std::string make_energy(const EnergyBudget& energy, double residual_relative) {
    Block block('{', '}', 1);
    block.add("kinetic", json_number(energy.kinetic));
    block.add("elastic", json_number(energy.elastic));
    block.add("contact_elastic", json_number(energy.contact_elastic));
    block.add("gravity", json_number(energy.gravity));
    block.add("damping", json_number(energy.damping));
    block.add("friction", json_number(energy.friction));
    block.add("contact_loss", json_number(energy.contact_loss));
    block.add("fracture", json_number(energy.fracture));
    block.add("plastic", json_number(energy.plastic));
    block.add("transfer_loss", json_number(energy.transfer_loss));
    block.add("external_work", json_number(energy.external_work));
    block.add("residual", json_number(energy.residual));
    block.add("throughput", json_number(energy.throughput));
    block.add("residual_relative", json_number(residual_relative));
    return block.str();
}

std::string make_reaction(const ReactionRow& row, int dimension) {
    const auto vector = [&](const double(&v)[3]) {
        const std::string plane = fmt::format("[{}, {}", json_number(v[0]), json_number(v[1]));
        return dimension == 2 ? plane + "]" : fmt::format("{}, {}]", plane, json_number(v[2]));
    };
    return fmt::format("{{\"name\": {}, \"displacement\": {}, \"force\": {}, \"moment\": {}, \"work\": {}}}",
                       json_string(row.name), vector(row.displacement), vector(row.force),
                       dimension == 2 ? json_number(row.moment[2]) : vector(row.moment),
                       json_number(row.work));
}

std::string make_vector(const double* values, int count) {
    std::string text = "[";
    for (int k = 0; k < count; ++k) text += (k > 0 ? ", " : "") + json_number(values[k]);
    return text + "]";
}

std::string make_fragment(const FragmentRow& row, int dimension) {
    return fmt::format(
        "{{\"fragment\": {}, \"grain\": {}, \"parent\": {}, \"born\": {}, \"born_step\": {}, \"particles\": "
        "{}, "
        "\"mass\": {}, \"position\": {}, \"velocity\": {}, \"omega\": {}, \"stress\": {}, \"damage\": {}}}",
        row.fragment, row.grain, row.parent, json_number(row.born), row.born_step, row.particles,
        json_number(row.mass), make_vector(row.position, dimension), make_vector(row.velocity, dimension),
        dimension == 2 ? json_number(row.omega[2]) : make_vector(row.omega, 3),
        make_vector(row.stress, dimension == 2 ? 4 : 6), json_number(row.damage));
}

}  // namespace

std::string json_string(std::string_view text) {
    std::string quoted = "\"";
    while (!text.empty()) {
        const std::size_t n = utf8_length(text);
        const char c = text.front();
        if (n == 0)
            quoted += "\\ufffd";
        else if (c == '"' || c == '\\')
            (quoted += '\\') += c;
        else if (c == '\n')
            quoted += "\\n";
        else if (c == '\t')
            quoted += "\\t";
        else if (n == 1 && (c < 0x20 || c == 0x7f))
            quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            quoted += text.substr(0, n);
        text.remove_prefix(n == 0 ? 1 : n);
    }
    return quoted + '"';
}

std::string json_number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

std::string make_summary_json(const Summary& summary) {
    Block stages('{', '}', 1);
    for (const auto& [name, seconds] : summary.stages) stages.add(name, json_number(seconds));
    Block contact('{', '}', 1);
    for (const auto& [name, mean] : summary.contact_per_step) contact.add(name, json_number(mean));
    Block momentum_error('{', '}', 1);
    momentum_error.add("linear", json_number(summary.momentum_error_linear));
    momentum_error.add("angular", json_number(summary.momentum_error_angular));
    Block warnings('[', ']', 1);
    for (const auto& [text, count] : summary.warnings)
        warnings.add(fmt::format("{{\"text\": {}, \"count\": {}}}", json_string(text), count));

    Block reactions('[', ']', 1);
    for (const ReactionRow& row : summary.reactions) reactions.add(make_reaction(row, summary.dimension));
    Block fragments('[', ']', 1);
    for (const FragmentRow& row : summary.fragments) fragments.add(make_fragment(row, summary.dimension));

    Block block('{', '}', 0);
    block.add("version", json_string(summary.version));
    block.add("title", json_string(summary.title));
    block.add("outcome", json_string(summary.outcome));
    block.add("dimension", fmt::format("{}", summary.dimension));
    block.add("threads", fmt::format("{}", summary.threads));
    block.add("instructions", json_string(summary.instructions));
    block.add("deck_hash", json_string(summary.deck_hash));
    block.add("state_hash", json_string(summary.state_hash));
    block.add("steps", fmt::format("{}", summary.steps));
    block.add("n_particles", fmt::format("{}", summary.n_particles));
    block.add("n_bonds", fmt::format("{}", summary.n_bonds));
    block.add("n_grains", fmt::format("{}", summary.n_grains));
    block.add("simulated_time", json_number(summary.simulated_time));
    block.add("time_step", json_number(summary.time_step));
    block.add("stable_step", json_number(summary.stable_step));
    block.add("wall_seconds", json_number(summary.wall_seconds));
    block.add("ns_per_particle_step", json_number(summary.ns_per_particle_step));
    block.add("peak_memory_bytes", json_number(summary.peak_memory_bytes));
    block.add("stages", stages.str());
    block.add("writer_seconds", json_number(summary.writer_seconds));
    block.add("contact_per_step", contact.str());
    block.add("reactions", reactions.str());
    block.add("energy", make_energy(summary.energy, summary.residual_relative));
    block.add("momentum_error", momentum_error.str());
    if (!summary.fragments.empty()) block.add("fragments", fragments.str());
    block.add("warnings", warnings.str());
    return block.str() + "\n";
}

}  // namespace quern
