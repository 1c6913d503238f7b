// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The step control of Levenberg-Marquardt.

#include "vernier/core/api.hpp"

namespace vernier {

/// Damping of Gauss-Newton steps: a share of the diagonal of the normal equations that is added to it. Lowered by the
/// ratio of actual to predicted decrease where a step succeeds, raised ever faster where steps fail.
/// @cite Levenberg 1944; Marquardt 1963; Nielsen 1999
class MarquardtDamping {
 public:
  /// @param initial damping of the first step, >= 0; from 0, steps are full until one fails
  explicit MarquardtDamping(double initial = 0) : value_(initial) {}

  /// The present damping.
  double value() const { return value_; }
  /// After a step that lowered the sum of squares.
  /// @param actual,predicted decrease, > 0, of the sum and of its quadratic model
  VERNIER_API void accept(double actual, double predicted);
  /// After a step that did not.
  VERNIER_API void reject();

 private:
  double value_, raise_ = 2;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/marquardt_damping.ipp"
#endif
