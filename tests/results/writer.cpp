#include "src/results/writer.hpp"

#include <doctest/doctest.h>
#include <hdf5.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "grid/error.hpp"
#include "src/results/frame_file.hpp"
#include "tests/results/samples.hpp"

using namespace quern;

namespace {

std::string message_of(const auto& action) {
    try {
        action();
    } catch (const OutputError& error) {
        return error.what();
    }
    return "no OutputError";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

void write_run(const std::string& directory, int dimension, int n_frames) {
    ResultWriter writer({.directory = directory, .dimension = dimension});
    for (int i = 0; i < n_frames; ++i) writer.add_frame(make_sample_frame(dimension, i));
    writer.finish({});
}

/// Succeeds if Python reads the file with the expression; skipped silently where there is no python3.
bool python_accepts(const std::string& expression, const std::string& file) {
    if (std::system("command -v python3 > /dev/null 2>&1") != 0) return true;
    return std::system(("python3 -c '" + expression + "' '" + file + "'").c_str()) == 0;
}

}  // namespace

TEST_CASE("FrameFileWriter: frames are read back bit by bit") {
    for (const int dimension : {2, 3}) {
        const ScratchDirectory scratch;
        const std::string path = scratch.path("results.h5");
        std::vector<double> domain(2 * static_cast<std::size_t>(dimension), 1.5);
        FrameFileWriter writer(path, dimension, "title \u00e4", domain);
        for (int i = 0; i < 3; ++i) writer.add(make_sample_frame(dimension, i));
        writer.close();

        const FrameFileReader reader(path);
        REQUIRE(reader.n_frames() == 3);
        CHECK(reader.dimension() == dimension);
        CHECK(reader.title() == "title \u00e4");
        CHECK(reader.domain() == domain);
        for (int i = 0; i < 3; ++i) {
            const Frame wrote = make_sample_frame(dimension, i),
                        read = reader.read(static_cast<std::size_t>(i));
            CHECK(read.dimension == dimension);
            CHECK(read.step == wrote.step);
            CHECK(read.time == wrote.time);
            CHECK(read.position == wrote.position);
            CHECK(read.velocity == wrote.velocity);
            CHECK(read.damage == wrote.damage);
            CHECK(read.damage_z == wrote.damage_z);
            CHECK(read.fragment == wrote.fragment);
            CHECK(read.damage_z.empty() == (dimension == 2));
            CHECK(read.plastic_strain == wrote.plastic_strain);
            CHECK(read.plastic_strain.empty() == (dimension == 2));
            CHECK(read.stress == wrote.stress);
            CHECK(read.grain == wrote.grain);
            CHECK(read.volume == wrote.volume);
        }
    }
}

TEST_CASE("FrameFileWriter: datasets are chunked, compressed, extendible and carry their unit") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 2);
    const hid_t file = H5Fopen(scratch.path("run/results.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    REQUIRE(file >= 0);
    const hid_t dataset = H5Dopen2(file, "/stress", H5P_DEFAULT), space = H5Dget_space(dataset);
    hsize_t shape[3] = {}, limit[3] = {}, chunk[3] = {};
    CHECK(H5Sget_simple_extent_dims(space, shape, limit) == 3);
    CHECK((shape[0] == 2 && shape[1] == 200 && shape[2] == 4));
    CHECK(limit[0] == H5S_UNLIMITED);
    const hid_t stored = H5Dget_type(dataset);
    CHECK(H5Tget_size(stored) == 4);
    hid_t properties = H5Dget_create_plist(dataset);
    REQUIRE(H5Pget_chunk(properties, 3, chunk) == 3);
    CHECK((chunk[0] == 1 && chunk[1] == 200 && chunk[2] == 4));
    CHECK(H5Pget_nfilters(properties) == 0);
    H5Pclose(properties);
    const hid_t damage = H5Dopen2(file, "/damage", H5P_DEFAULT);
    properties = H5Dget_create_plist(damage);
    CHECK(H5Pget_filter_by_id2(properties, H5Z_FILTER_DEFLATE, nullptr, nullptr, nullptr, 0, nullptr,
                               nullptr) >= 0);
    CHECK(H5Pget_filter_by_id2(properties, H5Z_FILTER_SHUFFLE, nullptr, nullptr, nullptr, 0, nullptr,
                               nullptr) >= 0);
    const hid_t attribute = H5Aopen(dataset, "units", H5P_DEFAULT), type = H5Aget_type(attribute);
    char* unit = nullptr;
    REQUIRE(H5Aread(attribute, type, &unit) >= 0);
    CHECK(std::string(unit) == "Pa");
    H5free_memory(unit);
    H5Tclose(type), H5Tclose(stored), H5Aclose(attribute), H5Pclose(properties), H5Sclose(space),
        H5Dclose(damage), H5Dclose(dataset), H5Fclose(file);
}

TEST_CASE("ResultWriter: a run that dies leaves files that can be read") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run"), .dimension = 2});
    CHECK_THROWS_AS(FrameFileReader(scratch.path("run/results.h5")), InputError);  // no frame yet
    for (int i = 0; i < 3; ++i) writer.add_frame(make_sample_frame(2, i));
    writer.flush();
    // As another process would find them now.
    std::filesystem::copy_file(scratch.path("run/results.h5"), scratch.path("copy.h5"));
    CHECK(FrameFileReader(scratch.path("copy.h5")).n_frames() == 3);
    CHECK(python_accepts("import sys, xml.dom.minidom as m; m.parse(sys.argv[1])",
                         scratch.path("run/results.xdmf")));
}

TEST_CASE("FrameFileWriter: a run killed while it writes leaves every finished frame readable") {
    const ScratchDirectory scratch;
    const std::string path = scratch.path("results.h5");
    for (const std::size_t n_finished : {1, 3, 10, 20, 40}) {
        int finished[2];
        REQUIRE(pipe(finished) == 0);
        const pid_t child = fork();
        if (child == 0) {
            FrameFileWriter writer(path, 2, "", {});
            for (int i = 0; i < 80; ++i) {  // frame 84 has the moment that docs/results.md speaks of
                writer.add(make_sample_frame(2, i));
                if (write(finished[1], "", 1) != 1) _exit(1);
            }
            for (;;) pause();
        }
        close(finished[1]);
        char byte;
        for (std::size_t i = 0; i < n_finished; ++i) REQUIRE(read(finished[0], &byte, 1) == 1);
        usleep(static_cast<useconds_t>(137 * n_finished % 1000));  // into the writing of a later frame
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        close(finished[0]);

        const FrameFileReader reader(path);
        CHECK(reader.n_frames() >= n_finished);
        for (std::size_t i = 0; i < reader.n_frames(); ++i) {
            const Frame frame = reader.read(i), wrote = make_sample_frame(2, static_cast<int>(i));
            REQUIRE(frame.step == wrote.step);
            REQUIRE(frame.position == wrote.position);
            REQUIRE(frame.stress == wrote.stress);
        }
    }
}

TEST_CASE("FrameFileWriter: frames that do not fit are refused") {
    const ScratchDirectory scratch;
    FrameFileWriter writer(scratch.path("results.h5"), 2, "", {});
    writer.add(make_sample_frame(2, 0));
    Frame frame = make_sample_frame(2, 1);
    frame.damage.pop_back();
    CHECK_THROWS_AS(writer.add(frame), std::invalid_argument);
    CHECK_THROWS_AS(writer.add(make_sample_frame(3, 1)), std::invalid_argument);
    frame = make_sample_frame(2, 1);
    frame.damage_z.assign(frame.n(), 0.5F);
    CHECK_THROWS_AS(writer.add(frame), std::invalid_argument);
    frame = make_sample_frame(2, 1);
    frame.plastic_strain.assign(frame.n(), 0.5F);
    CHECK_THROWS_AS(writer.add(frame), std::invalid_argument);
    writer.add(make_sample_frame(2, 1));
    writer.close();
    CHECK(FrameFileReader(scratch.path("results.h5")).n_frames() == 2);
}

TEST_CASE("ResultWriter: tables have the documented columns and exact numbers") {
    const ScratchDirectory scratch;
    for (const int dimension : {2, 3}) {
        ResultWriter writer({.directory = scratch.path("run"), .dimension = dimension, .fragments = true});
        HistoryRow history{
            .time = 0.1,
            .energy = {.kinetic = 1.0 / 3.0, .plastic = 3, .residual = -1e-300, .throughput = 2}};
        history.momentum[0] = 4, history.angular_momentum[2] = 5;
        history.broken_bonds = 6, history.fragments = 7, history.debris = 8;
        writer.add_history(history);
        FragmentRow fragment{.time = 0.3,
                             .fragment = 2,
                             .grain = 1,
                             .parent = 1,
                             .born = 0.25,
                             .born_step = 9,
                             .particles = 4,
                             .mass = 5,
                             .damage = 0.5};
        fragment.position[1] = 6, fragment.velocity[0] = 7, fragment.omega[2] = 8, fragment.stress[3] = -9;
        writer.add_fragment(fragment);
        GrainRow grain{.time = 0.2, .grain = 7, .angle = 8, .omega = 9};
        grain.position[1] = 1, grain.velocity[0] = 2, grain.force[2] = 3;
        writer.add_grain(grain);
        ReactionRow reaction{.time = 0.3, .name = "a, \"b\"", .work = 9};
        reaction.position[0] = 1, reaction.displacement[1] = 2, reaction.force[0] = 3, reaction.moment[2] = 4;
        writer.add_reaction(reaction);
        writer.finish({});
        const bool plane = dimension == 2;
        CHECK(read_text(scratch.path("run/history.csv")) ==
              std::string("time,kinetic,elastic,contact_elastic,gravity,damping,friction,contact_loss,"
                          "fracture,plastic,transfer_loss,"
                          "external_work,residual,throughput,") +
                  (plane ? "momentum_x,momentum_y,angular_momentum,broken_bonds,fragments,debris\n"
                         : "momentum_x,momentum_y,momentum_z,angular_momentum_x,angular_momentum_y,"
                           "angular_momentum_z,broken_bonds,fragments,debris\n") +
                  "0.1,0.3333333333333333,0,0,0,0,0,0,0,3,0,0,-1e-300,2," +
                  (plane ? "4,0,5,6,7,8\n" : "4,0,0,0,0,5,6,7,8\n"));
        CHECK(
            read_text(scratch.path("run/fragments.csv")) ==
            (plane
                 ? "time,fragment,grain,parent,born,born_step,particles,mass,x,y,vx,vy,omega,stress_xx,"
                   "stress_yy,stress_xy,stress_zz,damage\n0.3,2,1,1,0.25,9,4,5,0,6,7,0,8,0,0,0,-9,0.5\n"
                 : "time,fragment,grain,parent,born,born_step,particles,mass,x,y,z,vx,vy,vz,omega_x,omega_y,"
                   "omega_z,stress_xx,stress_yy,stress_zz,stress_xy,stress_yz,stress_xz,damage\n"
                   "0.3,2,1,1,0.25,9,4,5,0,6,0,7,0,0,0,0,8,0,0,0,-9,0,0,0.5\n"));
        CHECK(read_text(scratch.path("run/grains.csv")) ==
              (plane ? "time,grain,x,y,vx,vy,angle,omega,fx,fy\n0.2,7,0,1,2,0,8,9,0,0\n"
                     : "time,grain,x,y,z,vx,vy,vz,angle,omega,fx,fy,fz\n0.2,7,0,1,0,2,0,0,8,9,0,0,3\n"));
        CHECK(read_text(scratch.path("run/reactions.csv")) ==
              (plane ? "time,name,x,y,ux,uy,fx,fy,moment,work\n0.3,\"a, \"\"b\"\"\",1,0,0,2,3,0,4,9\n"
                     : "time,name,x,y,z,ux,uy,uz,fx,fy,fz,mx,my,mz,work\n"
                       "0.3,\"a, \"\"b\"\"\",1,0,0,0,2,0,3,0,0,0,0,4,9\n"));
    }
}

TEST_CASE("ResultWriter: the summary is valid JSON whatever its texts and numbers") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run")});
    Summary summary;
    summary.title = "quotes \" \\ \n \x01 \xff \xc3\xa4";
    summary.wall_seconds = std::numeric_limits<double>::quiet_NaN();
    summary.time_step = 1e-5;
    summary.energy.residual = -std::numeric_limits<double>::infinity();
    summary.stages = {{"forces", 0.1}, {"contact", 1e22}};
    summary.writer_seconds = 0.25;
    ReactionRow reaction{.name = "a \"b\"", .work = 4};
    reaction.displacement[1] = 1.5, reaction.force[0] = 2, reaction.moment[2] = 3;
    summary.reactions = {reaction};
    summary.warnings = {{"grain 3 left the domain (step 7)", 2}};
    writer.finish(summary);
    CHECK(python_accepts(
        "import sys, json; s = json.load(open(sys.argv[1], encoding=\"utf-8\")); "
        "assert s[\"title\"] == \"quotes \\\" \\\\ \\n \\x01 \\ufffd \\xe4\", s[\"title\"]; "
        "assert s[\"wall_seconds\"] is None and s[\"energy\"][\"residual\"] is None; "
        "assert s[\"time_step\"] == 1e-5 and s[\"stages\"][\"contact\"] == 1e22; "
        "assert s[\"warnings\"] == [{\"text\": \"grain 3 left the domain (step 7)\", \"count\": 2}]; "
        "assert s[\"writer_seconds\"] == 0.25; "
        "assert s[\"reactions\"] == [{\"name\": \"a \\\"b\\\"\", \"displacement\": [0, 1.5], \"force\": [2, "
        "0], "
        "\"moment\": 3, \"work\": 4}]; "
        "assert set(s) == set(\"version title outcome dimension threads instructions deck_hash state_hash "
        "steps "
        "n_particles n_bonds n_grains simulated_time time_step stable_step wall_seconds "
        "ns_per_particle_step peak_memory_bytes stages writer_seconds contact_per_step reactions energy "
        "momentum_error warnings\".split())",
        scratch.path("run/summary.json")));
}

TEST_CASE("ResultWriter: the parents of the directory are made, an old summary is not left behind") {
    const ScratchDirectory scratch;
    write_run(scratch.path("a/b/c"), 2, 1);
    CHECK(std::filesystem::exists(scratch.path("a/b/c/summary.json")));
    const ResultWriter again({.directory = scratch.path("a/b/c")});
    CHECK_FALSE(std::filesystem::exists(scratch.path("a/b/c/summary.json")));
}

TEST_CASE("ResultWriter: VTK files on request, in a collection") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run"), .dimension = 2, .vtp = true});
    for (int i = 0; i < 2; ++i) writer.add_frame(make_sample_frame(2, i));
    writer.finish({});
    CHECK(contains(read_text(scratch.path("run/frames/frame_00001.vtp")), "vtkZLibDataCompressor"));
    const std::string collection = read_text(scratch.path("run/results.pvd"));
    CHECK(contains(collection, "timestep=\"0.1\" file=\"frames/frame_00001.vtp\""));
    CHECK(python_accepts("import sys, xml.dom.minidom as m; m.parse(sys.argv[1])",
                         scratch.path("run/results.pvd")));
    // Without the option a new run removes what would tell of the old one.
    write_run(scratch.path("run"), 2, 1);
    CHECK_FALSE(std::filesystem::exists(scratch.path("run/results.pvd")));
}

TEST_CASE("ResultWriter: a directory that cannot be made is named, with the reason") {
    const ScratchDirectory scratch;
    std::ofstream(scratch.path("file")) << "in the way";
    const std::string directory = scratch.path("file");
    CHECK(message_of([&] { ResultWriter({.directory = directory}); }) ==
          directory + ": cannot create the directory: Not a directory");
    CHECK(
        contains(message_of([&] { ResultWriter({.directory = directory + "/below"}); }), "Not a directory"));
    CHECK(contains(message_of([&] { ResultWriter({.directory = "/proc/quern"}); }),
                   "/proc/quern: cannot create"));
}

TEST_CASE("ResultWriter: a full disk is named, with the file") {
    const ScratchDirectory scratch;
    for (const char* name : {"history.csv", "grains.csv", "reactions.csv"}) {
        const std::string file = scratch.path(std::string(name) + ".run/") + name;
        std::filesystem::create_directory(std::filesystem::path(file).parent_path());
        std::filesystem::create_symlink("/dev/full", file);
        const std::string directory = std::filesystem::path(file).parent_path();
        CHECK(message_of([&] { ResultWriter({.directory = directory}); }) ==
              file + ": cannot write: No space left on device");
    }
    std::filesystem::create_directory(scratch.path("log"));
    std::filesystem::create_symlink("/dev/full", scratch.path("log/run.log"));
    ResultWriter writer({.directory = scratch.path("log")});
    CHECK(
        contains(message_of([&] { writer.log("line"); }), "run.log: cannot write: No space left on device"));
}

TEST_CASE("ResultWriter: a disk that fills up during the run is named, and what was written stays readable") {
    const ScratchDirectory scratch;
    const std::string disk = scratch.path("disk");
    std::filesystem::create_directory(disk);
    if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0) {
        MESSAGE("not allowed to mount a small disk: skipped");
        return;
    }
    const std::string message = message_of([&] {
        ResultWriter writer({.directory = disk + "/run"});
        for (int i = 0; i < 1000; ++i) writer.add_frame(make_sample_frame(2, i));
        writer.flush();
    });
    CHECK(contains(message, "cannot write: No space left on device"));
    CHECK(contains(message, disk + "/run/results."));
    umount(disk.c_str());
}

TEST_CASE("ResultWriter: results deleted during the run are noticed") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run")});
    writer.add_frame(make_sample_frame(2, 0));
    writer.flush();
    std::filesystem::remove_all(scratch.path("run"));
    CHECK(contains(message_of([&] { writer.log("line"); }), "run.log: cannot write: the file was deleted"));
    CHECK(contains(message_of([&] {
                       writer.add_frame(make_sample_frame(2, 1));
                       writer.flush();
                   }),
                   "results.h5: cannot write: the file was deleted"));
    CHECK(contains(message_of([&] { writer.write_text("deck.yaml", "a: 1"); }), "No such file or directory"));
    CHECK(contains(message_of([&] { writer.finish({}); }), "results.h5: cannot write"));
}

TEST_CASE("ResultWriter: no temporary file is left") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run")});
    std::filesystem::create_directory(scratch.path("run/deck.yaml"));
    CHECK(contains(message_of([&] { writer.write_text("deck.yaml", "a: 1"); }),
                   "deck.yaml: cannot replace the file"));
    CHECK_FALSE(std::filesystem::exists(scratch.path("run/deck.yaml.part")));
}

TEST_CASE("FrameFileReader: files that are not results are refused by name") {
    const ScratchDirectory scratch;
    CHECK_THROWS_WITH_AS(FrameFileReader(scratch.path("none.h5")),
                         doctest::Contains("none.h5: got no such file, expected the results.h5 of a run"),
                         InputError);
    std::ofstream(scratch.path("text.h5")) << "no HDF5 at all";
    CHECK_THROWS_WITH_AS(FrameFileReader(scratch.path("text.h5")), doctest::Contains("HDF5 cannot open"),
                         InputError);

    write_run(scratch.path("run"), 2, 3);
    std::filesystem::resize_file(scratch.path("run/results.h5"), 4000);
    CHECK_THROWS_WITH_AS(FrameFileReader(scratch.path("run/results.h5")),
                         doctest::Contains("results.h5: got"), InputError);
}
