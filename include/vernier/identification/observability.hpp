// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How well poses determine parameters: the five observability indices, strong correlations, and poses that would help.

#include <vector>

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
  VERNIER_API static Observability of(const VectorX& singular_values, Index poses);
};

/// Two unknowns that the data hardly distinguish.
struct Correlation {
  Index first;   ///< position in the covariance
  Index second;  ///< position in the covariance, greater than `first`
  double value;  ///< in [-1, 1]
};

/// Pairs whose correlation is at least `limit` in size, strongest first.
/// @param covariance symmetric, positive diagonal; pairs with a zero diagonal are skipped
/// @param limit      in (0, 1]
VERNIER_API std::vector<Correlation> strong_correlations(const MatrixX& covariance, double limit = 0.95);

/// Candidate poses that would determine one unknown best.
struct HelpfulPoses {
  std::vector<Index> poses;       ///< positions of candidates, best first
  std::vector<double> variances;  ///< of the unknown once each and those before it are measured
};

/// Which of some candidate poses would determine one unknown best, greedily: the pose that reduces its variance most,
/// then the next one given that.
/// @param covariance of the unknowns at present
/// @param candidates whitened rows of each candidate, rows x unknowns
/// @param unknown    position in the covariance
/// @param count      number of poses
/// @complexity       O(count * candidates * unknowns^2)
VERNIER_API HelpfulPoses helpful_poses(MatrixX covariance, const std::vector<MatrixX>& candidates, Index unknown,
                                       int count);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/observability.ipp"
#endif
