// Every kind of bad input, and the parts of the message it must give.
#include <doctest/doctest.h>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;

namespace {

struct BadInput {
    std::string what;
    const char* from;  ///< in plain_deck; "": `to` is added at the end
    const char* to;
    std::vector<std::string> parts;  ///< of the message
};

const BadInput bad_inputs[] = {
    // YAML and names
    {"syntax", "gravity: [0, -9.8]", "gravity: [0, -9.8", {"deck.yaml:", "text that is not YAML"}},
    {"tab", "  end: 1 ms", "\tend: 1 ms", {"deck.yaml:5", "not YAML"}},
    {"second document", "", "---\na: 1\n", {"second document"}},
    {"unknown key",
     "    density:",
     "    densty:",
     {"deck.yaml:10: materials.glass.densty", "unknown key", "did you mean density?"}},
    {"unknown section", "contact:", "contacts:", {"deck.yaml:26: contacts", "did you mean contact?"}},
    {"unknown key in flow",
     "friction: 0.3}",
     "frction: 0.3}",
     {"deck.yaml:25: walls.0.frction", "did you mean friction?"}},
    {"duplicate key",
     "    radius: 1 mm",
     "    radius: 1 mm\n    radius: 2 mm",
     {"deck.yaml:18: radius", "second time", "line 17"}},
    {"duplicate section", "", "gravity: [0, 0]\n", {"deck.yaml:35: gravity", "second time", "line 7"}},
    {"section expected",
     "time:\n  end: 1 ms\n  step: auto",
     "time: 3",
     {"deck.yaml:4: time", "got '3'", "expected a section"}},
    {"names expected",
     "shapes:\n  disk:\n",
     "shapes:\n  - disk:\n",
     {"deck.yaml:13: shapes", "got a list", "names, each with its section"}},
    {"list expected",
     "  - {side: y-, friction: 0.3}",
     "  side: y-",
     {"deck.yaml:24: walls", "got a section", "expected a list"}},
    {"missing section", "time:\n  end: 1 ms\n  step: auto\n", "", {"deck.yaml", "no time", "required"}},
    {"missing key",
     "    density: 2440 kg/m^3\n",
     "",
     {"deck.yaml:9: materials.glass", "no density", "a number > 0 in kg/m^3"}},
    {"nothing", "density: 2440 kg/m^3", "density:", {"deck.yaml:10: materials.glass.density", "got nothing"}},
    // numbers and units
    {"text for a number",
     "2440 kg/m^3",
     "heavy",
     {"deck.yaml:10: materials.glass.density", "'heavy'", "a number > 0 in kg/m^3"}},
    {"list for a number", "2440 kg/m^3", "[2440]", {"deck.yaml:10", "got a list", "a number"}},
    {"wrong dimension",
     "2440 kg/m^3",
     "2440 kg",
     {"deck.yaml:10", "'2440 kg' (a quantity in kg)", "a quantity in kg/m^3"}},
    {"a parameter with a unit is no error", "mu: 0.3", "mu: 0.3 m", {}},
    {"unit on friction",
     "  friction: 0.1",
     "  friction: 0.1 Pa",
     {"deck.yaml:28: contact.friction", "a quantity in Pa", "without unit"}},
    {"unknown unit",
     "40 GPa",
     "40 Gpa",
     {"deck.yaml:11: materials.glass.bulk_modulus", "'40 Gpa'", "unknown unit 'Gpa'", "did you mean GPa?"}},
    {"bare arithmetic", "40 GPa", "2*40", {"deck.yaml:11", "arithmetic is written ${2*40}"}},
    {"infinite", "40 GPa", ".inf", {"deck.yaml:11", "'.inf'", "a number > 0 in Pa"}},
    {"not a number", "40 GPa", ".nan", {"deck.yaml:11", "'.nan'", "a number > 0 in Pa"}},
    {"overflow", "40 GPa", "1e999", {"deck.yaml:11", "'1e999'", "a number"}},
    {"negative density", "2440 kg/m^3", "-2440 kg/m^3", {"deck.yaml:10", "-2440", "> 0"}},
    {"negative friction",
     "  friction: 0.1",
     "  friction: -0.1",
     {"deck.yaml:28: contact.friction", "-0.1", ">= 0"}},
    {"zero spacing", "  spacing: 0.2 mm", "  spacing: 0", {"deck.yaml:22: grid.spacing", "> 0 in m"}},
    {"zero end", "end: 1 ms", "end: 0", {"deck.yaml:5: time.end", "> 0 in s"}},
    {"negative step",
     "step: auto",
     "step: -1 us",
     {"deck.yaml:6: time.step", "'-1 us' = -1e-06", "a number > 0 in s"}},
    {"mistyped word for a number",
     "step: auto",
     "step: autp",
     {"deck.yaml:6: time.step", "a number > 0 in s or auto", "did you mean auto?"}},
    {"safety above one", "step: auto", "safety: 1.5", {"deck.yaml:6: time.safety", "in (0, 1]"}},
    {"short horizon",
     "    density:",
     "    horizon_ratio: 1.2\n    density:",
     {"deck.yaml:10", "horizon_ratio", ">= 1.5"}},
    {"fraction for an integer",
     "  rule: pair",
     "  max_sweeps: 2.5",
     {"deck.yaml:27: contact.max_sweeps", "a whole number"}},
    {"unknown word",
     "filling: rings",
     "filling: ring",
     {"deck.yaml:16: shapes.disk.filling", "'ring'", "lattice, rings, mesh", "did you mean rings?"}},
    {"no flag", "  rule: pair", "  tile: maybe", {"deck.yaml:27: contact.tile", "'maybe'", "true or false"}},
    {"dimension", "dimension: 2", "dimension: 4", {"deck.yaml:2: dimension", "'4'", "in [2, 3]"}},
    {"long vector",
     "gravity: [0, -9.8]",
     "gravity: [0, -9.8, 0]",
     {"deck.yaml:7: gravity", "a list of 3", "a list of 2 numbers"}},
    {"unit in a vector",
     "gravity: [0, -9.8]",
     "gravity: [0, -9.8 m/s]",
     {"deck.yaml:7: gravity.1", "m/s", "m/s^2"}},
    // materials
    {"three moduli",
     "    density:",
     "    poisson_ratio: 0.25\n    density:",
     {"deck.yaml:9: materials.glass", "bulk_modulus, shear_modulus, poisson_ratio", "exactly two"}},
    {"one modulus", "    bulk_modulus: 40 GPa\n", "", {"deck.yaml:9", "got shear_modulus", "exactly two"}},
    {"no modulus",
     "    bulk_modulus: 40 GPa\n    shear_modulus: 24 GPa\n",
     "",
     {"deck.yaml:9", "none of the moduli"}},
    {"poisson ratio",
     "shear_modulus: 24 GPa",
     "poisson_ratio: 0.5",
     {"deck.yaml:12", "poisson_ratio", "in (-1, 0.5)"}},
    {"unsound moduli",
     "shear_modulus: 24 GPa",
     "young_modulus: 400 GPa",
     {"deck.yaml:12: materials.glass.young_modulus", "G > 0"}},
    {"unsound shear",
     "bulk_modulus: 40 GPa",
     "young_modulus: 80 GPa",
     {"materials.glass.young_modulus", "K > 0"}},
    {"bond-based poisson ratio",
     "    density:",
     "    model: bond_based\n    plane: stress\n    density:",
     {"deck.yaml:10: materials.glass.model", "nu = 0.25", "nu = 1/3 in plane stress", "lps"}},
    {"two horizons",
     "    density:",
     "    horizon_ratio: 3\n    horizon: 0.6 mm\n    density:",
     {"deck.yaml:11: materials.glass.horizon", "horizon beside horizon_ratio", "only one of"}},
    {"horizon without length", "    density:", "    horizon: 3 1/s\n    density:", {"deck.yaml:10", "in m"}},
    {"stretch and energy",
     "    density:",
     "    critical_stretch: 0.1\n    fracture_energy: 50\n    density:",
     {"deck.yaml:11: materials.glass.fracture_energy", "beside critical_stretch", "only one of"}},
    {"no fracture energy",
     "    density:",
     "    fracture_energy: 0\n    density:",
     {"deck.yaml:10: materials.glass.fracture_energy", "> 0 in J/m^2"}},
    {"formula of nothing",
     "    density:",
     "    critical_stretch_formula: peridem\n    density:",
     {"deck.yaml:10: materials.glass.critical_stretch_formula", "without fracture_energy"}},
    {"constants of springs",
     "    density:",
     "    model: bond_based\n    constants: plane\n    density:",
     {"deck.yaml:11: materials.glass.constants", "does not apply to bond_based", "lps, peridem"}},
    {"mistyped model",
     "    density:",
     "    model: peridm\n    density:",
     {"deck.yaml:10: materials.glass.model", "did you mean peridem?"}},
    {"mistyped direction",
     "    density:",
     "    breaks_in: tensoin\n    density:",
     {"deck.yaml:10: materials.glass.breaks_in", "did you mean tension?"}},
    // shapes
    {"missing radius", "    radius: 1 mm\n", "", {"deck.yaml:14: shapes.disk", "no radius"}},
    {"key of another type",
     "    radius: 1 mm",
     "    radius: 1 mm\n    sides: 6",
     {"deck.yaml:18: shapes.disk.sides", "does not apply to disk", "regular_polygon"}},
    {"solid in the plane",
     "type: disk",
     "type: sphere",
     {"deck.yaml:15: shapes.disk.type", "sphere", "one of disk", "2D"}},
    {"rings in a square",
     "type: disk\n    filling: rings\n    radius: 1 mm",
     "type: rectangle\n    filling: rings\n    size: [1 mm, 1 mm]",
     {"deck.yaml:16: shapes.disk.filling", "rings", "lattice or mesh"}},
    {"two corners",
     "type: disk\n    filling: rings\n    radius: 1 mm",
     "type: polygon\n    vertices: [[0, 0], [1 mm, 0]]",
     {"deck.yaml:16: shapes.disk.vertices", "2 points", "at least 3"}},
    {"flat polygon",
     "type: disk\n    filling: rings\n    radius: 1 mm",
     "type: polygon\n    vertices: [[0, 0], [1 mm, 0], [2 mm, 0]]",
     {"shapes.disk.vertices", "area 0"}},
    {"corner in 3D",
     "type: disk\n    filling: rings\n    radius: 1 mm",
     "type: polygon\n    vertices: [[0, 0], [1, 0, 0], [1, 1]]",
     {"shapes.disk.vertices.1", "a list of 3", "a list of 2"}},
    {"coarse spacing",
     "    spacing: 0.1 mm",
     "    spacing: 3 mm",
     {"deck.yaml:18: shapes.disk.spacing", "0.003", "width"}},
    {"mesh file",
     "type: disk\n    filling: rings\n    radius: 1 mm\n    spacing: 0.1 mm",
     "type: mesh\n    file: none.msh",
     {"deck.yaml:16: shapes.disk.file", "'none.msh'", "an existing file"}},
    // grid and walls
    {"periodic extent",
     "extent: [10 mm, 8 mm]\n  spacing: 0.2 mm\n  periodic: []",
     "extent: [10.1 mm, 8 mm]\n  spacing: 0.2 mm\n  periodic: [x]",
     {"deck.yaml:21: grid.extent", "50.5 cells along x", "whole number"}},
    {"axis", "periodic: []", "periodic: [z]", {"deck.yaml:23: grid.periodic.0", "'z'", "one of x, y"}},
    {"wall on a periodic axis",
     "periodic: []",
     "periodic: [y]",
     {"deck.yaml:25: walls.0", "a wall across y, which is periodic"}},
    {"side in 3D", "side: y-", "side: z-", {"deck.yaml:25: walls.0.side", "'z-'", "2D"}},
    {"unknown side", "side: y-", "side: y", {"deck.yaml:25: walls.0.side", "'y'", "x-, x+, y-, y+"}},
    {"wall inside out",
     "{side: y-,",
     "{name: floor, point: [0, 0], normal: [0, -1],",
     {"deck.yaml:25: walls.0.normal", "behind it", "points to the grains"}},
    {"wall without normal",
     "{side: y-,",
     "{name: floor, point: [0, 0],",
     {"deck.yaml:25: walls.0", "no normal"}},
    {"normal of length 0",
     "{side: y-,",
     "{name: floor, point: [0, 0], normal: [0, 0],",
     {"walls.0.normal", "length 0"}},
    {"side and plane",
     "{side: y-,",
     "{side: y-, normal: [0, 1],",
     {"deck.yaml:25: walls.0", "either side, or name"}},
    {"wall twice",
     "walls:",
     "walls:\n  - {side: y-}",
     {"deck.yaml:26: walls.1.name", "wall y- a second time"}},
    {"wall in space",
     "side: y-, friction: 0.3",
     "side: y-, velocity: [x, 0]",
     {"walls.0.velocity.0", "depends on x", "a formula of t"}},
    {"too many cells",
     "  spacing: 0.2 mm",
     "  spacing: 1e-12",
     {"deck.yaml:22: grid.spacing", "cells along x"}},
    // grains
    {"unknown shape",
     "{shape: disk, material: glass, position: [2",
     "{shape: disc, material: glass, position: [2",
     {"deck.yaml:31: grains.0.shape", "unknown shape 'disc'", "one of disk", "did you mean disk?"}},
    {"unknown material",
     "material: glass, position: [5",
     "material: glas, position: [5",
     {"deck.yaml:32: grains.1.material", "unknown material 'glas'", "did you mean glass?"}},
    {"outside",
     "[5 mm, 2 mm]",
     "[5 mm, 9 mm]",
     {"deck.yaml:32: grains.1.position", "grain 1 at [0.005, 0.009]", "inside the grid box",
      "y in [0, 0.008]"}},
    {"behind a wall",
     "{side: y-,",
     "{name: floor, point: [0, 3 mm], normal: [0, 1],",
     {"deck.yaml:31: grains.0.position", "behind wall floor"}},
    {"no position",
     ", position: [2 mm, 2 mm]",
     "",
     {"deck.yaml:31: grains.0", "exactly one of position, file, array"}},
    {"no shape",
     "{shape: disk, material: glass, position: [2",
     "{material: glass, position: [2",
     {"deck.yaml:31: grains.0", "no shape"}},
    {"zero scale", "position: [5", "scale: 0, position: [5", {"deck.yaml:32: grains.1.scale", "> 0"}},
    {"no grains",
     "grains:\n  - {shape: disk, material: glass, position: [2 mm, 2 mm]}\n  - {shape: disk, material: "
     "glass, position: [5 mm, 2 mm]}",
     "grains: []",
     {"deck.yaml:30: grains", "an empty list"}},
    {"angle as a length",
     "position: [5",
     "angle: 3 m, position: [5",
     {"grains.1.angle", "a quantity in rad"}},
    {"grain file",
     "position: [2 mm, 2 mm]",
     "file: none.csv",
     {"deck.yaml:31: grains.0.file", "none.csv", "an existing file"}},
    {"array counts",
     "position: [2 mm, 2 mm]",
     "array: {counts: [2, 0], origin: [0, 0], step: [1, 1]}",
     {"grains.0.array.counts.1", "'0'", ">= 1"}},
    {"array scale",
     "position: [2 mm, 2 mm]",
     "array: {counts: [1, 1], origin: [0, 0], step: [1, 1], scale: [2, 1]}",
     {"grains.0.array.scale", "[2, 1]", "least first"}},
    {"array jitter",
     "position: [2 mm, 2 mm]",
     "array: {counts: [1, 1], origin: [0, 0], step: [1, 1], jitter: 0.7}",
     {"grains.0.array.jitter", "in [0, 0.5]"}},
    // contact, loads, constraints, output
    {"pair of materials",
     "between: [glass, glass]",
     "between: [glass, steel]",
     {"deck.yaml:29: contact.pairs.0.between", "unknown material 'steel'"}},
    {"pair of one",
     "between: [glass, glass]",
     "between: [glass]",
     {"contact.pairs.0.between", "a list of 1", "a list of 2 names"}},
    {"pair twice",
     "pairs: [{",
     "pairs: [{between: [glass, glass], friction: 1}, {",
     {"contact.pairs.1.between", "second time"}},
    {"pair without anything",
     "pairs: [{",
     "pairs: [{between: [glass, glass]}, {",
     {"contact.pairs.0", "nothing for the pair", "friction"}},
    {"pair with two radii",
     "pairs: [{",
     "pairs: [{between: [glass, glass], contact_radius: 1 mm, radius_factor: 0.9}, {",
     {"contact.pairs.0", "contact_radius and radius_factor", "one of them"}},
    {"unknown contact method",
     "  rule: pair",
     "  method: node_pairs",
     {"contact.method", "did you mean node_pair?"}},
    {"stiffness of the wrong dimension",
     "  rule: pair",
     "  node_pair: {stiffness: 1 Pa}",
     {"contact.node_pair.stiffness", "a quantity in Pa", "N/m^6"}},
    {"no stiffness",
     "  rule: pair",
     "  node_pair: {stiffness: consistant}",
     {"contact.node_pair.stiffness", "did you mean consistent?"}},
    {"restitution above 1",
     "  rule: pair",
     "  node_pair: {restitution: 1.1}",
     {"contact.node_pair.restitution", "in (0, 1]"}},
    {"no dashpots",
     "  rule: pair",
     "  node_pair: {damping: centre}",
     {"contact.node_pair.damping", "did you mean centres?"}},
    {"negative skin", "  rule: pair", "  node_pair: {skin: -1}", {"contact.node_pair.skin", "in [0, 10]"}},
    {"unknown key of node pairs",
     "  rule: pair",
     "  node_pair: {radios: surface}",
     {"contact.node_pair.radios", "did you mean radius?"}},
    {"wall that is no flag",
     "position: [2 mm, 2 mm]",
     "wall: 2, position: [2 mm, 2 mm]",
     {"grains.0.wall", "true or false"}},
    {"flip with contacts at particles",
     "  rule: pair",
     "  rule: surface\n  coupling: flip",
     {"deck.yaml:28: contact.coupling", "flip with rule surface", "impulse"}},
    {"exact walls on nodes",
     "  rule: pair",
     "  rule: seed\n  walls: exact",
     {"deck.yaml:28: contact.walls", "exact walls with rule seed", "rule or tile"}},
    {"exact walls with flip",
     "  rule: pair",
     "  coupling: flip\n  walls: exact",
     {"contact.walls", "exact walls with coupling flip"}},
    {"load of nothing",
     "",
     "loads: [{grains: all}]\n",
     {"deck.yaml:35: loads.0", "neither", "acceleration, force_density"}},
    {"load twice", "", "loads: [{acceleration: [0, 1], force_density: [0, 1]}]\n", {"loads.0", "both"}},
    {"grain number",
     "",
     "loads: [{grains: [2], acceleration: [0, 1]}]\n",
     {"deck.yaml:35: loads.0.grains", "grain 2", "0 to 1"}},
    {"empty list of grains",
     "",
     "loads: [{grains: [], acceleration: [0, 1]}]\n",
     {"loads.0.grains", "an empty list"}},
    {"formula",
     "",
     "loads: [{acceleration: [0, 'sin(t']}]\n",
     {"deck.yaml:35: loads.0.acceleration.1", "'sin(t'", "a formula of x, y, z, t"}},
    {"name in a formula",
     "",
     "loads: [{acceleration: [0, speed*t]}]\n",
     {"unknown name 'speed'", "a parameter is written ${speed}"}},
    {"function in a formula",
     "",
     "loads: [{acceleration: [0, sqr(t)]}]\n",
     {"loads.0.acceleration.1", "unknown function 'sqr'", "did you mean sqrt?"}},
    {"assignment", "", "loads: [{acceleration: [0, 't = 1']}]\n", {"'t = 1'", "assignment"}},
    {"two values", "", "loads: [{acceleration: [0, '1 + t, 2']}]\n", {"'1 + t, 2'", "more than one value"}},
    {"division by zero", "", "loads: [{acceleration: [0, 1/0]}]\n", {"'1/0'", "finite"}},
    {"unit in a load",
     "",
     "loads: [{acceleration: [0, 1 m/s]}]\n",
     {"loads.0.acceleration.1", "a quantity in m/s^2"}},
    {"region in time",
     "",
     "loads: [{region: x*t, acceleration: [0, 1]}]\n",
     {"loads.0.region", "depends on t", "a formula of x, y, z"}},
    {"constraint that holds nothing",
     "",
     "constraints: [{velocity: [free, free]}]\n",
     {"constraints.0.velocity", "free on every axis"}},
    {"track", "  interval: 10 us", "  track: [7]", {"deck.yaml:34: output.track", "grain 7", "0 to 1"}},
    {"output interval",
     "  interval: 10 us",
     "  interval: 0",
     {"deck.yaml:34: output.interval", "> 0 in s or auto"}},
    // parameters
    {"unknown parameter",
     "  friction: 0.1",
     "  friction: ${nu}",
     {"deck.yaml:28: contact.friction", "unknown parameter 'nu'", "did you mean mu?"}},
    {"parameter without brace", "  friction: 0.1", "  friction: ${mu", {"deck.yaml:28", "'}' after '${'"}},
    {"circle",
     "speed: 2 m/s",
     "speed: ${mu}, a: ${b}, b: ${c + 1}, c: ${a}",
     {"deck.yaml:3: params.a", "a -> b -> c -> a"}},
    {"word in arithmetic",
     "  friction: 0.1",
     "  friction: ${2*word}",
     {"deck.yaml:28", "parameter word = 'pair'", "a number"}},
    {"word for a number",
     "  friction: 0.1",
     "  friction: ${word}",
     {"deck.yaml:28", "'pair'", "a number >= 0"}},
    {"reserved parameter", "speed: 2 m/s", "t: 2", {"deck.yaml:3: params.t", "formulas do not use"}},
    {"function as a parameter", "speed: 2 m/s", "sin: 2", {"params.sin", "formulas do not use"}},
    {"parameter name", "speed: 2 m/s", "top-speed: 2", {"params.top-speed", "letters, digits and _"}},
    {"list as a parameter", "speed: 2 m/s", "speed: [2]", {"params.speed", "a list"}},
    {"unit twice",
     "  friction: 0.1",
     "  friction: ${speed} m",
     {"deck.yaml:28", "'${speed} m'", "speed has a unit already"}},
    {"dimension of a parameter",
     "  friction: 0.1",
     "  friction: ${speed}",
     {"deck.yaml:28", "a quantity in m/s", "without unit"}},
    {"division by zero in a parameter",
     "  friction: 0.1",
     "  friction: ${1/0}",
     {"deck.yaml:28", "'1/0' = inf", "finite"}},
    {"formula of a parameter",
     "  friction: 0.1",
     "  friction: ${mu +}",
     {"deck.yaml:28", "'mu +'", "a formula"}},
    {"unit of a parameter",
     "speed: 2 m/s",
     "speed: 2 m/sec",
     {"deck.yaml:3: params.speed", "'2 m/sec'", "unknown unit"}},
    {"range of a parameter",
     "  friction: 0.1",
     "  friction: ${-mu}",
     {"deck.yaml:28", "'${-mu}' = -0.3", ">= 0"}},
};

std::string message_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        read_text(text, overrides);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("Deck: each bad input is named by line, key, what was got and what is expected") {
    REQUIRE_NOTHROW(read_text(plain_deck));
    for (const BadInput& bad : bad_inputs) {
        CAPTURE(bad.what);
        const std::string from = bad.from;
        const std::string deck = from.empty() ? plain_deck + bad.to : replaced(plain_deck, from, bad.to);
        const std::string message = message_of(deck);
        CAPTURE(message);
        if (bad.parts.empty()) CHECK(message == "no error");
        for (const std::string& part : bad.parts) {
            CAPTURE(part);
            CHECK(message.find(part) != std::string::npos);
        }
        CHECK(message.find('\n') == std::string::npos);
    }
}

TEST_CASE("Deck: bad input in 3D is named in the same way") {
    const BadInput inputs[] = {
        {"plane", "model: bond_based", "plane: stress", {"materials.glass.plane", "does not apply in 3D"}},
        {"disk",
         "type: sphere",
         "type: disk",
         {"shapes.ball.type", "disk", "one of sphere, box, mesh", "the deck is 3D"}},
        {"short vector",
         "gravity: [${9.8*sin(theta)}, 0, ",
         "gravity: [0, ",
         {"gravity", "a list of 2", "a list of 3 numbers"}},
        {"turn",
         "angle: [0, 0, 90 deg]",
         "angle: 90 deg",
         {"grains.0.angle", "'90 deg'", "a list of 3 numbers in rad"}},
        {"poisson ratio",
         "poisson_ratio: 0.25",
         "poisson_ratio: 0.3",
         {"materials.glass.model", "nu = 0.3", "nu = 1/4 in 3D"}},
        {"file without z",
         "position: [0, 0.5, 0]",
         "file: here.csv",
         {"here.csv:1", "no column z", "x, y and z"}},
        {"formula",
         "[x*y*z*t, 0, 0]",
         "[x*y*z*t, 0, ~]",
         {"loads.1.acceleration.2", "nothing", "a formula of x, y, z, t in m/s^2"}},
        {"rings in a box",
         "type: box",
         "type: box, filling: rings",
         {"shapes.brick.filling", "rings fill disks and spheres"}},
        {"wall inside out",
         "normal: [0, 3, 4]",
         "normal: [0, -3, 0]",
         {"grains.0.position", "behind wall slope"}},
        {"word in a formula",
         "-${speed}*${ramp}",
         "-${speed}*${word}",
         {"walls.0.velocity.1", "unknown name 'seed'"}},
    };
    const TempFolder folder;
    folder.write("here.csv", "x,y\n0,0\n");
    for (const BadInput& bad : inputs) {
        CAPTURE(bad.what);
        std::string message = "no error";
        try {
            read_deck(folder.write("deck.yaml", replaced(full_deck, bad.from, bad.to)));
        } catch (const InputError& error) {
            message = error.what();
        }
        CAPTURE(message);
        for (const std::string& part : bad.parts) CHECK(message.find(part) != std::string::npos);
    }
}

TEST_CASE("Deck: a bad override is named by its key") {
    struct BadOverride {
        std::string text;
        std::vector<std::string> parts;
    };
    const BadOverride overrides[] = {
        {"friction", {"--set", "'friction'", "key=value"}},
        {"=3", {"--set", "key=value"}},
        {"params.mew=3", {"--set: params.mew", "unknown name 'mew'", "speed, mu", "did you mean mu?"}},
        {"materials.glas.density=3", {"--set: materials.glas.density", "'glas'", "did you mean glass?"}},
        {"materials.glass.densty=3",
         {"--set: materials.glass.densty", "unknown key", "did you mean density?"}},
        {"grains.2.scale=3", {"--set: grains.2.scale", "'2'", "a number from 0 to 1"}},
        {"output.chekpoint.every=3", {"--set: output.chekpoint", "unknown key", "did you mean checkpoint?"}},
        {"title.x=3", {"--set: title.x", "'x'"}},
        {"contact.friction=-1", {"--set: contact.friction", "'-1'", ">= 0"}},
        {"time.end=5 m", {"--set: time.end", "a quantity in s"}},
        {"contact.pairs=[", {"--set: contact.pairs", "not YAML"}},
    };
    for (const BadOverride& bad : overrides) {
        CAPTURE(bad.text);
        const std::string message = message_of(plain_deck, {bad.text});
        CAPTURE(message);
        for (const std::string& part : bad.parts) CHECK(message.find(part) != std::string::npos);
    }
}

TEST_CASE("Deck: a file that is no deck is named") {
    const TempFolder folder;
    const auto message = [](const std::string& file) {
        try {
            read_deck(file);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const std::string missing = folder.write("x", "") + ".yaml";
    CHECK(message(missing).find(missing + ": got no such file") == 0);
    CHECK(message(folder.write("empty.yaml", "")).find("expected a deck") != std::string::npos);
    CHECK(message(folder.write("list.yaml", "- 1\n- 2\n")).find("got a list") != std::string::npos);
    CHECK(message(std::filesystem::temp_directory_path().string()).find("got a folder") != std::string::npos);
}

TEST_CASE("Deck: each bad cell of a grain file is named by line and column") {
    struct BadFile {
        std::string text;
        std::vector<std::string> parts;
    };
    const BadFile files[] = {
        {"x,y,radios\n", {"grains.csv:1", "unknown column 'radios'", "did you mean radius?"}},
        {"x,y,z\n", {"grains.csv:1", "unknown column 'z'"}},
        {"x,scale\n", {"grains.csv:1", "no column y"}},
        {"x,y,x\n", {"grains.csv:1", "column x a second time"}},
        {"x,y,scale,radius\n", {"grains.csv:1", "scale and radius"}},
        {"x,y\n", {"grains.csv", "no rows"}},
        {"", {"grains.csv", "no rows"}},
        {"x,y\n1e-3,2e-3\n1e-3,two\n", {"grains.csv:3: column 2 (y)", "'two'", "a number in SI units"}},
        {"x,y\n1e-3,\n", {"grains.csv:2: column 2 (y)", "''", "a number"}},
        {"x,y\n1 mm,2\n", {"grains.csv:2: column 1 (x)", "'1 mm'", "SI"}},
        {"x,y\n1e-3\n", {"grains.csv:2", "1 cells", "2 cells"}},
        {"# a comment\n\nx,y\n1e-3,2e-3,3\n", {"grains.csv:4", "3 cells"}},
        {"x,y,radius\n1e-3,2e-3,-1\n", {"grains.csv:2: column 3 (radius)", "> 0"}},
        {"x,y,material\n1e-3,2e-3,glas\n", {"grains.csv:2: material", "did you mean glass?"}},
        {"x,y,shape\n1e-3,2e-3,\n", {"grains.csv:2: column 3 (shape)", "nothing", "a name"}},
        {"x,y\n1,2e-3\n", {"grains.csv:2: position", "grain 0", "inside the grid box"}},
    };
    for (const BadFile& bad : files) {
        CAPTURE(bad.text);
        const TempFolder folder;
        folder.write("grains.csv", bad.text);
        std::string message = "no error";
        try {
            read_deck(folder.write("deck.yaml",
                                   replaced(plain_deck, "position: [2 mm, 2 mm]", "file: grains.csv")));
        } catch (const InputError& error) {
            message = error.what();
        }
        CAPTURE(message);
        for (const std::string& part : bad.parts) CHECK(message.find(part) != std::string::npos);
    }
}
