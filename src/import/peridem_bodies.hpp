// The bodies of a PeriDEM deck: grains of its table and walls, with their meshes.
#pragma once

#include "src/import/peridem_deck.hpp"

namespace quern {

/// A row of the table of grains.
struct PeridemGrain {
    int zone = 0;         ///< from 0
    Numbers3 centre{};    ///< where the origin of the mesh goes [m]
    double radius = 0.0;  ///< [m]
    double angle = 0.0;   ///< about z [rad]
};

/// Reads the table: columns i (zone, from 0), x, y, z, r, and o where grains have an angle; others are passed
/// over. Without angles, those that PeriDEM draws: 2 pi u, u of std::mt19937 anew for each zone
/// (two_particle: k pi). Throws InputError with file, line and column.
std::vector<PeridemGrain> read_peridem_grains(const PeridemDeck& deck, ImportNotes& notes);

/// A mesh as its file has it, in its own coordinates.
struct PeridemMesh {
    std::vector<Numbers3> X;  ///< [m]
    Numbers3 centre{};        ///< of mass [m]
    double spacing = 0.0;     ///< (mean nodal volume)^(1/dimension) [m]
    double least = 0.0;       ///< least distance of two nodes [m]
};

/// One body: x = place + scale R(angle) X in the coordinates X of its mesh.
struct PeridemBody {
    int zone = 0;
    double scale = 1.0;
    Numbers3 place{};
    double angle = 0.0;   ///< about z [rad]
    Numbers3 centre{};    ///< of mass [m]: what a deck of ours calls its position
    Numbers3 velocity{};  ///< [m/s]
    bool in_table = false;

    Numbers3 at(const Numbers3& X) const;
};

struct PeridemBodies {
    std::vector<PeridemMesh> meshes;  ///< [zone]
    std::vector<PeridemBody> bodies;  ///< as PeriDEM numbers them: by zone, then by row; old walls last
    std::vector<int> walls;           ///< bodies of walls, in order
    std::optional<int> watched;       ///< the one whose force the compression test reports
};

/// Throws InputError for a mesh that cannot be used, or a list that names a body that is not there.
PeridemBodies make_peridem_bodies(const PeridemDeck& deck, ImportNotes& notes);

/// The numbers of bodies that a set acts on; empty: all.
std::vector<int> bodies_of(const PeridemSet& set, const PeridemBodies& bodies);

/// Least distance of two nodes of one body, over all bodies [m].
double least_distance(const PeridemBodies& bodies);

}  // namespace quern
