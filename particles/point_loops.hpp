// Bodies of PointField, for the source files that instantiate it.
#pragma once

#include <limits>

#include "particles/point_field.hpp"

namespace quern {

template <int Dim, PointFunctions functions>
template <class Visit>
inline void PointField<Dim, functions>::for_each_row(const Stencil& s, Visit&& visit) const {
    std::size_t node = 0;
    for (int a = 0; a < Dim; ++a) node += stride_[a] * static_cast<std::size_t>(s.base[a] - low_[a]);
    Row row;
    if constexpr (Dim == 2) {
        for (std::size_t j = 0; j < width; ++j) {
            row.node = node + stride_[1] * j;
            row.value = s.value[1][j];
            row.slope[1] = s.slope[1][j];
            visit(row);
        }
    } else {
        for (std::size_t k = 0; k < width; ++k)
            for (std::size_t j = 0; j < width; ++j) {
                row.node = node + stride_[1] * j + stride_[2] * k;
                row.value = s.value[1][j] * s.value[2][k];
                row.slope[1] = s.slope[1][j] * s.value[2][k];
                row.slope[2] = s.value[1][j] * s.slope[2][k];
                visit(row);
            }
    }
}

template <int Dim, PointFunctions functions>
inline Pack PointField<Dim, functions>::value_at(const Stencil& s, const std::vector<Pack>& nodes) const {
    Pack sum = Pack::Zero();
    for_each_row(s, [&](const Row& row) {
        Pack line = s.value[0][0] * nodes[row.node];
        for (std::size_t i = 1; i < width; ++i) line += s.value[0][i] * nodes[row.node + i];
        sum += row.value * line;
    });
    return sum;
}

template <int Dim, PointFunctions functions>
inline void PointField<Dim, functions>::add(const Stencil& s, const Pack& amount,
                                            std::vector<Pack>& nodes) const {
    for_each_row(s, [&](const Row& row) {
        const Pack part = row.value * amount;
        for (std::size_t i = 0; i < width; ++i) nodes[row.node + i] += s.value[0][i] * part;
    });
}

template <int Dim, PointFunctions functions>
void PointField<Dim, functions>::find_twins(const CartesianGrid<Dim>& grid, const IntVec<Dim>& n_nodes) {
    twins_.clear();
    const std::size_t n = nodes_.size();
    for (int a = 0; a < Dim; ++a) {
        if (!grid.periodic(a)) continue;
        const std::size_t period = stride_[a] * static_cast<std::size_t>(grid.n_cells()[a]);
        for (std::size_t node = 0; node < n; ++node)
            if (static_cast<int>(node / stride_[a]) % n_nodes[a] >= grid.n_cells()[a])
                twins_.emplace_back(node, node - period);
    }
}

template <int Dim, PointFunctions functions>
template <class T>
inline void PointField<Dim, functions>::join_twins(std::vector<T>& nodes) const {
    for (const auto& [past, within] : twins_) nodes[within] += nodes[past];
    for (auto pair = twins_.rbegin(); pair != twins_.rend(); ++pair) nodes[pair->first] = nodes[pair->second];
}

template <int Dim, PointFunctions functions>
void PointField<Dim, functions>::place(const CartesianGrid<Dim>& grid, std::span<const Vec<Dim>> x,
                                       std::span<const double> half, std::span<const double> mass,
                                       bool wraps) {
    inverse_h_ = 1.0 / grid.h();
    stencils_.resize(x.size());
    IntVec<Dim> low = IntVec<Dim>::Constant(std::numeric_limits<int>::max()), high = -low;
    for (std::size_t p = 0; p < x.size(); ++p) {
        stencils_[p].set(grid.in_cells(x[p]), half[p]);
        for (int a = 0; a < Dim && wraps; ++a)
            if (grid.periodic(a)) stencils_[p].base[a] = grid.wrapped(a, stencils_[p].base[a]);
        low = low.cwiseMin(stencils_[p].base);
        high = high.cwiseMax(stencils_[p].base);
    }
    for (int a = 0; a < Dim && wraps; ++a)
        if (grid.periodic(a)) {
            low[a] = 0;
            high[a] = grid.n_cells()[a] - 1;
        }
    low_ = low;
    const IntVec<Dim> size = high - low + IntVec<Dim>::Constant(width);
    std::size_t n_nodes = 1;
    for (int a = 0; a < Dim; ++a) {
        stride_[a] = n_nodes;
        n_nodes *= static_cast<std::size_t>(size[a]);
    }
    mass_.assign(n_nodes, 0.0);
    nodes_.resize(n_nodes);
    if (wraps) find_twins(grid, size);
    for (std::size_t p = 0; p < x.size(); ++p) {
        const Stencil& s = stencils_[p];
        for_each_row(s, [&](const Row& row) {
            const double part = mass[p] * row.value;
            for (std::size_t i = 0; i < width; ++i) mass_[row.node + i] += s.value[0][i] * part;
        });
    }
    join_twins(mass_);
    for (double& m : mass_) m = m > 0.0 ? 1.0 / m : 0.0;
}

template <int Dim, PointFunctions functions>
void PointField<Dim, functions>::finish(std::span<const double> mass, int order) {
    for (std::size_t a = 0; a < nodes_.size(); ++a) nodes_[a] *= mass_[a];
    if (order == 1) return;
    term_ = nodes_;
    for (int k = 1; k < order; ++k) {
        next_.assign(nodes_.size(), Pack::Zero());
        for (std::size_t p = 0; p < stencils_.size(); ++p) {
            const Pack value = value_at(stencils_[p], term_);
            if ((value != 0.0).any()) add(stencils_[p], mass[p] * value, next_);
        }
        join_twins(next_);
        for (std::size_t a = 0; a < nodes_.size(); ++a) {
            term_[a] -= mass_[a] * next_[a];
            nodes_[a] += term_[a];
        }
    }
}

template <int Dim, PointFunctions functions>
void PointField<Dim, functions>::scatter_velocities(std::span<const double> mass, std::span<const Vec<Dim>> v,
                                                    int order) {
    std::fill(nodes_.begin(), nodes_.end(), Pack::Zero());
    for (std::size_t p = 0; p < stencils_.size(); ++p) {
        if (v[p] == Vec<Dim>::Zero()) continue;
        Pack momentum = Pack::Zero();
        momentum.template head<Dim>() = (mass[p] * v[p]).array();
        add(stencils_[p], momentum, nodes_);
    }
    join_twins(nodes_);
    finish(mass, order);
}

template <int Dim, PointFunctions functions>
template <class Stress>
inline void PointField<Dim, functions>::scatter_forces(std::span<const double> mass,
                                                       std::span<const double> volume, int order,
                                                       Stress&& stress) {
    std::fill(nodes_.begin(), nodes_.end(), Pack::Zero());
    for (std::size_t p = 0; p < stencils_.size(); ++p) {
        const Stencil& s = stencils_[p];
        const Mat<Dim> tau = stress(p);
        Pack column[Dim];  // force of a slope along each axis
        for (int a = 0; a < Dim; ++a) {
            column[a].setZero();
            column[a].template head<Dim>() = (-volume[p] * inverse_h_) * tau.col(a).array();
        }
        for_each_row(s, [&](const Row& row) {
            const Pack along = row.value * column[0];
            Pack across = row.slope[1] * column[1];
            if constexpr (Dim == 3) across += row.slope[2] * column[2];
            for (std::size_t i = 0; i < width; ++i)
                nodes_[row.node + i] += s.slope[0][i] * along + s.value[0][i] * across;
        });
    }
    join_twins(nodes_);
    finish(mass, order);
}

template <int Dim, PointFunctions functions>
void PointField<Dim, functions>::gather_forces(std::span<const double> mass, std::span<Vec<Dim>> f) const {
    for (std::size_t p = 0; p < stencils_.size(); ++p)
        f[p] = mass[p] * value_at(stencils_[p], nodes_).template head<Dim>().matrix();
}

template <int Dim, PointFunctions functions>
void PointField<Dim, functions>::gather_velocities(std::span<Vec<Dim>> u) const {
    for (std::size_t p = 0; p < stencils_.size(); ++p)
        u[p] = value_at(stencils_[p], nodes_).template head<Dim>().matrix();
}

template <int Dim, PointFunctions functions>
template <class Take>
inline void PointField<Dim, functions>::gather_motion(Take&& take) const {
    for (std::size_t p = 0; p < stencils_.size(); ++p) {
        const Stencil& s = stencils_[p];
        Pack velocity = Pack::Zero(), gradient[Dim];
        for (Pack& column : gradient) column.setZero();
        for_each_row(s, [&](const Row& row) {
            Pack line = Pack::Zero(), slope = Pack::Zero();
            for (std::size_t i = 0; i < width; ++i) {
                line += s.value[0][i] * nodes_[row.node + i];
                slope += s.slope[0][i] * nodes_[row.node + i];
            }
            velocity += row.value * line;
            gradient[0] += row.value * slope;
            for (int a = 1; a < Dim; ++a) gradient[a] += row.slope[a] * line;
        });
        Mat<Dim> L;
        for (int a = 0; a < Dim; ++a) L.col(a) = inverse_h_ * gradient[a].template head<Dim>().matrix();
        take(p, Vec<Dim>(velocity.template head<Dim>().matrix()), L);
    }
}

}  // namespace quern
