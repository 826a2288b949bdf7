#include "src/results/render.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "grid/error.hpp"
#include "src/results/fields.hpp"
#include "src/results/rose.hpp"
#include "src/results/writer.hpp"
#include "tests/results/samples.hpp"

using namespace quern;

namespace {

struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;

    std::size_t n_colors() const {
        std::set<int> colors;
        for (std::size_t i = 0; i < rgb.size(); i += 3)
            colors.insert(rgb[i] << 16 | rgb[i + 1] << 8 | rgb[i + 2]);
        return colors.size();
    }
    std::size_t n_white() const {
        std::size_t n = 0;
        for (std::size_t i = 0; i < rgb.size(); i += 3)
            n += rgb[i] == 255 && rgb[i + 1] == 255 && rgb[i + 2] == 255;
        return n;
    }
    bool operator==(const Picture&) const = default;
};

Picture read_picture(const std::string& file) {
    vtkNew<vtkPNGReader> reader;
    REQUIRE(reader->CanReadFile(file.c_str()) > 0);
    reader->SetFileName(file.c_str());
    reader->Update();
    int size[3];
    reader->GetOutput()->GetDimensions(size);
    const auto* pixels = static_cast<const unsigned char*>(reader->GetOutput()->GetScalarPointer());
    return {size[0], size[1], {pixels, pixels + 3 * static_cast<std::ptrdiff_t>(size[0]) * size[1]}};
}

void write_run(const std::string& directory, int dimension, int n_frames) {
    ResultWriter writer({.directory = directory, .dimension = dimension, .title = "A run"});
    for (int i = 0; i < n_frames; ++i) writer.add_frame(make_sample_frame(dimension, i));
    writer.finish({});
}

RenderOptions make_options(const ScratchDirectory& scratch, const std::string& file) {
    RenderOptions options;
    options.directory = scratch.path("run");
    options.file = scratch.path(file);
    options.width = 400;
    options.height = 300;
    return options;
}

Picture draw(const ScratchDirectory& scratch, const std::string& field, const std::string& frame = "last") {
    RenderOptions options = make_options(scratch, field + "_" + frame + ".png");
    options.field = field;
    options.frame = frame;
    const std::vector<std::string> files = render(options);
    REQUIRE(files.size() == 1);
    return read_picture(files[0]);
}

}  // namespace

TEST_CASE("Render: every field gives a picture of its own, in the plane and in space") {
    for (const int dimension : {2, 3}) {
        const ScratchDirectory scratch;
        write_run(scratch.path("run"), dimension, 2);
        std::vector<Picture> pictures;
        for (const std::string& field : field_names(dimension)) {
            CAPTURE(field);
            if (dimension == 2 && (field == "damage_z" || field == "fragment" || field == "plastic_strain"))
                continue;  // nothing breaks or yields in this run
            const Picture picture = draw(scratch, field);
            CHECK(picture.width == 400);
            CHECK(picture.height == 300);
            CHECK(picture.n_colors() > 40);
            CHECK(picture.n_white() > 400 * 300 / 4);
            CHECK(picture.n_white() < 400 * 300 * 95 / 100);
            CHECK(std::find(pictures.begin(), pictures.end(), picture) == pictures.end());
            pictures.push_back(picture);
        }
    }
}

TEST_CASE("Render: discs lie where the particles are") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run"), .dimension = 2, .domain = {0, 0, 1, 1}});
    Frame frame;
    frame.position = {0.25, 0.75, std::nan(""), 0.5};
    frame.velocity = {0.0, 2.0, 0.0, 0.0};
    frame.damage = {0, 0};
    frame.stress.assign(8, 0.0);
    frame.grain = {0, 1};
    frame.volume = {0.01, 0.01};
    writer.add_frame(frame);
    writer.finish({});
    const Picture picture = draw(scratch, "speed");
    // Centre of all pixels of the one colour of the disc: the top of the colour map.
    double n = 0, x = 0, y = 0;
    for (int j = 0; j < picture.height; ++j)
        for (int i = 0; i < picture.width * 2 / 3; ++i) {
            const unsigned char* p = &picture.rgb[3 * static_cast<std::size_t>(j * picture.width + i)];
            if (p[0] > 240 && p[1] > 220 && p[2] < 60) n += 1, x += i, y += j;
        }
    REQUIRE(n > 0);
    // The plot: 150 x 150 pixels for 1.06 m at (97.5, 75), VTK's rows from the bottom.
    const double scale = 150 / 1.06;
    CHECK(x / n + 0.5 == doctest::Approx(97.5 + 0.28 * scale).epsilon(0.01));
    CHECK(y / n + 0.5 == doctest::Approx(75 + 0.78 * scale).epsilon(0.01));
    CHECK(n == doctest::Approx(0.01 * scale * scale).epsilon(0.15));
}

TEST_CASE("Render: no stress is grey, in the middle of the colours") {
    const ScratchDirectory scratch;
    ResultWriter writer({.directory = scratch.path("run"), .dimension = 2, .domain = {0, 0, 1, 1}});
    Frame frame;
    frame.position = {0.5, 0.5, 0.8, 0.8};
    frame.velocity = {0, 0, 0, 0};
    frame.damage = {0, 0};
    frame.stress = {0, 0, 0, 0, 1e5, 0, 0, 0};
    frame.grain = {0, 1};
    frame.volume = {0.01, 0.01};
    writer.add_frame(frame);
    writer.finish({});
    const Picture picture = draw(scratch, "stress_xx");
    const unsigned char* middle = &picture.rgb[3 * static_cast<std::size_t>(150 * picture.width + 172)];
    CHECK(middle[0] < 240);  // measured 221, white is 255
    CHECK(std::abs(middle[0] - middle[2]) < 10);
}

TEST_CASE("Render: all frames are numbered and share their colours") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 3);
    RenderOptions options = make_options(scratch, "new/directory/movie.png");
    options.frame = "all";
    options.field = "displacement";
    const std::vector<std::string> files = render(options);
    REQUIRE(files.size() >= 3);
    CHECK(files[0] == scratch.path("new/directory/movie_00000.png"));
    CHECK(files[2] == scratch.path("new/directory/movie_00002.png"));
    // At the start nothing is displaced: the colour of the particles is the lower end of the common range.
    const Picture start = read_picture(files[0]), end = read_picture(files[2]);
    CHECK_FALSE(start == end);
    CHECK(end == draw(scratch, "displacement"));
}

TEST_CASE("Render: a range that is given holds for every frame, a dark plot is black where nothing is") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 3);
    RenderOptions options = make_options(scratch, "light.png");
    options.field = "principal_difference";
    const Picture plain = read_picture(render(options)[0]);
    options.dark = true;
    const Picture dark = read_picture(render(options)[0]);
    const auto n_black = [](const Picture& picture) {
        std::size_t n = 0;
        for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
            n += picture.rgb[i] == 0 && picture.rgb[i + 1] == 0 && picture.rgb[i + 2] == 0;
        return n;
    };
    CHECK(n_black(plain) == 0);
    CHECK(n_black(dark) > 1500);  // measured 2358, bound 1500: between and around the particles
    CHECK(dark.n_white() < plain.n_white());
    // Far above all values: every particle is as dark as nothing.
    options.high = 1e30;
    const Picture off = read_picture(render(options)[0]);
    CHECK(off.n_colors() < dark.n_colors());
    options.low = 2e30;
    CHECK_THROWS_WITH_AS(render(options), doctest::Contains("an upper end above the lower one"), InputError);
}

TEST_CASE("Render: links are drawn over grey grains") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 2);
    const auto red = [&](const std::vector<PictureLink>& links) {
        const std::string file = scratch.path("network.png");
        draw_network(scratch.path("run"), 1, links, file);
        const Picture picture = read_picture(file);
        std::size_t n = 0;
        for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
            n += picture.rgb[i] > 120 && picture.rgb[i + 1] < 60 && picture.rgb[i + 2] < 60;
        return n;
    };
    const PictureLink thin{{0.0, 0.0, 0.0}, {0.1, 0.1, 0.0}, 0.002},
        thick{{0.0, 0.0, 0.0}, {0.1, 0.1, 0.0}, 0.006};
    const PictureLink outside{{5.0, 0.0, 0.0}, {5.1, 0.1, 0.0}, 0.006};
    CHECK(red({}) == 0);
    CHECK(red({outside}) == 0);
    const double ratio = static_cast<double>(red({thick})) / static_cast<double>(red({thin}));
    CHECK(ratio == doctest::Approx(3.0).epsilon(0.2));  // measured 3.27, bound 3.8: edges are mixed
    CHECK_THROWS_WITH_AS(draw_network(scratch.path("run"), 2, {}, scratch.path("x.png")),
                         doctest::Contains("expected less than 2"), InputError);
}

TEST_CASE("Render: petals of a rose hold the directions, both ways") {
    const double pi = 3.14159265358979323846;
    const std::vector<double> density = petals({0.0, 0.05, -pi, 0.5 * pi}, 36);
    const double each = 36.0 / (8.0 * 2.0 * pi);
    CHECK(density[0] == doctest::Approx(3.0 * each));
    CHECK(density[18] == doctest::Approx(3.0 * each));
    CHECK(density[9] == doctest::Approx(each));
    CHECK(density[27] == doctest::Approx(each));
    double whole = 0.0;
    for (const double d : density) whole += d * 2.0 * pi / 36.0;
    CHECK(whole == doctest::Approx(1.0));
    const ScratchDirectory scratch;
    draw_rose({"normals", {0.1, 1.0, 2.0}, 0.3, 0.5}, scratch.path("rose.png"));
    CHECK(read_picture(scratch.path("rose.png")).n_colors() > 40);
}

TEST_CASE("Render: ffmpeg is called where there is one") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 2);
    std::ofstream(scratch.path("ffmpeg")) << "#!/bin/sh\nfor last; do :; done\necho \"$@\" > \"$last\"\n";
    std::filesystem::permissions(scratch.path("ffmpeg"), std::filesystem::perms::owner_all);
    const std::string path = std::getenv("PATH");
    setenv("PATH", (scratch.path() + ":" + path).c_str(), 1);
    RenderOptions options = make_options(scratch, "50%.png");
    options.frame = "all";
    const std::vector<std::string> files = render(options);
    setenv("PATH", path.c_str(), 1);
    REQUIRE(files.size() == 3);
    CHECK(files[2] == scratch.path("50%.mp4"));
    CHECK(read_text(files[2]).find("-i " + scratch.path("50%%_%05d.png")) != std::string::npos);
}

TEST_CASE("Render: wrong wishes are answered with the valid ones") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 3);
    RenderOptions options = make_options(scratch, "picture.png");
    options.field = "sped";
    CHECK_THROWS_WITH_AS(
        render(options),
        "field: got 'sped', expected one of speed, displacement, velocity_x, velocity_y, damage, damage_z, "
        "plastic_strain, "
        "grain, fragment, von_mises, pressure, principal_difference, stress_xx, stress_yy, stress_zz, "
        "stress_xy (did "
        "you "
        "mean 'speed'?)",
        InputError);
    options.field = "speed";
    for (const char* frame : {"3", "-1", "first", "1.5", ""}) {
        options.frame = frame;
        CHECK_THROWS_WITH_AS(render(options), doctest::Contains("a number from 0 to 2"), InputError);
    }
    options.frame = "last";
    options.file = scratch.path("picture.jpg");
    CHECK_THROWS_AS(render(options), InputError);
    options = make_options(scratch, "picture.png");
    options.width = 0;
    CHECK_THROWS_AS(render(options), InputError);
    options = make_options(scratch, "picture.png");
    options.directory = scratch.path("nowhere");
    CHECK_THROWS_WITH_AS(render(options), doctest::Contains("nowhere/results.h5: got no such file"),
                         InputError);
}

TEST_CASE("Render: a picture that cannot be written is an error") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 1);
    const RenderOptions options = make_options(scratch, "run/results.xdmf/picture.png");
    CHECK_THROWS_WITH_AS(render(options), doctest::Contains("Not a directory"), OutputError);
}

TEST_CASE("Render: several processes draw at once") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 1);
    const Picture alone = draw(scratch, "speed");
    std::vector<pid_t> children;
    for (int i = 0; i < 3; ++i) {
        const pid_t child = fork();
        if (child == 0) {
            RenderOptions options = make_options(scratch, "child_" + std::to_string(i) + ".png");
            try {
                render(options);
            } catch (const std::exception&) {
                _exit(1);
            }
            _exit(0);
        }
        children.push_back(child);
    }
    for (int i = 0; i < 3; ++i) {
        int status = -1;
        waitpid(children[static_cast<std::size_t>(i)], &status, 0);
        CHECK(status == 0);
        CHECK(read_picture(scratch.path("child_" + std::to_string(i) + ".png")) == alone);
    }
}

TEST_CASE("Render: without Xvfb and display the error says what to install") {
    const ScratchDirectory scratch;
    write_run(scratch.path("run"), 2, 1);
    const std::string path = std::getenv("PATH");
    const char* display = std::getenv("DISPLAY");
    const std::string display_before = display ? display : "";
    setenv("PATH", scratch.path().c_str(), 1);
    unsetenv("DISPLAY");
    CHECK_THROWS_WITH_AS(render(make_options(scratch, "picture.png")),
                         doctest::Contains("install the package xvfb"), OutputError);
    setenv("PATH", path.c_str(), 1);
    if (display) setenv("DISPLAY", display_before.c_str(), 1);
}
