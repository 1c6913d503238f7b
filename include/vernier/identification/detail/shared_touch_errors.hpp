// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Errors that many touches share: those of a socket, a face or a ball, and those of the arm's joints, which a geometry
/// alone does not model. Residuals hardly show them, since objects and links absorb them.

#include "vernier/identification/detail/contact_problem.hpp"

namespace vernier::detail {

/// Sizes of errors that touches share.
struct SharedTouchErrors {
  double object = 0.03e-3;  ///< place of a socket or a face, or radius of a ball, standard deviation per component [m]
  double joint = 0.2e-3;    ///< error of a joint once a turn, standard deviation per coefficient [rad]
  double variance = 1;      ///< of the whitened residuals, these errors apart
  MatrixX covariance{};     ///< of the problem's unknowns by these errors, in units of their scales
};

/// What such errors add to the covariance of what touches determine. Joints have harmonics of orders 1 to 3, order k of
/// 1/k of the size. Sizes are those of most evidence. That of objects is held near the expected one, since few objects
/// tell little of it: a factor of two is one standard deviation.
/// @param solved   at its solution
/// @param inverse  of the matrix of its normal equations
/// @param variance of its whitened residuals, where they are taken to be independent
/// @cite MacKay 1992
VERNIER_API SharedTouchErrors shared_touch_errors(const ContactProblem& solved, const MatrixX& inverse,
                                                  double variance);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/shared_touch_errors.ipp"
#endif
