// What goes into and out of the loops over batches: raw arrays, a value a lane.
#pragma once

namespace quern {

inline constexpr int batch_lanes = 8;

/// One number of each lane.
struct alignas(64) LaneRow {
    double lane[batch_lanes];
};

/// Constants of one bond, for scale 1, shared by all lanes.
struct BatchBond {
    double length;   ///< xi [m]
    double coupled;  ///< k xi [m^7; 2D: m^5], k = w V_i V_j
    double direct;   ///< c [N/m; 2D: N/m^2]
    double preload;  ///< c xi [N; 2D: N/m]
};

struct BatchTopology {
    int n;                  ///< nodes
    const int* first;       ///< [n + 1] half list: first bond of a row
    const int* partner;     ///< [n_bonds]
    const BatchBond* bond;  ///< [n_bonds]
    const double* node;     ///< [n] g [N/m^15; 2D: N/m^12], or null: no dilatation
};

/// One bond of a union. A lane without it has a zero in `volume` at one of its ends, or in its row of
/// weights.
struct UnionBond {
    int partner;
    int length;  ///< row of `length`
    int weight;  ///< row of `weight`
};

/// Bonds of grains of unlike shape on one lattice: what the shape decides is a value a lane. Constants for
/// scale 1; c = k (q_i + q_j).
struct UnionTopology {
    int n;                  ///< nodes of the union
    const int* first;       ///< [n + 1] half list: first bond of a row
    const UnionBond* bond;  ///< [n_bonds]
    const double* length;   ///< [rows][2][8] xi [m] and 1/xi [1/m]
    const double*
        weight;  ///< [rows][8] k xi/(V_i V_j) [m]; without dilatation c xi/(V_i V_j) [N/m^6; 2D: N/m^5]
    const double* volume;  ///< [n][8] V [m^3; 2D: m^2]; 0: the lane has no such node
    const double* end;     ///< [n][8] q [N/m^7; 2D: N/m^6], or null: no dilatation
    const double* node;    ///< [n][8] g V [N/m^12; 2D: N/m^10], or null: no dilatation
};

/// Rows of eight lanes, aligned to 64 bytes.
struct BatchState {
    const double* x;            ///< [n][Dim][8] positions over the lane's scale
    const double* v;            ///< [n][Dim][8] velocities over the lane's scale, or null
    unsigned char* alive;       ///< [n_bonds] a bit a lane, or null: all intact
    const unsigned char* kept;  ///< [n_bonds] a bit a lane: never breaks; or null: none
    const double* longest;      ///< [8] (1 + critical stretch)^2, or null: nothing breaks
    const double* shortest;     ///< [8] (1 - critical stretch)^2, or null: bonds break in tension only
    double* f;                  ///< [n][Dim][8] out: forces
    double* dilatation;         ///< [n][8] scratch
    int* broken_bond;           ///< [n_bonds] out: what broke just now
    unsigned char* broken_lanes;
    int n_broken;
};

struct BatchLoops {
    template <class Topology>
    struct Set {
        void (*elastic_2d)(const Topology&, BatchState&);
        void (*elastic_3d)(const Topology&, BatchState&);
        void (*viscous_2d)(const Topology&, BatchState&);
        void (*viscous_3d)(const Topology&, BatchState&);
    };
    const char* name;
    Set<BatchTopology> one_shape;
    Set<UnionTopology> lattice;
};

}  // namespace quern
