// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The noise of a visit to a pose, estimated from leave-one-pose-out errors by maximum likelihood.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// A pose left out: its error, the covariance that the unknowns give it, and the effect of joint noise of 1.
struct LeftOutVisit {
  Vector3 error;
  Matrix3 model, joint_noise;
};

/// The noise of a visit.
struct VisitNoise {
  double position = 0;  ///< standard deviation in space, per component [m]
  double joint = 0;     ///< of every joint [rad]
  double model = 1;     ///< factor on the covariances of the unknowns; below 1 where priors were wider than the truth
};

/// The maximum-likelihood noise of visits on a grid: isotropic in space, and from joints that do not repeat; and the
/// factor on the unknowns' covariance that the errors support. From 100 visits on, noise is widened, at most to twice
/// its standard deviation, until 95 % of them lie within their 95 % ellipsoids.
VERNIER_API VisitNoise visit_noise(const std::vector<LeftOutVisit>& visits);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/visit_noise.ipp"
#endif
