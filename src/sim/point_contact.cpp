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

struct Largest {
    double value = 0.0;
    Largest& operator+=(const Largest& other) {
        value = std::max(value, other.value);
        return *this;
    }
};

template <class Body>
void for_all(std::size_t n, Body&& body) {
    parallel::for_each(n, body, 256);
}

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

/// Contact of one step, asked by one of three ways.
template <int Dim>
class Asking {
  public:
    Asking(Scene<Dim>& scene, const ContactScene<Dim>& view, const ContactTrial<Dim>& trial,
           std::vector<ContactPoint<Dim>>& list)
        : scene_(scene),
          view_(view),
          trial_(trial),
          list_(list),
          c_(scene.point_contact),
          n_(trial.v.size()) {}

    const ContactReport<Dim>& springs() {
        points().project(scene_.particles, trial_.v, c_.u);
        const ContactReport<Dim>& report = ask();
        list(1.0);
        points().project(scene_.particles, take_change(), c_.mapped);
        for_all(n_, [&](std::size_t p) { trial_.v[p] += c_.mapped[p]; });
        return report;
    }

    const ContactReport<Dim>& with_memory() {
        const double part = trial_.first ? 0.5 : 1.0, scale = part / c_.part;
        c_.part = part;
        for_all(n_, [&](std::size_t p) { c_.u[p] = trial_.v[p] + scale * c_.mapped[p]; });
        points().project(scene_.particles, c_.u, c_.u);
        for_all(n_, [&](std::size_t p) { c_.u[p] -= scale * c_.last[p]; });
        c_.report = ask();
        list(1.0);
        std::swap(take_change(), c_.last);
        points().project(scene_.particles, c_.last, c_.mapped);
        return finish(c_.mapped);
    }

    const ContactReport<Dim>& in_rounds() {
        c_.mapped.assign(n_, Vec<Dim>::Zero());
        points().project(scene_.particles, trial_.v, c_.u);
        double first = 0.0;
        for (int round = 0; round < max_rounds; ++round) {
            const ContactReport<Dim>& report = ask();
            if (round == 0) c_.report = report;
            const std::vector<Vec<Dim>>& change = take_change();
            points().project(scene_.particles, change, c_.once);
            points().project(scene_.particles, c_.once, c_.twice);
            const Products products = parallel::sum(n_, Products{}, [&](std::size_t p) {
                const Vec<Dim> done = view_.mass[p] * c_.twice[p];
                return Products{change[p].dot(done), c_.twice[p].dot(done)};
            });
            if (products.done == 0.0) break;
            const double w = std::clamp(products.wanted / products.done, 1.0, 2.0);
            for_all(n_, [&](std::size_t p) {
                c_.mapped[p] += w * c_.once[p];
                c_.u[p] += w * c_.twice[p];
            });
            add_scaled(c_.report, report, round == 0 ? w - 1.0 : w);
            list(w);
            if (round == 0) first = products.done;
            if (products.done <= round_tolerance * round_tolerance * first) break;
        }
        return finish(c_.mapped);
    }

  private:
    MaterialPoints<Dim>& points() { return *scene_.points; }

    /// Shows `u` to contact, which makes it `asked`.
    const ContactReport<Dim>& ask() {
        ContactTrial<Dim> trial = trial_;
        c_.asked.resize(n_);
        const double fastest = parallel::sum(n_, Largest{}, [&](std::size_t p) {
                                   c_.asked[p] = c_.u[p];
                                   return Largest{c_.u[p].squaredNorm()};
                               }).value;
        trial.v_before = scene_.arrays.drift;
        trial.v = c_.asked;
        trial.largest_speed = std::max(trial.largest_speed, std::sqrt(fastest));
        return std::visit(
            [&](auto& method) -> const ContactReport<Dim>& { return method.add_impulses(view_, trial); },
            *scene_.contact);
    }
    /// What contact has asked for.
    std::vector<Vec<Dim>>& take_change() {
        for_all(n_, [&](std::size_t p) { c_.asked[p] -= c_.u[p]; });
        return c_.asked;
    }
    void list(double w) {
        if (!trial_.listing) return;
        const std::size_t n_before = list_.size();
        std::visit([&](auto& method) { method.list_contacts(view_, list_); }, *scene_.contact);
        for (std::size_t k = n_before; k < list_.size(); ++k) list_[k].impulse *= w;
    }
    const ContactReport<Dim>& finish(const std::vector<Vec<Dim>>& change) {
        const double work = parallel::sum(n_, 0.0, [&](std::size_t p) {
            trial_.v[p] += change[p];
            return 0.5 * view_.mass[p] * change[p].dot(trial_.v_before[p] + trial_.v[p]);
        });
        c_.report.normal_work = work - c_.report.friction_work - c_.report.wall_work;
        return c_.report;
    }

    Scene<Dim>& scene_;
    const ContactScene<Dim>& view_;
    const ContactTrial<Dim>& trial_;
    std::vector<ContactPoint<Dim>>& list_;
    PointContact<Dim>& c_;
    std::size_t n_;
};

}  // namespace

template <int Dim>
const ContactReport<Dim>& add_point_impulses(Scene<Dim>& scene, const ContactScene<Dim>& view,
                                             const ContactTrial<Dim>& trial,
                                             std::vector<ContactPoint<Dim>>& list) {
    PointContact<Dim>& c = scene.point_contact;
    for (std::vector<Vec<Dim>>* field : {&c.u, &c.last, &c.mapped})
        field->resize(trial.v.size(), Vec<Dim>::Zero());
    Asking<Dim> asking(scene, view, trial, list);
    if (std::holds_alternative<NodePairContact<Dim>>(*scene.contact)) return asking.springs();
    const bool seed = std::get<GridContact<Dim>>(*scene.contact).options().rule == GridRule::seed;
    return seed ? asking.in_rounds() : asking.with_memory();
}

template <int Dim>
void project_forces(Scene<Dim>& scene, std::vector<Vec<Dim>>& f) {
    PointContact<Dim>& c = scene.point_contact;
    const std::vector<double>& mass = scene.particles.mass;
    c.u.resize(f.size());
    for (std::size_t p = 0; p < f.size(); ++p) c.u[p] = f[p] / mass[p];
    scene.points->project(scene.particles, c.u, c.u);
    for (std::size_t p = scene.points->first_point(); p < f.size(); ++p) f[p] = mass[p] * c.u[p];
}

template const ContactReport<2>& add_point_impulses<2>(Scene<2>&, const ContactScene<2>&,
                                                       const ContactTrial<2>&, std::vector<ContactPoint<2>>&);
template const ContactReport<3>& add_point_impulses<3>(Scene<3>&, const ContactScene<3>&,
                                                       const ContactTrial<3>&, std::vector<ContactPoint<3>>&);
template void project_forces<2>(Scene<2>&, std::vector<Vec<2>>&);
template void project_forces<3>(Scene<3>&, std::vector<Vec<3>>&);

}  // namespace quern
