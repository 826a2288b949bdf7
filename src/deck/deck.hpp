// The deck as plain data: what a YAML file says after parameters, units and defaults are resolved. SI units.
//
// Nothing here knows YAML, and nothing depends on the dimension at compile time: vectors are arrays of three
// numbers of which a 2D deck uses the first two.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "particles/instructions.hpp"
#include "particles/material.hpp"
#include "particles/point_options.hpp"
#include "src/deck/expression.hpp"

namespace quern {

using Numbers3 = std::array<double, 3>;

/// Where a value stands in the user's files, for messages.
struct Place {
    std::string file;
    int line = 0;              ///< from 1; 0 when it came from the command line or from a default
    std::string key;           ///< dotted path, e.g. "materials.glass.density"
    std::string text() const;  ///< "file:line: key"
};

enum class ShapeKind { disk, rectangle, regular_polygon, polygon, sphere, box, mesh, ellipse };
enum class Filling {
    lattice,
    rings,
    mesh
};  ///< rings: concentric (disk), shells (sphere); mesh: gmsh in process

/// What a grain of another scale is made of: the particles of the shape moved apart, or as many as fill it at
/// the spacing of the shape.
enum class Scaling { stretch, refill };

struct ShapeDeck {
    std::string name;
    ShapeKind kind = ShapeKind::disk;
    Filling filling = Filling::lattice;
    double radius = 0.0;                          ///< disk, sphere; circumradius of a regular polygon [m]
    int sides = 0;                                ///< regular polygon
    Numbers3 size{};                              ///< rectangle, box: edge lengths [m]
    std::array<double, 2> semi_axes{};            ///< ellipse: along x and y [m]
    std::vector<std::array<double, 2>> vertices;  ///< polygon, counter-clockwise [m]
    std::string file;                             ///< mesh: path of the .msh, relative to the deck's folder
    double unit = 1.0;                            ///< mesh: metres per unit of length in the file
    double spacing = 0.0;                         ///< wanted particle spacing [m]; not read for `mesh` files
    Scaling scaling = Scaling::stretch;
    Place place;
};

struct GrainDeck {
    std::string shape, material;
    std::string group;  ///< a name by which loads, constraints and outputs choose it; may be empty
    double scale = 1.0;
    Numbers3 position{};
    Numbers3 angle{};  ///< rotation vector [rad]; 2D: component 2 (about z)
    Numbers3 velocity{};
    Numbers3 spin{};    ///< [rad/s]; 2D: component 2
    bool wall = false;  ///< stands for a wall: node pairs see no contact between two of them
    Place place;
};

/// What holds between two materials in the place of what `contact` says for all.
struct ContactPair {
    std::string first, second;                                     ///< materials
    std::optional<double> friction;                                ///< with either method
    std::optional<double> stiffness, restitution, damping_factor;  ///< node pairs, as in NodePairDeck
    std::optional<double> contact_radius, radius_factor;
};

/// A wall that moves along its normal so as to press with a given force; src/sim/servo.hpp.
struct ServoDeck {
    std::optional<Expression> force;                             ///< of t [N; 2D: N/m]
    std::optional<Expression> stress;                            ///< of t, over `area` [Pa]
    double area = 0.0;                                           ///< [m^2; 2D: m]
    double mass = 0.0;                                           ///< [kg; 2D: kg/m]; 0: that of all grains
    std::optional<double> damping;                               ///< [1/s]; none: from the stiffest material
    double max_speed = std::numeric_limits<double>::infinity();  ///< [m/s]
    Place place;
};

/// A rigid plane. Matter stays on the side that `normal` points to.
struct WallDeck {
    std::string name;  ///< "x-", "y+", ... for a side of the grid, or the user's name
    Numbers3 point{};
    Numbers3 normal{};
    double friction = 0.0;
    std::vector<Expression> velocity;  ///< of t [m/s]; empty: at rest
    std::optional<ServoDeck> servo;    ///< takes the place of the velocity along the normal
    Place place;
};

struct GridDeck {
    Numbers3 origin{};
    Numbers3 extent{};  ///< edge lengths [m]
    double spacing = 0.0;
    std::array<bool, 3> periodic{};
    Place place;
};

enum class ContactRule { none, pair, surface, seed, no_slip };  ///< no_slip: material points, one field
enum class ContactWalls { rule, exact, tile };                  ///< rule: exact for surface, tile for pair
enum class ContactCoupling { impulse, flip };
enum class ContactMethodKind { grid, node_pair };

enum class NodePairStiffness { layer, consistent, published };
enum class NodePairRadius { surface, published };
enum class NodePairDamping { none, nodes, centres };
enum class NodePairFriction { history, slip, published };
enum class NodePairParticles { surface, all };

/// Contact between nodes; equations in contact/node_pair_law.hpp and node_pair_contact.hpp.
struct NodePairDeck {
    std::optional<double> stiffness;  ///< K [N/m^7; 2D: N/m^6]; none: by the rule
    NodePairStiffness stiffness_rule = NodePairStiffness::layer;
    NodePairRadius radius = NodePairRadius::surface;
    double radius_factor = 0.95;           ///< over the smallest distance of two nodes
    std::optional<double> contact_radius;  ///< R [m]; none: by the rule
    NodePairDamping damping = NodePairDamping::none;
    double restitution = 0.9;       ///< of two nodes, or in the formula of the published dashpots
    double damping_factor = 100.0;  ///< of the published dashpots
    NodePairFriction friction_law = NodePairFriction::history;
    double tangential_ratio = 0.8;    ///< tangential over normal stiffness
    double tangential_damping = 0.0;  ///< part of the critical one
    NodePairParticles particles = NodePairParticles::surface;
    bool self_contact = true;
    double skin = 0.3;  ///< [largest R]
};

/// Contact. All but method, friction, pairs and `rule: none` belong to the grid. Each switch turns one
/// ingredient of the pair rule off, to show what it does.
struct ContactDeck {
    ContactMethodKind method = ContactMethodKind::grid;
    ContactRule rule = ContactRule::pair;
    ContactWalls walls = ContactWalls::rule;
    ContactCoupling coupling = ContactCoupling::impulse;
    double friction = 0.0;  ///< between grains, where no pair of materials says otherwise
    std::vector<ContactPair> pairs;
    NodePairDeck node_pair;
    bool fragments = true;         ///< fragments of a grain are bodies of their own; false: one body a grain
    int debris = 16;               ///< pieces of fewer particles than this are debris, with either method
    double interior_weight = 1.0;  ///< q: weight of interior particles in the impulse map, in (0, 1]
    int max_sweeps = 50;
    double tolerance = 1e-3;  ///< sweeps end when sum|dJ| < tolerance * sum J_n
    double skin = 0.2;        ///< nodes are searched anew when something has moved this far [cells]
    bool tile = true;  ///< gap at the closest approach of two fitted profiles; false: from mean positions
    bool curvature = true;   ///< profiles know the reference curvature
    bool rotation = true;    ///< impulses act at one point: rotation term of the map
    bool gap_test = true;    ///< allow approach at gap / dt
    bool exact_mass = true;  ///< exact inverse mass of the impulse map; false: lumped nodal mass
    Place place;
};

/// Body force on grains: an acceleration, or a force per volume, as functions of x, y, z, t.
struct LoadDeck {
    std::vector<int> grains;           ///< empty: all
    std::vector<std::string> groups;   ///< beside numbers, until make_deck has put numbers in their place
    std::optional<Expression> region;  ///< of reference x, y, z (as placed at t = 0); non-zero: inside
    bool per_mass = true;              ///< true: acceleration [m/s^2]; false: force density [N/m^3]
    std::vector<Expression> value;     ///< one an axis
    Place place;
};

/// Prescribed velocity of particles, per axis (no value: free).
struct ConstraintDeck {
    std::vector<int> grains;          ///< empty: all
    std::vector<std::string> groups;  ///< as in LoadDeck
    std::optional<Expression> region;
    std::array<std::optional<Expression>, 3> velocity;  ///< of x, y, z, t (current position) [m/s]
    Place place;
};

/// What places are measured in: the box, or a shape, from its centre of mass, at scale 1 and angle 0.
enum class PlaceFrame { world, shape };

/// A cut that grains have from the start: from `from` to `to` in 2D; in 3D a parallelogram with `edge` as its
/// other edge.
struct CrackDeck {
    std::vector<int> grains;          ///< empty: all
    std::vector<std::string> groups;  ///< as in LoadDeck
    std::string shape;                ///< only grains of this shape; empty: all
    PlaceFrame frame = PlaceFrame::world;
    Numbers3 from{}, to{};  ///< [m]
    Numbers3 edge{};        ///< [m]
    Place place;
};

/// Where bonds never break: those with an end in the region.
struct NoFailDeck {
    std::vector<int> grains;
    std::vector<std::string> groups;  ///< as in LoadDeck
    std::string shape;
    PlaceFrame frame = PlaceFrame::world;
    std::optional<Expression> region;  ///< of x, y, z; non-zero: inside
    Place place;
};

/// Relaxation before the clock starts: own gravity, damping and friction, then velocities are zeroed and
/// the initial velocities of the deck are given.
struct PrepareDeck {
    double duration = 0.0;            ///< [s]
    std::optional<Numbers3> gravity;  ///< [m/s^2]; none: as in the run
    double mass_damping = 0.0;        ///< [1/s]
    std::optional<double> friction;   ///< for all contacts; none: as in the run
    std::vector<LoadDeck> loads;      ///< on top of those of the run, which see t = 0
};

struct TimeDeck {
    double end = 0.0;     ///< [s]
    double step = 0.0;    ///< [s]; 0: automatic
    double safety = 0.6;  ///< automatic step = safety * 2 / omega_max
    Place place;
};

/// How forces inside the grains are evaluated.
enum class ForceKernel { automatic, single, reference };
struct ComputeDeck {
    ForceKernel kernel = ForceKernel::automatic;
    Instructions instructions = Instructions::best;
    Place place;
};

/// States from which a run can go on.
struct CheckpointDeck {
    int every = 0;  ///< steps; 0: only when the run is stopped
};

struct OutputDeck {
    double interval = 0.0;            ///< frames of results.h5 [s]; 0: 100 frames in the run
    double history_interval = 0.0;    ///< rows of history.csv and grains.csv [s]; 0: 1000 rows in the run
    std::vector<int> track;           ///< grains in grains.csv
    std::vector<std::string> groups;  ///< as in LoadDeck, of track
    bool track_all = false;
    bool vtp = false;  ///< also a .vtp series
    CheckpointDeck checkpoint;
    Place place;
};

enum class Axis { x, y, z };

/// Where observers take means: a box, or all between the walls, and there where a formula is not 0.
struct ObserveRegion {
    std::string name;
    std::optional<Numbers3> from, to;  ///< lower, upper corner [m]; none: the box between the walls
    std::optional<Expression> where;   ///< of x, y, z, t; non-zero: inside
};

/// Means over slices of the box between the walls.
struct ObserveProfile {
    std::string name;
    Axis axis = Axis::y;
    int bins = 20;
    std::optional<double> from, to;  ///< [m]; none: the box between the walls
};

/// Contacts, stress and their means with every frame; docs/observers.md.
struct ObserveDeck {
    bool on = false;
    std::vector<ObserveRegion> regions;  ///< beside all
    std::vector<ObserveProfile> profiles;
    double force_bin = 0.25;  ///< width of the bins of P(f), over the mean force
};

struct Deck {
    std::string title;
    std::string file;  ///< path as given
    int dimension = 2;
    std::vector<Material> materials;
    std::vector<ShapeDeck> shapes;
    std::vector<GrainDeck> grains;
    GridDeck grid;
    std::vector<WallDeck> walls;
    ContactDeck contact;
    Numbers3 gravity{};
    double mass_damping = 0.0;  ///< force -mass_damping m v [1/s]
    std::vector<LoadDeck> loads;
    std::vector<ConstraintDeck> constraints;
    std::vector<CrackDeck> cracks;
    std::vector<NoFailDeck> no_fail;
    PrepareDeck prepare;
    TimeDeck time;
    ComputeDeck compute;
    PointOptions material_points;
    OutputDeck output;
    ObserveDeck observe;
};

}  // namespace quern
