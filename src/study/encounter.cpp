#include "src/study/encounter.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace quern {

namespace {

using Vector = std::array<double, 3>;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double unequal = 0.05, slack = 0.05;

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double norm(const Vector& a) {
    return std::sqrt(dot(a, a));
}
Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector unit(const Vector& a) {
    const double length = norm(a);
    return {a[0] / length, a[1] / length, a[2] / length};
}

/// Three columns of a row; those that a run in 2D has not are 0.
Vector vector_at(const Columns& rows, const std::array<const char*, 3>& names, std::size_t i) {
    Vector v{};
    for (std::size_t a = 0; a < 3; ++a)
        if (const std::vector<double>* column = rows.find(names[a])) v[a] = (*column)[i];
    return v;
}
constexpr std::array<const char*, 3> position = {"x", "y", "z"}, velocity = {"vx", "vy", "vz"},
                                     force = {"fx", "fy", "fz"};

/// Impulse of the contact force over the rows of a contact.
Vector impulse(const Columns& rows, const ContactTime& contact) {
    const std::vector<double>& time = *rows.find("time");
    Vector sum{};
    for (std::size_t i = std::max<std::size_t>(1, contact.begin); i < contact.end; ++i) {
        const Vector f = vector_at(rows, force, i);
        for (std::size_t a = 0; a < 3; ++a) sum[a] += f[a] * (time[i] - time[i - 1]);
    }
    return sum;
}

/// Line of centres from the second to the first, mean over a contact with the force as weight.
Vector mean_line(const Columns& first, const Columns& second, const ContactTime& contact) {
    const std::vector<double>& time = *first.find("time");
    Vector sum{};
    for (std::size_t i = std::max<std::size_t>(1, contact.begin); i < contact.end; ++i) {
        const Vector line = unit(minus(vector_at(first, position, i), vector_at(second, position, i)));
        const double weight = norm(vector_at(first, force, i)) * (time[i] - time[i - 1]);
        for (std::size_t a = 0; a < 3; ++a) sum[a] += weight * line[a];
    }
    return sum;
}

bool is_round(const Deck& deck, int grain) {
    const std::string& name = deck.grains[static_cast<std::size_t>(grain)].shape;
    for (const ShapeDeck& shape : deck.shapes)
        if (shape.name == name) return shape.kind == ShapeKind::disk || shape.kind == ShapeKind::sphere;
    return false;
}

/// Speeds of approach of two grains along a direction from the second to the first.
std::vector<double> approach(const Columns& first, const Columns& second, const Vector& normal) {
    std::vector<double> speeds(first.n_rows());
    for (std::size_t i = 0; i < speeds.size(); ++i)
        speeds[i] = -dot(minus(vector_at(first, velocity, i), vector_at(second, velocity, i)), normal);
    return speeds;
}

std::vector<double> approach(const Columns& rows, const WallDeck& wall) {
    const std::vector<double>& time = *rows.find("time");
    const Vector normal = unit(wall.normal);
    std::vector<double> speeds(rows.n_rows());
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        Vector v = vector_at(rows, velocity, i);
        for (std::size_t a = 0; a < wall.velocity.size(); ++a) v[a] -= wall.velocity[a](time[i]);
        speeds[i] = -dot(v, normal);
    }
    return speeds;
}

const WallDeck* wall_of(const Deck& deck, const Vector& push) {
    const WallDeck* best = nullptr;
    double steepest = 0.0;
    for (const WallDeck& wall : deck.walls) {
        const Vector normal = unit(wall.normal);
        const double along = dot(push, normal);
        const double across = std::sqrt(std::max(0.0, dot(push, push) - along * along));
        if (along <= steepest || across > (wall.friction + slack) * along) continue;
        steepest = along;
        best = &wall;
    }
    return best;
}

double one_restitution(const Deck& deck, const RunFiles& run, int grain, const ContactTime& contact) {
    const Columns& rows = run.grains.at(grain);
    const Vector push = impulse(rows, contact);
    if (!(norm(push) > 0.0)) return none;
    for (const auto& [other, others] : run.grains) {
        if (other == grain || others.n_rows() != rows.n_rows()) continue;
        const Vector answer = impulse(others, contact);
        Vector sum = push;
        for (std::size_t a = 0; a < 3; ++a) sum[a] += answer[a];
        if (!(norm(sum) < unequal * norm(push))) continue;
        const bool periodic = deck.grid.periodic[0] || deck.grid.periodic[1] || deck.grid.periodic[2];
        const bool by_centres = is_round(deck, grain) && is_round(deck, other) && !periodic;
        const Vector normal = by_centres ? mean_line(rows, others, contact) : push;
        return restitution(contact, approach(rows, others, unit(normal)));
    }
    const WallDeck* wall = wall_of(deck, push);
    return wall ? restitution(contact, approach(rows, *wall)) : none;
}

}  // namespace

double first_restitution(const Deck& deck, const RunFiles& run, int grain,
                         const std::vector<ContactTime>& contacts) {
    for (const ContactTime& contact : contacts)
        if (const double value = one_restitution(deck, run, grain, contact); std::isfinite(value))
            return value;
    return none;
}

}  // namespace quern
