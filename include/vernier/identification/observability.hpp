#pragma once

/// @file
/// How well poses determine parameters: the five observability indices, strong correlations, and poses that would help.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// The observability indices of m poses: of the singular values s_1 >= ... >= s_L of the Jacobian in steps of expected
/// sizes. Larger is better in all five.
/// @cite Borm and Menq 1991; Driels and Pathre 1990; Nahvi and Hollerbach 1996; Sun and Hollerbach 2008
struct Observability {
  double o1 = 0;  ///< (s_1 ... s_L)^(1/L) / sqrt(m)
  double o2 = 0;  ///< s_L / s_1
  double o3 = 0;  ///< s_L
  double o4 = 0;  ///< s_L^2 / s_1
  double o5 = 0;  ///< 1 / (1/s_1 + ... + 1/s_L)

  /// @param singular_values L >= 1 values, largest first
  /// @param poses           m >= 1
  static Observability of(const VectorX& singular_values, Index poses) {
    require(singular_values.size() >= 1 && poses >= 1, "Observability: ", singular_values.size(),
            " singular values of ", poses, " poses");
    const double largest = singular_values(0), least = singular_values(singular_values.size() - 1);
    if (!(least > 0)) return {};
    return {std::exp(singular_values.array().log().mean()) / std::sqrt(static_cast<double>(poses)), least / largest,
            least, least * least / largest, 1 / singular_values.cwiseInverse().sum()};
  }
};

/// Two unknowns that the data hardly tell apart.
struct Correlation {
  Index first;   ///< position in the covariance
  Index second;  ///< position in the covariance, greater than `first`
  double value;  ///< in [-1, 1]
};

/// Pairs whose correlation is at least `limit` in size, strongest first.
/// @param covariance symmetric, positive diagonal; pairs with a zero diagonal are passed over
/// @param limit      in (0, 1]
inline std::vector<Correlation> strong_correlations(const MatrixX& covariance, double limit = 0.95) {
  std::vector<Correlation> out;
  for (Index j = 0; j < covariance.cols(); ++j)
    for (Index i = 0; i < j; ++i) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      if (scale > 0 && std::abs(covariance(i, j)) >= limit * scale) out.push_back({i, j, covariance(i, j) / scale});
    }
  std::sort(out.begin(), out.end(),
            [](const Correlation& a, const Correlation& b) { return std::abs(a.value) > std::abs(b.value); });
  return out;
}

/// Candidate poses that would determine one unknown best.
struct HelpfulPoses {
  std::vector<Index> poses;       ///< positions of candidates, best first
  std::vector<double> variances;  ///< of the unknown once each and those before it are measured
};

/// Which of some candidate poses would determine one unknown best, greedily: the pose that lowers its variance most,
/// then the next one given that.
/// @param covariance of the unknowns as they stand
/// @param candidates whitened rows of each candidate, rows x unknowns
/// @param unknown    position in the covariance
/// @param count      how many poses to name
/// @complexity       O(count * candidates * unknowns^2)
template <class Rows>
HelpfulPoses helpful_poses(MatrixX covariance, const std::vector<Rows>& candidates, Index unknown, int count) {
  require(unknown >= 0 && unknown < covariance.cols(), "helpful_poses: unknown ", unknown, " of ", covariance.cols());
  HelpfulPoses out;
  for (int k = 0; k < count; ++k) {
    double best = 0;
    Index at = -1;
    for (Index c = 0; c < static_cast<Index>(candidates.size()); ++c) {
      const Rows& rows = candidates[static_cast<std::size_t>(c)];
      const MatrixX cross = rows * covariance;
      const Eigen::LLT<MatrixX> inner(MatrixX::Identity(rows.rows(), rows.rows()) + cross * rows.transpose());
      const double gain = inner.matrixL().solve(cross.col(unknown)).squaredNorm();
      if (gain <= best) continue;
      best = gain;
      at = c;
    }
    if (at < 0) break;
    const Rows& rows = candidates[static_cast<std::size_t>(at)];
    const MatrixX cross = rows * covariance;
    const MatrixX inner = MatrixX::Identity(rows.rows(), rows.rows()) + cross * rows.transpose();
    covariance -= cross.transpose() * inner.llt().solve(cross);
    out.poses.push_back(at);
    out.variances.push_back(covariance(unknown, unknown));
  }
  return out;
}

}  // namespace vernier
