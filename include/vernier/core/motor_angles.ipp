// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/motor_angles.hpp"
#include "vernier/core/same_value.hpp"

namespace vernier {

VERNIER_IMPL MotorAngles::MotorAngles(const ControllerMap& controller) {
  if (!controller.motor_errors() || controller.same()) return;
  controller_ = controller;
  to_chain_ = controller.square();
  from_chain_ = controller.inverse();
  const Index n = to_chain_.rows();
  zeros_ = VectorX::Zero(n);
  for (Index j = 0; j < n; ++j) {
    int row = 0;
    while (same_value(to_chain_(row, j), 0)) ++row;
    rows_.push_back(row);
    if (j >= controller.joints())  // a passive joint, by its own angle
      for (Index i = 0; i < n; ++i) from_chain_(j, i) = i == row ? 1 : 0;
    for (Index i = 0; i < n && j < controller.joints(); ++i) zeros_(j) -= from_chain_(j, i) * controller.zeros()(i);
  }
}

VERNIER_IMPL void MotorAngles::angles(const double* joints, double* out) const noexcept {
  const Index n = from_chain_.rows();
  for (Index j = 0; j < n; ++j) {
    out[j] = zeros_(j);
    for (Index i = 0; i < n; ++i)
      if (!same_value(from_chain_(j, i), 0)) out[j] += from_chain_(j, i) * joints[i];
  }
}

VERNIER_IMPL MatrixX MotorAngles::angles(const ConstMatrixRef& joints) const {
  MatrixX out = joints;
  if (none()) return out;
  VectorX q(joints.cols()), u(joints.cols());
  for (Index i = 0; i < out.rows(); ++i) {
    for (Index j = 0; j < q.size(); ++j) q(j) = joints(i, j);
    angles(q.data(), u.data());
    for (Index j = 0; j < u.size(); ++j) out(i, j) = u(j);
  }
  return out;
}

VERNIER_IMPL void MotorAngles::add(const double* errors, const double* rates, double* effective,
                                   double* derivative) const noexcept {
  const Index n = to_chain_.rows();
  double of_motors[detail::most_controller_joints];  // a row of S E
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) of_motors[k] = 0;
    for (Index j = 0; j < n; ++j) {
      const double factor = to_chain_(i, j);
      if (same_value(factor, 0)) continue;
      effective[i] += factor * errors[j];
      for (Index k = 0; k < n; ++k) of_motors[k] += factor * rates[n * k + j];
    }
    for (Index c = 0; c < n; ++c)
      for (Index k = 0; k < n; ++k) derivative[n * c + i] += of_motors[k] * from_chain_(k, c);
  }
}

VERNIER_IMPL void MotorAngles::to_motors(double* columns, int rows) const noexcept {
  const Index n = to_chain_.rows();
  double row[detail::most_controller_joints];
  for (int r = 0; r < rows; ++r) {
    for (Index j = 0; j < n; ++j) {
      row[j] = 0;
      for (Index i = 0; i < n; ++i) row[j] += columns[rows * i + r] * to_chain_(i, j);
    }
    for (Index j = 0; j < n; ++j) columns[rows * j + r] = row[j];
  }
}

VERNIER_IMPL void MotorAngles::to_chain_gradient(double* gradient) const noexcept {
  const Index n = from_chain_.rows();
  double of_chain[detail::most_controller_joints];
  for (Index c = 0; c < n; ++c) {
    of_chain[c] = 0;
    for (Index k = 0; k < n; ++k) of_chain[c] += gradient[k] * from_chain_(k, c);
  }
  for (Index c = 0; c < n; ++c) gradient[c] = of_chain[c];
}

}  // namespace vernier
