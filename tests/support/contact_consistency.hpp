// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Whether differences of estimates from contacts are as large as their covariance says.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "vernier/identification/contact_report.hpp"

namespace vernier_test {

/// Sum of squares of normalised differences, and their number.
struct NormalisedSquares {
  double sum = 0;
  int count = 0;
  double rms() const { return std::sqrt(sum / count); }
};

/// Adds the differences of some parameters, along the axes of their covariance in units of their priors; of those axes
/// that the data determine: the standard deviation is below a seventh of the prior's.
inline void add_differences(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance,
                            const Eigen::VectorXd& prior_std, NormalisedSquares& out) {
  const Eigen::MatrixXd unit = prior_std.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(unit * covariance * unit);
  for (Eigen::Index k = 0; k < difference.size(); ++k) {
    const double variance = axes.eigenvalues()(k);
    if (variance > 0.02) continue;
    out.sum += std::pow(axes.eigenvectors().col(k).dot(unit * difference), 2) / variance;
    ++out.count;
  }
}

/// Standard deviation of the prior of a parameter; of the tool, which has hardly one, 0.2 m.
inline double prior_of(const vernier::ParameterEstimate& p) { return std::min(p.prior_std, 0.2); }

}  // namespace vernier_test
