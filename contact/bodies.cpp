#include "contact/bodies.hpp"

#include <algorithm>
#include <cmath>

#include "contact/piece_shape.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

constexpr double next_to = 1.5;       ///< longest bond that stands for a piece of a crack face [dx]
constexpr double crack_range = 0.95;  ///< faces of a crack touch this near [dx]
constexpr int longest_run = 2048;

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
    cracks_outdated_ = true;
    const bool same =
        piece.empty() ||
        (grain.piece.empty() ? std::all_of(piece.begin(), piece.end(), [](int k) { return k == 0; })
                             : std::equal(piece.begin(), piece.end(), grain.piece.begin()));
    if (!same) grain.piece.assign(piece.begin(), piece.end());
    grain.cracks.clear();
    for (const BrokenBond& bond : broken)
        if ((grain.piece.empty() || grain.piece[bond.first] == grain.piece[bond.second]) &&
            (shape.X[bond.first] - shape.X[bond.second]).norm() <= next_to * shape.dx)
            grain.cracks.push_back(bond);
    if (same) return;
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
    changed_ = bodies_outdated_ = true;
}

template <int Dim>
void ContactBodies<Dim>::make_bodies(const ContactScene<Dim>& grains) {
    order_.resize(grains.x.size());
    place_of_.resize(grains.x.size());
    body_of_.resize(grains.x.size());
    in_order_ = true;
    runs_.clear();
    bodies_.clear();
    grain_of_.clear();
    debris_.clear();
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
        const bool in_pieces = torn != nullptr && torn->in_pieces();
        const int last = grain.first + grain.count;
        if (runs_.empty() || runs_.back().moved != in_pieces || last - runs_.back().first > longest_run)
            runs_.push_back({grain.first, last, in_pieces});
        else
            runs_.back().last = last;
        if (!in_pieces) {
            for (int p = grain.first; p < last; ++p) {
                order_[p] = p;
                body_of_[p] = static_cast<int>(bodies_.size());
            }
            bodies_.push_back(grain);
            grain_of_.push_back(static_cast<int>(g));
            continue;
        }
        in_order_ = false;
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
    for (const Fallen& piece : fallen) {
        const int body = static_cast<int>(grain_of_.size());
        grain_of_.push_back(piece.grain);
        for (int place = piece.first; place < piece.first + piece.count; ++place) {
            body_of_[place] = body;
            debris_.push_back({place, body});
        }
    }
    owners_.clear();
    first_of_.clear();
    for (const int g : grain_of_) {
        owners_.push_back(grains.grains[g]);
        first_of_.push_back(owners_.back().first);
        owners_.back().first = 0;
    }
    for (std::size_t place = 0; place < order_.size(); ++place)
        place_of_[order_[place]] = static_cast<int>(place);
    pick<double>(grains.mass, mass_);
    pick<double>(grains.volume, volume_);
    bodies_outdated_ = false;
}

template <int Dim>
void ContactBodies<Dim>::make_cracks(const ContactScene<Dim>& grains) {
    cracks_.clear();
    for (const Torn& torn : torn_) {
        const Grain<Dim>& grain = grains.grains[torn.grain];
        const double range = crack_range * grain.shape->dx * grain.scale;
        for (const BrokenBond& bond : torn.cracks)
            cracks_.push_back(
                {place_of_[grain.first + bond.first], place_of_[grain.first + bond.second], range});
    }
    cracks_outdated_ = false;
}

/// to[i] = from[order[i]]
template <int Dim>
template <class T>
void ContactBodies<Dim>::pick(std::span<const T> from, std::vector<T>& to) const {
    to.resize(from.size());
    parallel::for_each(runs_.size(), [&](std::size_t k) {
        const Run& run = runs_[k];
        if (!run.moved)
            std::copy(from.data() + run.first, from.data() + run.last, to.data() + run.first);
        else
            for (int i = run.first; i < run.last; ++i) to[i] = from[order_[i]];
    });
}

template <int Dim>
ContactScene<Dim> ContactBodies<Dim>::gather(const ContactScene<Dim>& grains) {
    if (bodies_outdated_) make_bodies(grains);
    if (cracks_outdated_) make_cracks(grains);
    if (in_order_) return grains;
    pick<Vec<Dim>>(grains.x, x_);
    return {bodies_, x_, mass_, volume_, grains.walls, grains.friction, grains.travelled};
}

template <int Dim>
ContactTrial<Dim> ContactBodies<Dim>::gather(const ContactTrial<Dim>& grains) {
    if (in_order_) return grains;
    pick<Vec<Dim>>(grains.v_before, v_before_);
    pick<Vec<Dim>>(grains.v, v_);
    drift_.clear();
    if (!grains.drift.empty()) drift_.assign(v_.begin(), v_.end());
    return {grains.dt, v_before_, v_, drift_, grains.largest_speed, grains.first};
}

template <int Dim>
void ContactBodies<Dim>::give_back(const ContactTrial<Dim>& grains) const {
    if (in_order_) return;
    const auto put = [&](const std::vector<Vec<Dim>>& from, std::span<Vec<Dim>> to, const Run& run) {
        if (!run.moved)
            std::copy(from.data() + run.first, from.data() + run.last, to.data() + run.first);
        else
            for (int i = run.first; i < run.last; ++i) to[order_[i]] = from[i];
    };
    parallel::for_each(runs_.size(), [&](std::size_t k) {
        put(v_, grains.v, runs_[k]);
        if (!drift_.empty()) put(drift_, grains.drift, runs_[k]);
    });
}

template class ContactBodies<2>;
template class ContactBodies<3>;

}  // namespace quern
