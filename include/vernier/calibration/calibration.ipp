// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/LU>
#include <cmath>

#include "vernier/calibration/calibration.hpp"

namespace vernier::detail {

VERNIER_IMPL double normalised_error(const Vector3& error, const Matrix3& covariance) {
  const Matrix3 weight = covariance.inverse();
  const Vector3 weighted = weight * error;
  return std::sqrt(error.dot(weighted));
}

}  // namespace vernier::detail
