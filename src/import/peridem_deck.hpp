// A PeriDEM deck as plain data: what its YAML file says, checked and complete. SI units, zones from 0.
//
// The format: PeriDEM 0.1.0 and later (github.com/prashjha/PeriDEM, src/inp/input.cpp), one YAML file, one
// mesh a zone, one table of grains. It has no schema, and unknown keys have no effect there; here they are
// errors.
#pragma once

#include <optional>

#include "src/import/peridem_section.hpp"

namespace quern {

/// A region or the outline of a container: `Type` and `Parameters` of PeriDEM.
struct PeridemGeometry {
    std::string type;
    std::vector<double> parameters;
    std::string where;  ///< for messages
};

struct PeridemMaterial {
    double density = 0.0;
    std::optional<double> bulk, shear, young, poisson;  ///< exactly two [Pa, Pa, Pa, 1]
    std::optional<double> fracture_energy;              ///< Gc [J/m^2]; none: bonds never break
    double horizon = 0.0;                               ///< [m]; 0: mesh_ratio times the mesh size
    double mesh_ratio = 0.0;
    std::string influence;  ///< word of ours
    bool operator==(const PeridemMaterial&) const = default;
};

/// Contact of two zones.
struct PeridemContact {
    double radius = 0.0;  ///< Rc [m]; 0: radius_factor times the least distance of two nodes of a body
    double radius_factor = 0.0;
    double stiffness = 0.0;       ///< Kn, its factor included; force per volume, volume and length
    double restitution = 1.0;     ///< Epsilon; 1: no damping
    double damping_factor = 0.0;  ///< Beta_n_Factor
    double friction = 0.0;
    bool operator==(const PeridemContact&) const = default;
};

struct PeridemZone {
    bool wall = false;
    bool held = false;       ///< All_Dofs_Constrained
    bool as_meshed = false;  ///< one body, where its mesh stands
    std::string type;        ///< "circle", ...
    double radius = 0.0;     ///< first parameter: size of the mesh [m]; 0: none given
    std::string mesh;        ///< path of the file
    std::string mesh_where;  ///< for messages
    PeridemMaterial material;
};

enum class TimeFunction { constant, linear, quadratic, sine, rotation, linear_step, linear_slow_fast };
enum class SpatialFunction { constant, hat_x, hat_y, sin_x, sin_y, linear_x, linear_y, rotation };

/// A set of displacements or forces.
struct PeridemSet {
    std::optional<std::vector<int>> bodies;  ///< none: all
    bool walls_only = false;                 ///< `bodies` counts walls only
    std::vector<int> excluded;
    std::optional<PeridemGeometry> region;
    std::vector<int> direction;  ///< axes from 0
    TimeFunction time = TimeFunction::constant;
    std::vector<double> time_parameters;
    SpatialFunction space = SpatialFunction::constant;
    std::vector<double> space_parameters;
    bool zero = false;       ///< Zero_Displacement
    std::string where, key;  ///< for messages: with file and line, without
};

struct PeridemDeck {
    std::string file;
    int dimension = 2;
    double end = 0.0, step = 0.0;  ///< [s]
    int n_steps = 1;
    int seed = 1;
    std::string test_name;
    PeridemGeometry container;
    std::vector<PeridemZone> zones;
    bool walls_apart = false;  ///< an old deck: walls in a section of their own, numbered by themselves
    std::string particles;     ///< path of the table; "": none
    bool oriented = false;     ///< it has angles
    std::string particles_where;
    std::vector<std::vector<PeridemContact>> contact;  ///< [zone][zone], symmetric; empty: none
    Numbers3 gravity{};
    std::vector<PeridemSet> displacements, forces;
    Numbers3 velocity{};  ///< initial, of `moving` [m/s]
    std::vector<int> moving;
    std::string moving_where;
    std::optional<int> watched;    ///< body whose force the compression test reports
    bool watched_is_wall = false;  ///< its number counts walls only
    std::string watched_where;
    double frame_interval = 0.0, row_interval = 0.0;  ///< [s]; 0: not given
};

/// Reads `path`. Throws InputError; what has no meaning here goes to `notes`.
PeridemDeck read_peridem_deck(const std::string& path, ImportNotes& notes);

// Parts of it, each in a file of its own.
PeridemGeometry read_peridem_geometry(const Section& section);
void read_peridem_zones(const Section& root, PeridemDeck& deck);
void read_peridem_materials(const Section& root, PeridemDeck& deck);
void read_peridem_contact(const Section& root, PeridemDeck& deck);
void read_peridem_loads(const Section& root, PeridemDeck& deck);

}  // namespace quern
