#include "particles/stable_step.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdint>

namespace quern {

double max_frequency(const std::vector<double>& mass,
                     const std::function<void(const std::vector<double>&, std::vector<double>&)>& add_force) {
    const auto n = static_cast<Eigen::Index>(mass.size());
    const Eigen::VectorXd root = Eigen::Map<const Eigen::VectorXd>(mass.data(), n).cwiseSqrt();

    Eigen::VectorXd q(n);
    std::uint64_t state = 0x9E3779B97F4A7C15u;
    for (Eigen::Index k = 0; k < n; ++k) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        q[k] = static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
    }
    q.normalize();

    // q_k M^(-1/2) K M^(-1/2) q_l is tridiagonal: `diagonal` and `beside` grow by one entry a round.
    const Eigen::Index rounds = std::min<Eigen::Index>(200, n);
    Eigen::VectorXd diagonal(rounds), beside(rounds), before = Eigen::VectorXd::Zero(n);
    std::vector<double> u(mass.size()), f(mass.size());
    double top = 0.0, residual = 0.0;
    for (Eigen::Index round = 0; round < rounds; ++round) {
        Eigen::Map<Eigen::VectorXd>(u.data(), n) = q.cwiseQuotient(root);
        std::fill(f.begin(), f.end(), 0.0);
        add_force(u, f);
        Eigen::VectorXd next = -Eigen::Map<const Eigen::VectorXd>(f.data(), n).cwiseQuotient(root);
        if (round > 0) next -= beside[round - 1] * before;
        diagonal[round] = q.dot(next);
        next -= diagonal[round] * q;
        beside[round] = next.norm();

        const Eigen::Index size = round + 1;
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> small;
        small.computeFromTridiagonal(diagonal.head(size), beside.head(size - 1));
        top = small.eigenvalues()[size - 1];
        residual = beside[round] * std::abs(small.eigenvectors()(size - 1, size - 1));
        if (residual <= 0.01 * top || beside[round] == 0.0) break;
        before = q;
        q = next / beside[round];
    }
    return std::sqrt(top + residual);
}

double critical_step(double omega, double bond_damping) {
    const double zeta = 0.5 * bond_damping * omega;
    return 2.0 / omega * (std::sqrt(1.0 + zeta * zeta) - zeta);
}

}  // namespace quern
