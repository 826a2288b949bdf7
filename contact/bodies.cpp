#include "contact/bodies.hpp"

#include <algorithm>
#include <cmath>

#include "contact/piece_shape.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

constexpr double next_to = 1.5;       ///< longest bond that stands for a piece of a crack face [dx]
constexpr double crack_range = 0.95;  ///< faces of a crack touch this near [dx]
constexpr std::size_t block = 2048;

/// to[i] = from[order[i]]
template <class T>
void pick(std::span<const T> from, std::span<const int> order, std::vector<T>& to) {
    to.resize(from.size());
    parallel::for_each((order.size() + block - 1) / block, [&](std::size_t b) {
        for (std::size_t i = b * block, end = std::min(order.size(), i + block); i < end; ++i)
            to[i] = from[static_cast<std::size_t>(order[i])];
    });
}

}  // namespace

template <int Dim>
typename ContactBodies<Dim>::Torn& ContactBodies<Dim>::torn(int grain) {
    const auto at = std::partition_point(torn_.begin(), torn_.end(),
                                         [&](const Torn& torn) { return torn.grain < grain; });
    if (at != torn_.end() && at->grain == grain) return *at;
    Torn fresh;
    fresh.grain = grain;
    return *torn_.insert(at, std::move(fresh));
}

template <int Dim>
void ContactBodies<Dim>::set_pieces(const ContactScene<Dim>& scene, int g, std::span<const int> piece,
                                    std::span<const BrokenBond> broken) {
    const Shape<Dim>& shape = *scene.grains[g].shape;
    Torn& grain = torn(g);
    outdated_ = true;
    grain.cracks.clear();
    for (const BrokenBond& bond : broken)
        if (piece[bond.first] == piece[bond.second] &&
            (shape.X[bond.first] - shape.X[bond.second]).norm() <= next_to * shape.dx)
            grain.cracks.push_back(bond);
    const bool known = !grain.piece.empty();
    if (known ? std::equal(piece.begin(), piece.end(), grain.piece.begin())
              : std::all_of(piece.begin(), piece.end(), [](int k) { return k == 0; })) {
        grain.piece.assign(piece.begin(), piece.end());
        return;
    }
    grain.piece.assign(piece.begin(), piece.end());
    for (Piece& part : grain.pieces)
        if (part.shape) old_shapes_.push_back(std::move(part.shape));
    grain.pieces.clear();
    grain.pieces.resize(static_cast<std::size_t>(*std::max_element(piece.begin(), piece.end())) + 1);
    for (int i = 0; i < shape.n_nodes(); ++i) grain.pieces[piece[i]].nodes.push_back(i);
    for (std::size_t k = 0; k < grain.pieces.size(); ++k) {
        Piece& part = grain.pieces[k];
        if (static_cast<int>(part.nodes.size()) < debris_below_) continue;
        auto of_piece = std::make_unique<Shape<Dim>>(
            make_piece_shape<Dim>(shape, piece, static_cast<int>(k), part.nodes));
        if (!of_piece->surface.empty()) part.shape = std::move(of_piece);
    }
    changed_ = true;
}

template <int Dim>
void ContactBodies<Dim>::make(const ContactScene<Dim>& grains) {
    order_.resize(grains.x.size());
    body_of_.resize(grains.x.size());
    bodies_.clear();
    grain_of_.clear();
    debris_.clear();
    cracks_.clear();
    in_pieces_.clear();
    struct Fallen {
        int grain, first, count;
    };
    std::vector<Fallen> fallen;
    std::size_t next = 0;
    for (std::size_t g = 0; g < grains.grains.size(); ++g) {
        const Grain<Dim>& grain = grains.grains[g];
        const Torn* torn =
            next < torn_.size() && torn_[next].grain == static_cast<int>(g) ? &torn_[next++] : nullptr;
        if (torn == nullptr || torn->pieces.empty()) {
            for (int p = grain.first; p < grain.first + grain.count; ++p) {
                order_[p] = p;
                body_of_[p] = static_cast<int>(bodies_.size());
            }
            bodies_.push_back(grain);
            grain_of_.push_back(static_cast<int>(g));
        } else {
            int place = grain.first;
            for (const bool debris : {false, true})
                for (const Piece& part : torn->pieces) {
                    if (debris != (part.shape == nullptr)) continue;
                    Grain<Dim> body = grain;
                    body.shape = part.shape.get();
                    body.first = place;
                    body.count = static_cast<int>(part.nodes.size());
                    body.mass = body.volume = 0.0;
                    for (const int node : part.nodes) {
                        const int p = grain.first + node;
                        body.mass += grains.mass[p];
                        body.volume += grains.volume[p];
                        body_of_[place] = static_cast<int>(bodies_.size());
                        if (!debris) in_pieces_.push_back(place);
                        order_[place++] = p;
                    }
                    if (debris) {
                        fallen.push_back({static_cast<int>(g), body.first, body.count});
                    } else {
                        bodies_.push_back(body);
                        grain_of_.push_back(static_cast<int>(g));
                    }
                }
        }
        if (torn == nullptr || torn->cracks.empty()) continue;
        std::vector<int> place_of(static_cast<std::size_t>(grain.count));
        for (int place = grain.first; place < grain.first + grain.count; ++place)
            place_of[order_[place] - grain.first] = place;
        for (const BrokenBond& bond : torn->cracks)
            cracks_.push_back(
                {place_of[bond.first], place_of[bond.second], crack_range * grain.shape->dx * grain.scale});
    }
    for (const Fallen& piece : fallen) {
        const int body = static_cast<int>(grain_of_.size());
        grain_of_.push_back(piece.grain);
        for (int place = piece.first; place < piece.first + piece.count; ++place) {
            body_of_[place] = body;
            debris_.push_back({place, body});
        }
    }
    pick<double>(grains.mass, order_, mass_);
    pick<double>(grains.volume, order_, volume_);
    outdated_ = false;
}

template <int Dim>
ContactScene<Dim> ContactBodies<Dim>::gather(const ContactScene<Dim>& grains) {
    if (outdated_) make(grains);
    pick<Vec<Dim>>(grains.x, order_, x_);
    return {bodies_, x_, mass_, volume_, grains.walls, grains.friction, grains.travelled};
}

template <int Dim>
ContactTrial<Dim> ContactBodies<Dim>::gather(const ContactTrial<Dim>& grains) {
    pick<Vec<Dim>>(grains.v_before, order_, v_before_);
    pick<Vec<Dim>>(grains.v, order_, v_);
    drift_.clear();
    if (!grains.drift.empty()) drift_.assign(v_.begin(), v_.end());
    return {grains.dt, v_before_, v_, drift_, grains.largest_speed, grains.first};
}

template <int Dim>
void ContactBodies<Dim>::give_back(const ContactTrial<Dim>& grains) const {
    parallel::for_each((order_.size() + block - 1) / block, [&](std::size_t b) {
        for (std::size_t i = b * block, end = std::min(order_.size(), i + block); i < end; ++i) {
            grains.v[order_[i]] = v_[i];
            if (!drift_.empty()) grains.drift[order_[i]] = drift_[i];
        }
    });
}

template class ContactBodies<2>;
template class ContactBodies<3>;

}  // namespace quern
