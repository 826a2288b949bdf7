#include "src/sim/checkpoint.hpp"

#include <algorithm>
#include <cstring>

namespace quern {

namespace {

template <int Dim>
void pass_ledger(Checkpoint& checkpoint, Ledger<Dim>& ledger) {
    typename Ledger<Dim>::Entry& past = ledger.past;
    checkpoint.value("ledger damping", past.damping);
    checkpoint.value("ledger load", past.load);
    checkpoint.value("ledger constraint", past.constraint);
    checkpoint.value("ledger normal", past.normal);
    checkpoint.value("ledger friction", past.friction);
    checkpoint.value("ledger wall", past.wall);
    checkpoint.value("ledger fracture", past.fracture);
    checkpoint.value("ledger plastic", past.plastic);
    checkpoint.value("ledger transfer", past.transfer);
    checkpoint.value("ledger impulse", past.impulse);
    checkpoint.value("ledger moment", past.moment);
}

template <int Dim>
void pass_contact(Checkpoint& checkpoint, Scene<Dim>& scene) {
    auto* pairs = scene.contact ? std::get_if<NodePairContact<Dim>>(&*scene.contact) : nullptr;
    if (pairs == nullptr) return;
    PairMemory<Dim> memory;
    if (!checkpoint.loading()) memory = pairs->memory();
    checkpoint.vector("slip of", memory.particle);
    checkpoint.vector("slip against", memory.partner);
    checkpoint.vector("slip", memory.slip);
    checkpoint.vector("wall velocity before", memory.wall_velocity);
    if (checkpoint.loading()) pairs->recall(memory, scene.particles.x.size());
}

void pass_fragments(Checkpoint& checkpoint, Fragments& fragments) {
    if (fragments.of_particle.empty()) return;
    std::vector<std::int64_t> numbers;
    std::vector<double> born;
    for (const Fragment& f : fragments.all) {
        numbers.insert(numbers.end(), {f.parent, f.grain, f.particles, f.step});
        born.push_back(f.born);
    }
    checkpoint.vector("fragments", numbers);
    checkpoint.vector("fragments born", born);
    fragments.all.clear();
    for (std::size_t k = 0; k < born.size(); ++k) {
        const std::int64_t* f = numbers.data() + 4 * k;
        fragments.all.push_back({f[0], f[1], f[2], f[3], born[k]});
    }
    std::vector<std::int64_t> wide(fragments.of_particle.begin(), fragments.of_particle.end());
    checkpoint.array("fragment of particle", std::span(wide));
    std::transform(wide.begin(), wide.end(), fragments.of_particle.begin(),
                   [](std::int64_t number) { return static_cast<std::int32_t>(number); });
    checkpoint.array("broken bonds", std::span(fragments.broken));
}

}  // namespace

template <int Dim>
void pass_state(Checkpoint& checkpoint, Scene<Dim>& scene, StepContext<Dim>& now) {
    checkpoint.value("step", now.step);
    checkpoint.value("time", now.time);
    checkpoint.array("x", std::span(scene.particles.x));
    checkpoint.array("v", std::span(scene.particles.v));
    checkpoint.array("drift", std::span(scene.arrays.drift));
    checkpoint.array("x start", std::span(scene.x_start));
    checkpoint.array("bonds alive", std::span(scene.alive));
    checkpoint.array("plastic strain", std::span(scene.plastic));
    if (!scene.works.empty()) checkpoint.array("works of bonds", std::span(scene.works));
    if (scene.points) {
        checkpoint.array("points", scene.points->states());
        PointContact<Dim>& contact = scene.point_contact;
        checkpoint.vector("contact asked for", contact.last);
        checkpoint.vector("contact mapped", contact.mapped);
        checkpoint.value("part of a step", contact.part);
    }
    for (Wall<Dim>& wall : scene.walls) {
        checkpoint.value("wall point", wall.point);
        checkpoint.value("wall velocity", wall.velocity);
    }
    for (std::optional<Servo>& servo : scene.servos) {
        if (!servo) continue;
        checkpoint.value("servo speed", servo->speed);
        checkpoint.value("servo pressed", servo->pressed);
    }
    checkpoint.value("travelled", scene.travelled);
    pass_fragments(checkpoint, scene.fragments);
    pass_contact(checkpoint, scene);
    if (checkpoint.loading()) recall_broken_bonds(scene);
    pass_ledger(checkpoint, now.ledger);
    checkpoint.array("grain impulse", std::span(now.grain_impulse));
    for (Reaction<Dim>& reaction : now.reactions) {
        checkpoint.value("reaction impulse", reaction.impulse);
        checkpoint.value("reaction moment", reaction.moment);
        checkpoint.value("reaction work", reaction.work);
    }
    checkpoint.value("unconverged", now.unconverged);
    checkpoint.value("first unconverged", now.first_unconverged);
    checkpoint.value("newly broken", now.newly_broken);
    checkpoint.value("contact nodes", now.contact_nodes);
    checkpoint.value("contacts", now.contacts);
    checkpoint.value("sweeps", now.sweeps);
    checkpoint.value("searches", now.searches);
    now.first = false;
}

template <int Dim>
std::int64_t shapes_hash(const Scene<Dim>& scene) {
    std::uint64_t hash = 14695981039346656037ull;
    const auto add = [&](double value) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (bits >> 8 * byte & 0xff)) * 1099511628211ull;
    };
    for (const auto& shape : scene.shapes)
        for (std::size_t i = 0; i < shape->X.size(); ++i) {
            for (int a = 0; a < Dim; ++a) add(shape->X[i][a]);
            add(shape->volume[i]);
        }
    return static_cast<std::int64_t>(hash);
}

void pass_origin(Checkpoint& checkpoint, RunOrigin& origin) {
    for (std::string* text : {&origin.folder, &origin.deck_hash}) {
        std::vector<std::uint8_t> letters(text->begin(), text->end());
        checkpoint.vector("origin", letters);
        text->assign(letters.begin(), letters.end());
    }
}

void pass_position(Checkpoint& checkpoint, ResultPosition& position) {
    checkpoint.value("frames", position.n_frames);
    checkpoint.value("history bytes", position.history_bytes);
    checkpoint.value("grains bytes", position.grains_bytes);
    checkpoint.value("reactions bytes", position.reactions_bytes);
    checkpoint.value("xdmf bytes", position.xdmf_bytes);
    checkpoint.value("pvd bytes", position.pvd_bytes);
    checkpoint.value("fragments bytes", position.fragments_bytes);
    for (std::int64_t& bytes : position.tables_bytes) checkpoint.value("table bytes", bytes);
}

template void pass_state(Checkpoint&, Scene<2>&, StepContext<2>&);
template void pass_state(Checkpoint&, Scene<3>&, StepContext<3>&);
template std::int64_t shapes_hash(const Scene<2>&);
template std::int64_t shapes_hash(const Scene<3>&);

}  // namespace quern
