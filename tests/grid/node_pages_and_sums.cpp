// Sparse nodal values; loops and sums on threads; small vectors.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "grid/node_pages.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

template <int Dim>
void check_pages() {
    CAPTURE(Dim);
    const IntVec<Dim> n = IntVec<Dim>::LinSpaced(Dim, 37, 19);
    const CartesianGrid<Dim> grid(Vec<Dim>::Zero(), 1.0, n, {});
    NodePages<Dim, int> pages(grid, -7);
    CHECK(pages.n_pages() == 0);
    const int n_nodes = grid.n_nodes().prod();
    const auto node = [&](int k) {
        IntVec<Dim> i;
        for (int a = 0, rest = k; a < Dim; rest /= grid.n_nodes()[a], ++a) i[a] = rest % grid.n_nodes()[a];
        return i;
    };
    for (int k = 0; k < n_nodes; ++k) pages.require(node(k));
    CHECK(pages[node(n_nodes / 2)] == -7);
    for (int k = 0; k < n_nodes; ++k) pages[node(k)] = k;
    int wrong = 0;
    for (int k = 0; k < n_nodes; ++k) wrong += pages[node(k)] != k;
    CHECK(wrong == 0);
    std::size_t expected = 1;
    for (int a = 0; a < Dim; ++a)
        expected *= static_cast<std::size_t>((grid.n_nodes()[a] + pages.side - 1) / pages.side);
    CHECK(pages.n_pages() == static_cast<int>(expected));
    int misplaced = 0;
    for (int page = 0; page < pages.n_pages(); ++page)
        for (int i = 0; i < pages.page_size; ++i) {
            const IntVec<Dim> there = pages.node(page, i);
            const bool inside = ((grid.n_nodes() - there).array() > 0).all();
            if (inside) misplaced += &pages[there] != &pages.values(page)[static_cast<std::size_t>(i)];
        }
    CHECK(misplaced == 0);
    pages.clear();
    CHECK(pages.n_pages() == 0);
    pages.require(node(5));
    CHECK(pages[node(5)] == -7);
}

/// Pages of one colour that hold nodes less than half a page apart.
template <int Dim>
int clashes(int n_cells, bool periodic) {
    std::array<bool, Dim> axes{};
    axes.fill(periodic);
    const CartesianGrid<Dim> grid(Vec<Dim>::Zero(), 1.0, IntVec<Dim>::Constant(n_cells), axes);
    NodePages<Dim, int> pages(grid, -1);
    const int n = grid.n_nodes()[0];
    const auto wrapped = [&](IntVec<Dim> node) {
        for (int a = 0; a < Dim; ++a) node[a] = periodic ? (node[a] + n) % n : node[a];
        return node;
    };
    const auto for_each_node = [&](auto&& visit) {
        for (int k = 0; k < grid.n_nodes().prod(); ++k) {
            IntVec<Dim> node;
            for (int a = 0, rest = k; a < Dim; rest /= n, ++a) node[a] = rest % n;
            visit(node);
        }
    };
    for_each_node([&](const IntVec<Dim>& node) { pages.require(node); });
    for (int page = 0; page < pages.n_pages(); ++page)
        for (int& value : pages.values(page)) value = page;
    int found = 0;
    for_each_node([&](const IntVec<Dim>& node) {
        constexpr int near = pages.side / 2 - 1, around = 2 * near + 1;
        for (int k = 0; k < power(around, Dim); ++k) {
            IntVec<Dim> other = node;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= around) other[a] += rest % around - near;
            other = wrapped(other);
            if ((other.array() < 0).any() || (other.array() >= n).any()) continue;
            const int a = pages[node], b = pages[other];
            found += a != b && pages.colour(a) == pages.colour(b);
            found += pages.colour(a) < 0 || pages.colour(a) >= pages.n_colours;
        }
    });
    return found;
}

struct Threads {
    explicit Threads(int n) { parallel::set_threads(n); }
    ~Threads() { parallel::set_threads(before_); }
    int before_ = parallel::n_threads();
};

}  // namespace

TEST_CASE("NodePages: every node has a value of its own") {
    check_pages<2>();
    check_pages<3>();
}

TEST_CASE("NodePages: pages of one colour are half a page apart") {
    for (const bool periodic : {false, true})
        for (const int n : {9, 17, 26, 33, 48, 49, 65, 81}) {
            CAPTURE(periodic);
            CAPTURE(n);
            CHECK(clashes<2>(n, periodic) == 0);
            if (n < 40) CHECK(clashes<3>(n, periodic) == 0);
        }
}

TEST_CASE("NodePages: memory follows the nodes asked for, not the box") {
    const CartesianGrid<3> grid(Vec<3>::Zero(), 1.0, {1000, 1000, 1000}, {});
    NodePages<3, int> pages(grid, 0);
    pages.require({500, 500, 500});
    pages.require({501, 500, 500});
    CHECK(pages.n_pages() == 1);
    pages.require({0, 999, 3});
    CHECK(pages.n_pages() == 2);
    pages[{501, 500, 500}] = 3;
    CHECK(pages[{500, 500, 500}] == 0);
    CHECK(pages[{0, 999, 3}] == 0);
}

TEST_CASE("Parallel: a sum has the same bits for any number of threads") {
    const auto term = [](std::size_t i) {
        const double x = static_cast<double>(i);
        return std::sin(x) * std::exp(0.01 * std::fmod(x, 700.0));
    };
    for (const std::size_t n : std::initializer_list<std::size_t>{0u, 1u, 255u, 256u, 257u, 100003u}) {
        CAPTURE(n);
        double one = 0.0, plain = 0.0;
        for (std::size_t i = 0; i < n; ++i) plain += term(i);
        for (const int threads : {1, 2, 3}) {
            CAPTURE(threads);
            const Threads guard(threads);
            CHECK(parallel::n_threads() == threads);
            const double sum = parallel::sum(n, 0.0, term);
            if (threads == 1) one = sum;
            CHECK(sum == one);
            CHECK(sum == doctest::Approx(plain).epsilon(1e-12));
        }
    }
}

TEST_CASE("Parallel: a loop visits every index once") {
    for (const int threads : {1, 2, 3})
        for (const std::size_t n : std::initializer_list<std::size_t>{0u, 1u, 2u, 1000u}) {
            CAPTURE(threads);
            CAPTURE(n);
            const Threads guard(threads);
            std::vector<int> visits(n, 0), alone(n, 0);
            parallel::for_each(n, [&](std::size_t i) { ++visits[i]; });
            parallel::for_each(
                n, [&](std::size_t i) { alone[i] = parallel::thread_id(); }, 5000);
            CHECK(visits == std::vector<int>(n, 1));
            CHECK(alone == std::vector<int>(n, 0));
        }
}

TEST_CASE("Parallel: no fewer than one thread") {
    const Threads guard(0);
    CHECK(parallel::n_threads() == 1);
}

TEST_CASE("Vec: rotation, cross product and moment agree with each other") {
    const Spin<3> angle(0.3, -0.5, 0.7);
    const Mat<3> R = rotation_matrix(angle);
    CHECK((R.transpose() * R - Mat<3>::Identity()).norm() < 1e-15);
    CHECK(R.determinant() == doctest::Approx(1.0));
    CHECK((R * angle - angle).norm() < 1e-15);
    CHECK(rotation_matrix(Spin<3>(Spin<3>::Zero())) == Mat<3>(Mat<3>::Identity()));
    const Mat<2> quarter = rotation_matrix(Spin<2>(std::numbers::pi / 2.0));
    CHECK((quarter * Vec<2>(1.0, 0.0) - Vec<2>(0.0, 1.0)).norm() < 1e-15);
    // Velocity is the derivative of position; power of a force is that of its moment.
    const Vec<3> r(1.0, 2.0, -0.5), f(-3.0, 0.2, 0.9);
    const Vec<3> slope = (rotation_matrix(Spin<3>(1e-6 * angle)) * r - r) / 1e-6;
    CHECK((slope - cross(angle, r)).norm() < 2e-6);
    CHECK(f.dot(cross(angle, r)) == doctest::Approx(angle.dot(moment(r, f))));
    const Vec<2> r2(1.0, 2.0), f2(-3.0, 0.2);
    CHECK(f2.dot(cross(Spin<2>(0.8), r2)) == doctest::Approx(0.8 * moment(r2, f2)[0]));
}

}  // namespace quern
