#include "particles/correspondence.hpp"

#include <cmath>

#include "particles/stable_step.hpp"

namespace quern {

namespace {

template <int Dim>
PlasticStrain<Dim> strain_of(const GrainView<Dim>& grain, int i) {
    return grain.plastic.empty() ? PlasticStrain<Dim>{} : grain.plastic[static_cast<std::size_t>(i)];
}

}  // namespace

template <int Dim>
Correspondence<Dim>::Correspondence(const Shape<Dim>& shape, const Material& material,
                                    const KernelChoice& kernel)
    : BondNetwork<Dim>(shape, material, kernel),
      law_{material.bulk_modulus, material.shear_modulus, material.yield_stress, material.hardening_modulus} {
    const Bonds<Dim>& bonds = this->bonds_;
    std::vector<Mat<Dim>> K(bonds.X.size(), Mat<Dim>::Zero());
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            const int j = bonds.partner[b];
            c_.push_back(bonds.weight[b] * bonds.volume[i] * bonds.volume[j]);
            xi_.push_back(bonds.X[j] - bonds.X[i]);
            const Mat<Dim> part = c_.back() * xi_.back() * xi_.back().transpose();
            K[i] += part;
            K[j] += part;
        }
    for (std::size_t i = 0; i < K.size(); ++i) {
        inverse_.push_back(K[i].inverse());
        g_.push_back(material.stabilization * Dim * material.shear_modulus * bonds.volume[i] / K[i].trace());
    }

    const std::size_t n = bonds.X.size();
    std::vector<double> mass(n * Dim);
    for (std::size_t k = 0; k < mass.size(); ++k) mass[k] = material.density * bonds.volume[k / Dim];
    max_frequency_ = quern::max_frequency(mass, [&](const std::vector<double>& u, std::vector<double>& f) {
        // [n * Dim] numbers and [n] vectors are the same memory: Vec<Dim> is Dim packed doubles.
        add_linear_forces({reinterpret_cast<const Vec<Dim>*>(u.data()), n},
                          {reinterpret_cast<Vec<Dim>*>(f.data()), n});
    });
}

template <int Dim>
void Correspondence<Dim>::sum_outer(std::span<const Vec<Dim>> z, std::vector<NodeForce>& sum) const {
    const Bonds<Dim>& bonds = this->bonds_;
    sum.assign(z.size(), NodeForce{});
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        NodeForce here = sum[i];
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            const int j = bonds.partner[b];
            const Vec<Dim> y = z[j] - z[i];
            NodeForce& there = sum[j];
            const double square = c_[b] * y.squaredNorm();
            here.g += square;
            there.g += square;
            for (int k = 0; k < Dim; ++k) {
                const double weighted = c_[b] * xi_[b][k];
                for (int a = 0; a < Dim; ++a) {
                    here.B[Dim * k + a] += weighted * y[a];
                    there.B[Dim * k + a] += weighted * y[a];
                }
            }
        }
        sum[i] = here;
    }
}

template <int Dim>
Mat<Dim> Correspondence<Dim>::gradient(const NodeForce& sum, int i) const {
    const Mat<Dim> outer = Eigen::Map<const Mat<Dim>>(sum.B);
    return outer * inverse_[i];
}

template <int Dim>
double Correspondence<Dim>::softening(double alpha) const {
    if (alpha == 0.0) return 1.0;
    const double secant =
        1.0 / (1.0 + 3.0 * law_.shear_modulus * alpha / (law_.yield_stress + law_.hardening_modulus * alpha));
    return std::max(secant, least_secant);
}

template <int Dim>
typename Correspondence<Dim>::NodeForce Correspondence<Dim>::node_force(const Mat<Dim>& P, const Mat<Dim>& F,
                                                                        double g, int i) const {
    NodeForce node;
    Eigen::Map<Mat<Dim>> B(node.B);
    B = this->bonds_.volume[i] * P * inverse_[i] - g * F;
    node.g = g;
    return node;
}

template <int Dim>
void Correspondence<Dim>::add_bond_forces(std::span<const Vec<Dim>> z, const std::vector<NodeForce>& node,
                                          double factor, std::span<Vec<Dim>> f) const {
    const Bonds<Dim>& bonds = this->bonds_;
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        Vec<Dim> total = Vec<Dim>::Zero();
        const NodeForce here = node[i];
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            const int j = bonds.partner[b];
            const NodeForce& there = node[j];
            Vec<Dim> force = (here.g + there.g) * (z[j] - z[i]);
            for (int k = 0; k < Dim; ++k)
                for (int a = 0; a < Dim; ++a)
                    force[a] += (here.B[Dim * k + a] + there.B[Dim * k + a]) * xi_[b][k];
            force *= factor * c_[b];
            total += force;
            f[j] -= force;
        }
        f[i] += total;
    }
}

template <int Dim>
template <class Visit>
double Correspondence<Dim>::evaluate(const GrainView<Dim>& grain, std::span<Vec<Dim>> f,
                                     Visit&& visit) const {
    thread_local std::vector<NodeForce> node;
    thread_local std::vector<Vec<Dim>> y;
    y.assign(grain.x.begin(), grain.x.end());
    for (Vec<Dim>& position : y) position /= grain.scale;
    sum_outer(y, node);
    double work = 0.0;
    for (int i = 0; i < static_cast<int>(node.size()); ++i) {
        const Mat<Dim> F = gradient(node[i], i);
        const double J = F.determinant();
        const PlasticReturn<Dim> now = return_to_yield<Dim>(strain_of(grain, i), F, J, law_);
        const double g = g_[i] * softening(now.alpha);
        const double uneven = node[i].g - F.cwiseProduct(Eigen::Map<const Mat<Dim>>(node[i].B)).sum();
        if (now.work > 0.0) {
            const PlasticStrain<Dim> before = strain_of(grain, i);
            work += this->bonds_.volume[i] * now.work +
                    0.25 * (g_[i] * softening(before.alpha) - g) * (before.uneven + uneven);
        }
        visit(i, now, F, J, uneven);
        const Mat<Dim> tau = to_matrix<Dim>(kirchhoff_stress<Dim>(J, now.s, law_));
        node[i] = node_force(tau * F.inverse().transpose(), F, g, i);
    }
    add_bond_forces(y, node, std::pow(grain.scale, Dim - 1), f);
    return std::pow(grain.scale, Dim) * work;
}

template <int Dim>
void Correspondence<Dim>::add_internal_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const {
    evaluate(grain, f, [](int, const PlasticReturn<Dim>&, const Mat<Dim>&, double, double) {});
}

template <int Dim>
double Correspondence<Dim>::flow(const GrainView<Dim>& grain, std::span<PlasticStrain<Dim>> plastic,
                                 std::span<Vec<Dim>> f) const {
    const auto keep = [&](int i, const PlasticReturn<Dim>& now, const Mat<Dim>& F, double J, double uneven) {
        PlasticStrain<Dim>& strain = plastic[static_cast<std::size_t>(i)];
        if (now.work > 0.0) strain = plastic_strain<Dim>(now, F, J);
        strain.uneven = uneven;
    };
    return evaluate(grain, f, keep);
}

template <int Dim>
double Correspondence<Dim>::elastic_energy(const GrainView<Dim>& grain) const {
    const Bonds<Dim>& bonds = this->bonds_;
    thread_local std::vector<NodeForce> sum;
    sum_outer(grain.x, sum);
    VonMises elastic = law_;
    elastic.yield_stress = std::numeric_limits<double>::infinity();
    double energy = 0.0;
    for (int i = 0; i < bonds.n_nodes(); ++i) {
        const Mat<Dim> F = gradient(sum[i], i) / grain.scale;
        const double J = F.determinant();
        const PlasticReturn<Dim> now = return_to_yield<Dim>(strain_of(grain, i), F, J, elastic);
        double uneven = 0.0;
        for (const auto [j, b] : bonds.family_of(i)) {
            const Vec<Dim> xi = bonds.X[j] - bonds.X[i];
            const Vec<Dim> z = (grain.x[j] - grain.x[i]) / grain.scale - F * xi;
            uneven += c_[b] * z.squaredNorm();
        }
        energy += bonds.volume[i] * (now.shear_energy + volume_energy(J, law_)) +
                  0.5 * g_[i] * softening(now.alpha) * uneven;
    }
    return std::pow(grain.scale, Dim) * energy;
}

template <int Dim>
void Correspondence<Dim>::compute_stress(const GrainView<Dim>& grain, std::span<double> stress) const {
    thread_local std::vector<NodeForce> sum;
    sum_outer(grain.x, sum);
    for (int i = 0; i < static_cast<int>(sum.size()); ++i) {
        const Mat<Dim> F = gradient(sum[i], i) / grain.scale;
        const double J = F.determinant();
        const PlasticReturn<Dim> now = return_to_yield<Dim>(strain_of(grain, i), F, J, law_);
        SymTensor<Dim> cauchy = kirchhoff_stress<Dim>(J, now.s, law_);
        for (double& component : cauchy) component /= J;
        std::copy(cauchy.begin(), cauchy.end(), stress.begin() + i * n_stress<Dim>);
    }
}

template <int Dim>
void Correspondence<Dim>::add_linear_forces(std::span<const Vec<Dim>> u, std::span<Vec<Dim>> f) const {
    thread_local std::vector<NodeForce> node;
    sum_outer(u, node);
    const double G = law_.shear_modulus, lambda = law_.bulk_modulus - 2.0 / 3.0 * G;
    for (int i = 0; i < static_cast<int>(node.size()); ++i) {
        const Mat<Dim> H = gradient(node[i], i);
        const Mat<Dim> P = lambda * H.trace() * Mat<Dim>::Identity() + G * (H + H.transpose());
        node[i] = node_force(P, H, g_[i], i);
    }
    add_bond_forces(u, node, 1.0, f);
}

template class Correspondence<2>;
template class Correspondence<3>;

}  // namespace quern
