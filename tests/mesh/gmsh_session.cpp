#include "src/mesh/gmsh_session.hpp"

#include <doctest/doctest.h>
#include <gmsh.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "grid/error.hpp"
#include "src/mesh/generate_mesh.hpp"
#include "src/mesh/mesh_file.hpp"

using namespace quern;

namespace {

/// All that the process writes to stdout and stderr while `work` runs.
template <class Work>
std::string printed_during(Work work) {
    const std::string path = (std::filesystem::temp_directory_path() / "quern_printed.txt").string();
    std::fflush(nullptr);
    const int out = dup(1), err = dup(2);
    std::FILE* file = std::fopen(path.c_str(), "w");
    dup2(fileno(file), 1);
    dup2(fileno(file), 2);
    work();
    std::fflush(nullptr);
    dup2(out, 1);
    dup2(err, 2);
    close(out);
    close(err);
    std::fclose(file);
    std::ifstream in(path);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(path);
    return text;
}

}  // namespace

TEST_CASE("gmsh: nothing is printed, not even about a broken file") {
    const std::string broken = (std::filesystem::temp_directory_path() / "quern_broken.msh").string();
    std::ofstream(broken) << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 2 3\n";
    const std::string text = printed_during([&] {
        generate_mesh(Ball<2>(1.0), 0.3);
        generate_mesh(Cuboid({1, 1, 1}), 0.5);
        try {
            read_mesh_file<2>(broken, 1.0, "here");
        } catch (const InputError&) {
        }
    });
    std::filesystem::remove(broken);
    CHECK(text == "");
}

TEST_CASE("gmsh: a session gives back the caller's model and options") {
    { const GmshSession initialises; }
    gmsh::model::add("mine");
    gmsh::option::setNumber("Mesh.MeshSizeMax", 0.123);
    std::string before, after;
    gmsh::model::getCurrent(before);
    generate_mesh(Ball<2>(1.0), 0.3);
    gmsh::model::getCurrent(after);
    double size = 0.0;
    gmsh::option::getNumber("Mesh.MeshSizeMax", size);
    CHECK(before == after);
    CHECK(size == 0.123);
    gmsh::model::remove();
    gmsh::option::setNumber("Mesh.MeshSizeMax", 1e22);
}

TEST_CASE("gmsh: sessions of several threads wait for each other and give the same mesh") {
    std::vector<ElementMesh<2>> meshes(4);
    std::vector<std::thread> threads;
    for (ElementMesh<2>& mesh : meshes)
        threads.emplace_back([&mesh] { mesh = generate_mesh(Ball<2>(1.0), 0.2); });
    for (std::thread& thread : threads) thread.join();
    for (const ElementMesh<2>& mesh : meshes) CHECK(mesh.X == meshes[0].X);
}

TEST_CASE("gmsh: the caller may finalise and initialise it in between") {
    const ElementMesh<2> first = generate_mesh(Ball<2>(1.0), 0.2);
    gmsh::finalize();
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    CHECK(generate_mesh(Ball<2>(1.0), 0.2).X == first.X);
    gmsh::finalize();
    CHECK(generate_mesh(Ball<2>(1.0), 0.2).X == first.X);
}
