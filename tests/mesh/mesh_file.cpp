#include "src/mesh/mesh_file.hpp"

#include <doctest/doctest.h>
#include <gmsh.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "grid/error.hpp"
#include "particles/shape_checks.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/make_shape.hpp"

using namespace quern;
using std::numbers::pi;

namespace {

/// A folder of this test's own, removed at its end.
struct Folder {
    std::filesystem::path path;
    explicit Folder(const std::string& name)
        : path(std::filesystem::temp_directory_path() / ("quern_" + name)) {
        std::filesystem::remove_all(path);
        std::filesystem::create_directories(path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string file(const std::string& name) const { return (path / name).string(); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(file(name)) << text;
        return file(name);
    }
};

template <int Dim>
Shape<Dim> shape_of(const std::string& path, double unit = 1.0) {
    ShapeDeck deck;
    deck.name = "stone";
    deck.kind = ShapeKind::mesh;
    deck.file = path;
    deck.unit = unit;
    deck.place = {"run.yaml", 3, "shapes.stone"};
    return make_shape<Dim>(deck);
}

template <int Dim>
std::string message_of(const std::string& path) {
    try {
        shape_of<Dim>(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) {
    CAPTURE(text);
    CAPTURE(part);
    const bool found = text.find(part) != std::string::npos;
    CHECK(found);
    return found;
}

/// A mesh of version 2.2 from lines of nodes ("x y z") and elements ("type nodes...").
std::string mesh_text(const std::vector<std::string>& nodes, const std::vector<std::string>& elements) {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(nodes.size()) + "\n";
    for (std::size_t i = 0; i < nodes.size(); ++i) text += std::to_string(i + 1) + " " + nodes[i] + "\n";
    text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const std::size_t space = elements[i].find(' ');
        text += std::to_string(i + 11) + " " + elements[i].substr(0, space) + " 2 0 1" +
                elements[i].substr(space) + "\n";
    }
    return text + "$EndElements\n";
}

/// Unit square of 2 x 2 quadrangles as one quadrangle and six triangles, elements 11 to 17.
const std::vector<std::string> square_nodes{"0 0 0",   "0.5 0 0", "1 0 0",   "0 0.5 0", "0.5 0.5 0",
                                            "1 0.5 0", "0 1 0",   "0.5 1 0", "1 1 0"};
const std::vector<std::string> square_elements{"3 1 2 5 4", "2 2 3 6", "2 2 6 5", "2 4 5 8",
                                               "2 4 8 7",   "2 5 6 9", "2 5 9 8"};

enum class Body { disk, quadrangles, ball, hexahedra };

/// Writes a body by gmsh itself.
void write_by_gmsh(Body body, const std::string& path, double version, bool binary) {
    GmshSession session;
    session.set("Mesh.MeshSizeMax", 0.3);
    session.set("Mesh.MshFileVersion", version);
    session.set("Mesh.Binary", binary);
    int dim = 3;
    if (body == Body::disk) {
        dim = 2;
        gmsh::model::occ::addDisk(5, 5, 1, 1, 1);
    } else if (body == Body::quadrangles) {
        dim = 2;
        session.set("Mesh.RecombineAll", 1);
        gmsh::model::occ::addDisk(5, 5, 1, 1, 1);
    } else if (body == Body::ball) {
        gmsh::model::occ::addSphere(5, 5, 5, 1);
    } else {
        const int square = gmsh::model::occ::addRectangle(0, 0, 0, 2, 1);
        gmsh::vectorpair out;
        session.set("Mesh.RecombineAll", 1);
        gmsh::model::occ::extrude({{2, square}}, 0, 0, 1, out, {4}, {}, true);
    }
    gmsh::model::occ::synchronize();
    gmsh::model::mesh::generate(dim);
    gmsh::write(path);
}

}  // namespace

TEST_CASE("Mesh file: versions 2.2 and 4.1, ASCII and binary, give the same shape") {
    const Folder folder("formats");
    for (const Body body : {Body::disk, Body::quadrangles, Body::ball, Body::hexahedra}) {
        const auto read = [&](double version, bool binary, auto dim) {
            const std::string path = folder.file("body.msh");
            write_by_gmsh(body, path, version, binary);
            return shape_of<decltype(dim)::value>(path, 1e-3);
        };
        const auto compare = [&](auto dim, double measure) {
            const auto first = read(4.1, false, dim);
            CHECK(total_volume(first) == doctest::Approx(measure).epsilon(0.12));
            for (const auto& [version, binary] : {std::pair(4.1, true), {2.2, false}, {2.2, true}}) {
                const auto other = read(version, binary, dim);
                REQUIRE(other.n_nodes() == first.n_nodes());
                CHECK(other.surface.size() == first.surface.size());
                for (int i = 0; i < first.n_nodes(); ++i) {
                    CHECK((other.X[i] - first.X[i]).norm() < 1e-15);
                    CHECK(other.volume[i] == doctest::Approx(first.volume[i]).epsilon(1e-10));
                }
            }
        };
        if (body == Body::disk || body == Body::quadrangles)
            compare(std::integral_constant<int, 2>(), pi * 1e-6);
        else
            compare(std::integral_constant<int, 3>(), body == Body::ball ? 4 * pi / 3 * 1e-9 : 2e-9);
    }
}

TEST_CASE("Mesh file: volumes are lumped, loose nodes dropped, lines and points passed over") {
    const Folder folder("lumping");
    std::vector<std::string> nodes = square_nodes, elements = square_elements;
    nodes.insert(nodes.begin() + 4, "7 7 0");  // no element uses it
    for (std::string& element : elements) {
        std::string shifted;
        for (std::size_t i = 0; i < element.size(); ++i)
            shifted += i > 1 && element[i] >= '5' ? static_cast<char>(element[i] + 1) : element[i];
        for (std::size_t at; (at = shifted.find(':')) != std::string::npos;) shifted.replace(at, 1, "10");
        element = shifted;
    }
    elements.push_back("1 1 2");
    elements.push_back("15 5");
    const Shape<2> shape = shape_of<2>(folder.write("square.msh", mesh_text(nodes, elements)), 2.0);
    REQUIRE(shape.n_nodes() == 9);
    CHECK(total_volume(shape) == doctest::Approx(4.0).epsilon(1e-14));
    CHECK(first_moment(shape).norm() < 1e-15);
    // Node 1 has a quarter of the quadrangle (area 1), node 3 a third of a triangle (area 1/2).
    CHECK(shape.volume[0] == doctest::Approx(0.25).epsilon(1e-14));
    CHECK(shape.volume[2] == doctest::Approx(1.0 / 6).epsilon(1e-14));
    CHECK(shape.surface.size() == 8);
    CHECK(shape.cornered);
    CHECK(shape.outline.size() == 8);
    for (const SurfacePoint<2>& p : shape.surface) CHECK(p.node != 4);
}

TEST_CASE("Mesh file: a relative path starts at the deck's folder") {
    const Folder folder("relative");
    folder.write("square.msh", mesh_text(square_nodes, square_elements));
    ShapeDeck deck;
    deck.kind = ShapeKind::mesh;
    deck.file = "square.msh";
    deck.place = {folder.file("run.yaml"), 1, "shapes.s"};
    CHECK(make_shape<2>(deck).n_nodes() == 9);
}

TEST_CASE("Mesh file: flipped, degenerate and overlapping elements are refused by number") {
    const Folder folder("defects");
    const auto message = [&](std::size_t element, const std::string& text) {
        std::vector<std::string> elements = square_elements;
        elements[element] = text;
        return message_of<2>(folder.write("bad.msh", mesh_text(square_nodes, elements)));
    };
    contains(message(1, "2 2 6 3"),
             "run.yaml:3: shapes.stone.file: got flipped element 12 (1 of 7 elements)");
    contains(message(0, "3 1 4 5 2"), "flipped element 11");
    contains(message(0, "3 1 5 2 4"), "flipped element 11");  // a bow tie
    contains(message(1, "2 1 2 3"), "degenerate element 12 (no area)");
    contains(message(1, "2 2 2 6"), "degenerate element 12");
    contains(message(2, "2 2 3 6"), "elements 12 and 13 on the same side of a common edge");
    contains(message(0, "2 1 2 99"), "unreadable");

    std::vector<std::string> mirrored = square_elements;
    for (std::string& e : mirrored) std::swap(e[2], e[6]);
    contains(message_of<2>(folder.write("mirrored.msh", mesh_text(square_nodes, mirrored))),
             "whole mesh is mirrored");

    const std::vector<std::string> cube{"0 0 0", "1 0 0", "1 1 0", "0 1 0",
                                        "0 0 1", "1 0 1", "1 1 1", "0 1 1"};
    CHECK(message_of<3>(folder.write("cube.msh", mesh_text(cube, {"5 1 2 3 4 5 6 7 8"}))).empty());
    contains(message_of<3>(folder.write("cube.msh", mesh_text(cube, {"5 5 6 7 8 1 2 3 4"}))),
             "flipped element 11");
    contains(message_of<3>(folder.write("tet.msh", mesh_text(cube, {"4 1 3 2 5"}))), "flipped element 11");
    contains(message_of<3>(folder.write("tet.msh", mesh_text(cube, {"4 1 2 3 4"}))),
             "degenerate element 11 (no volume)");
}

TEST_CASE("Mesh file: several pieces and pinched boundaries are refused") {
    const Folder folder("pieces");
    const std::vector<std::string> nodes{"0 0 0", "1 0 0", "0 1 0", "5 0 0", "6 0 0", "5 1 0"};
    contains(message_of<2>(folder.write("two.msh", mesh_text(nodes, {"2 1 2 3", "2 4 5 6"}))),
             "2 disconnected pieces");
    // joined at one node only
    contains(message_of<2>(folder.write("pinch.msh", mesh_text(square_nodes, {"3 1 2 5 4", "3 5 6 9 8"}))),
             "2 disconnected pieces");
    // a ring of quadrangles that closes at a node only
    std::vector<std::string> ring{"0 0 0", "1 0 0", "2 0 0", "3 0 0", "0 1 0", "1 1 0", "2 1 0", "3 1 0",
                                  "0 2 0", "1 2 0", "2 2 0", "3 2 0", "0 3 0", "1 3 0", "2 3 0", "3 3 0"};
    contains(message_of<2>(folder.write("ring.msh",
                                        mesh_text(ring, {"3 1 2 6 5", "3 2 3 7 6", "3 3 4 8 7", "3 5 6 10 9",
                                                         "3 9 10 14 13", "3 10 11 15 14", "3 7 8 12 11"}))),
             "touches itself");
}

TEST_CASE("Mesh file: what is no mesh of the deck's dimension is refused") {
    const Folder folder("wrong");
    contains(message_of<2>(folder.file("none.msh")), "no readable file");
    contains(message_of<2>(folder.path.string()), "no readable file");
    contains(message_of<2>(folder.write("a.geo", "Point(1) = {0,0,0};")), "is not a .msh file");
    contains(message_of<2>(folder.write("a.msh", "solid cube\n")), "is not a .msh file");
    contains(message_of<2>(folder.write("empty.msh", "")), "is not a .msh file");
    contains(message_of<2>(folder.write("old.msh", "$MeshFormat\n1.0 0 8\n")), "mesh version '1.0'");
    contains(message_of<2>(folder.write("lines.msh", mesh_text(square_nodes, {"1 1 2"}))),
             "no elements of dimension 2");
    contains(message_of<3>(folder.write("flat.msh", mesh_text(square_nodes, square_elements))),
             "no elements of dimension 3");
    contains(message_of<2>(
                 folder.write("bent.msh", mesh_text({"0 0 0", "1 0 0", "1 1 1", "0 1 0"}, {"3 1 2 3 4"}))),
             "different z");
    const std::vector<std::string> tet{"0 0 0", "1 0 0", "0 1 0", "0 0 1", "0 0 2"};
    contains(message_of<2>(folder.write("tet.msh", mesh_text(tet, {"4 1 2 3 4"}))),
             "three-dimensional elements");
    contains(message_of<3>(folder.write("tet.msh", mesh_text(tet, {"4 1 2 3 4"}))), "got 4 nodes");
    contains(message_of<2>(folder.write(
                 "tri6.msh",
                 mesh_text({"0 0 0", "2 0 0", "0 2 0", "1 0 0", "1 1 0", "0 1 0"}, {"9 1 2 3 4 5 6"}))),
             "elements of type 'Triangle 6'");
    const std::string whole = mesh_text(square_nodes, square_elements);
    CHECK(!message_of<2>(folder.write("cut.msh", whole.substr(0, whole.size() / 2))).empty());
}
