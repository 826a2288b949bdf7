#include "src/sim/point_contact.hpp"

#include <algorithm>

#include "grid/parallel.hpp"

namespace quern {

namespace {

/// Sums of a round.
struct Products {
    double wanted = 0.0, done = 0.0;  ///< (c, P P c), (P P c, P P c)
    Products& operator+=(const Products& other) {
        wanted += other.wanted;
        done += other.done;
        return *this;
    }
};

template <int Dim>
void add_scaled(ContactReport<Dim>& sum, const ContactReport<Dim>& round, double w) {
    sum.friction_work += w * round.friction_work;
    sum.wall_work += w * round.wall_work;
    for (std::size_t g = 0; g < round.grain_impulse.size(); ++g)
        sum.grain_impulse[g] += w * round.grain_impulse[g];
    for (std::size_t k = 0; k < round.wall_impulse.size(); ++k) {
        sum.wall_impulse[k] += w * round.wall_impulse[k];
        sum.wall_moment[k] += w * round.wall_moment[k];
    }
    sum.sweeps += round.sweeps;
    sum.converged = sum.converged && round.converged;
    sum.searched = sum.searched || round.searched;
}

}  // namespace

template <int Dim>
const ContactReport<Dim>& add_point_impulses(Scene<Dim>& scene, const ContactScene<Dim>& view,
                                             const ContactTrial<Dim>& trial,
                                             std::vector<ContactPoint<Dim>>& list) {
    MaterialPoints<Dim>& points = *scene.points;
    PointContact<Dim>& c = scene.point_contact;
    const std::size_t n = trial.v.size();
    for (std::vector<Vec<Dim>>* field : {&c.before, &c.u, &c.asked, &c.change, &c.added}) field->resize(n);
    c.star.assign(trial.v.begin(), trial.v.end());
    points.project(scene.particles, scene.arrays.v_before, c.before);
    points.project(scene.particles, c.star, c.u);
    const bool springs = std::holds_alternative<NodePairContact<Dim>>(*scene.contact);
    ContactTrial<Dim> asked = trial;
    asked.v_before = c.before;
    const auto list_round = [&](double w) {
        if (!trial.listing) return;
        const std::size_t n_before = list.size();
        std::visit([&](auto& method) { method.list_contacts(view, list); }, *scene.contact);
        for (std::size_t k = n_before; k < list.size(); ++k) list[k].impulse *= w;
    };
    double first = 0.0;
    for (int round = 0; round < max_rounds; ++round) {
        c.asked = c.u;
        asked.v = c.asked;
        const ContactReport<Dim>& report = std::visit(
            [&](auto& method) -> const ContactReport<Dim>& { return method.add_impulses(view, asked); },
            *scene.contact);
        const double size = parallel::sum(n, 0.0, [&](std::size_t p) {
            c.asked[p] -= c.u[p];
            return c.asked[p].squaredNorm();
        });
        if (round == 0 && !springs) c.report = report;
        if (size == 0.0 && !springs) break;
        points.project(scene.particles, c.asked, c.change);
        if (springs) {
            parallel::for_each(
                n, [&](std::size_t p) { trial.v[p] += c.change[p]; }, 256);
            list_round(1.0);
            return report;
        }
        points.project(scene.particles, c.change, c.added);
        const Products products = parallel::sum(n, Products{}, [&](std::size_t p) {
            const Vec<Dim> added = view.mass[p] * c.added[p];
            return Products{c.asked[p].dot(added), c.added[p].dot(added)};
        });
        const double w = products.done > 0.0 ? std::clamp(products.wanted / products.done, 1.0, 2.0) : 1.0;
        parallel::for_each(
            n,
            [&](std::size_t p) {
                trial.v[p] += w * c.change[p];
                c.u[p] += w * c.added[p];
            },
            256);
        add_scaled(c.report, report, round == 0 ? w - 1.0 : w);
        list_round(w);
        if (round == 0) first = products.done;
        if (products.done <= round_tolerance * round_tolerance * first) break;
    }
    const double work = parallel::sum(n, 0.0, [&](std::size_t p) {
        return 0.5 * view.mass[p] * (trial.v[p] - c.star[p]).dot(trial.v_before[p] + trial.v[p]);
    });
    c.report.normal_work = work - c.report.friction_work - c.report.wall_work;
    return c.report;
}

template <int Dim>
void project_forces(Scene<Dim>& scene, std::vector<Vec<Dim>>& f) {
    PointContact<Dim>& c = scene.point_contact;
    const std::vector<double>& mass = scene.particles.mass;
    c.asked.resize(f.size());
    c.change.resize(f.size());
    for (std::size_t p = 0; p < f.size(); ++p) c.asked[p] = f[p] / mass[p];
    scene.points->project(scene.particles, c.asked, c.change);
    for (std::size_t p = scene.points->first_point(); p < f.size(); ++p) f[p] = mass[p] * c.change[p];
}

template const ContactReport<2>& add_point_impulses<2>(Scene<2>&, const ContactScene<2>&,
                                                       const ContactTrial<2>&, std::vector<ContactPoint<2>>&);
template const ContactReport<3>& add_point_impulses<3>(Scene<3>&, const ContactScene<3>&,
                                                       const ContactTrial<3>&, std::vector<ContactPoint<3>>&);
template void project_forces<2>(Scene<2>&, std::vector<Vec<2>>&);
template void project_forces<3>(Scene<3>&, std::vector<Vec<3>>&);

}  // namespace quern
