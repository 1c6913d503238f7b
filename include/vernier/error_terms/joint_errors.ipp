// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_terms/joint_errors.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL void compose_jacobian(const double* jacobian, const double* derivative, int n, double* out) noexcept {
  for (int j = 0; j < n; ++j) {
    double sum[6] = {};
    for (int k = 0; k < n; ++k)
      for (int r = 0; r < 6; ++r) sum[r] += jacobian[6 * k + r] * derivative[n * j + k];
    for (int r = 0; r < 6; ++r) out[6 * j + r] = sum[r];
  }
}

}  // namespace detail

VERNIER_IMPL JointErrors::JointErrors(JointTerms terms, VectorX coefficients)
    : terms_(std::move(terms)), coefficients_(std::move(coefficients)) {
  demand(terms_.transmission.size() == static_cast<std::size_t>(terms_.joints), "JointErrors: transmissions of ",
         terms_.transmission.size(), " joints, expected ", terms_.joints);
  demand(!terms_.gravity || terms_.gravity->joints() == terms_.joints, "JointErrors: gravity compliance of ",
         terms_.gravity ? terms_.gravity->joints() : 0, " joints, expected ", terms_.joints);
  demand(!terms_.payload || terms_.payload->joints() == terms_.joints, "JointErrors: compliance to payload of ",
         terms_.payload ? terms_.payload->joints() : 0, " joints, expected ", terms_.joints);
  demand(!terms_.bend || (terms_.payload && terms_.bend->joints() == terms_.joints), "JointErrors: bends of ",
         terms_.bend ? terms_.bend->joints() : 0, " joints, expected ", terms_.joints,
         " beside compliances to payload");
  demand(!terms_.tilt || terms_.tilt->joints() == terms_.joints, "JointErrors: tilts of ",
         terms_.tilt ? terms_.tilt->joints() : 0, " joints, expected ", terms_.joints);
  demand(!terms_.straightness || terms_.straightness->joints() == terms_.joints, "JointErrors: straightness of ",
         terms_.straightness ? terms_.straightness->joints() : 0, " joints, expected ", terms_.joints);
  for (const Fourier& fourier : terms_.transmission) fourier.validate();
  demand(terms_.motors.none() || terms_.motors.controller().chain_joints() == terms_.joints, "JointErrors: motors of ",
         terms_.motors.controller().chain_joints(), " joints, expected ", terms_.joints);
  demand(terms_.linear_ranges.empty() || terms_.linear_ranges.size() == static_cast<std::size_t>(terms_.joints),
         "JointErrors: linear ranges of ", terms_.linear_ranges.size(), " joints, expected ", terms_.joints);
  for (const JointRange& range : terms_.linear_ranges)
    demand(range.lower <= range.upper, "JointErrors: a linear range ends at ", range.upper, ", below its start");
  for (const double width : terms_.hysteresis)
    demand(width > 0 && std::isfinite(width), "JointErrors: a width of the hysteresis is ", width,
           ", must be positive");
  demand(coefficients_.size() == terms_.size(), "JointErrors: ", coefficients_.size(), " coefficients for ",
         terms_.size(), " terms");
  demand(detail::all_finite(coefficients_), "JointErrors: a coefficient is not finite");
  const Index dense = terms_.num_dense_terms();
  harmonics_ = {terms_.transmission, {coefficients_.data() + dense, coefficients_.data() + coefficients_.size()}};
}

VERNIER_IMPL JointErrors JointErrors::carrying(const Payload& payload) const {
  return terms_.payload ? under(terms_.payload->load(payload)) : *this;
}

VERNIER_IMPL void JointErrors::evaluate(const double* q, int n, double* effective, double* derivative,
                                        const double* previous, const PayloadLoad* load) const noexcept {
  std::copy_n(q, n, effective);
  std::fill_n(derivative, n * n, 0.0);
  for (int i = 0; i < n; ++i) derivative[i * n + i] = 1;
  if (empty()) return;
  terms_.add_dense(q, previous, load != nullptr ? *load : load_, coefficients_.data(), effective, derivative);
  if (terms_.motors.none()) {
    harmonics_.add(q, n, effective, derivative);
    return;
  }
  double angles[max_joints], errors[max_joints], rates[max_joints * max_joints];
  std::fill_n(errors, n, 0.0);
  std::fill_n(rates, n * n, 0.0);
  terms_.motors.angles(q, angles);
  harmonics_.add(angles, n, errors, rates);
  terms_.motors.add(errors, rates, effective, derivative);
}

VERNIER_IMPL MatrixX JointErrors::effective_rows(const ConstMatrixRef& joints, const ConstMatrixRef& previous,
                                                 std::span<const PayloadLoad> loads) const {
  const auto n = static_cast<int>(joints.cols());
  MatrixX out(joints.rows(), joints.cols());
  VectorX q(n), before(n), effective(n), derivative(n * n);
  for (Index i = 0; i < joints.rows(); ++i) {
    for (Index j = 0; j < n; ++j) {
      q(j) = joints(i, j);
      if (previous.rows() > 0) before(j) = previous(i, j);
    }
    evaluate(q.data(), n, effective.data(), derivative.data(), previous.rows() > 0 ? before.data() : nullptr,
             loads.empty() ? nullptr : &loads[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < n; ++j) out(i, j) = effective(j);
  }
  return out;
}

VERNIER_IMPL double JointErrors::half_loop(int i) const noexcept {
  double sum = 0, largest = 0;  // narrow steps saturate first
  for (const JointTermBlock& block : terms_.blocks())
    for (Index k = i; block.kind == JointTermBlock::Kind::hysteresis && k < block.count; k += terms_.joints) {
      sum += coefficients_(block.begin + k);
      largest = (std::max)(largest, std::abs(sum));
    }
  return largest;
}

VERNIER_IMPL void JointErrors::tilt(const double* q, Isometry3& pose, double* jacobian) const noexcept {
  if (!tilts()) return;
  const int n = terms_.joints;
  double rates[6 * max_joints];
  const Vector6 motion =
      terms_.end_motion(q, load_, coefficients_.data() + terms_.end_begin(), jacobian != nullptr ? rates : nullptr);
  const Vector3 shift = VERNIER_LATER(motion).template head<3>(), turn = VERNIER_LATER(motion).template tail<3>();
  const Matrix3 rotation = exp_so3(turn);
  const Vector3 turned = rotation * translation(pose);
  pose = composed(rigid_motion(rotation, shift), pose);
  if (jacobian == nullptr) return;
  const Matrix3 rate_of_rotation = left_jacobian_so3(turn);
  for (int k = 0; k < n; ++k) {
    double* column = jacobian + 6 * k;
    const double* rate = rates + 6 * k;
    const Vector3 omega = rate_of_rotation * Vector3(rate[3], rate[4], rate[5]), swept = omega.cross(turned);
    const Vector3 linear = rotation * Vector3(column[0], column[1], column[2]);
    const Vector3 angular = rotation * Vector3(column[3], column[4], column[5]);
    for (Index r = 0; r < 3; ++r) {
      column[r] = linear(r) + swept(r) + rate[r];
      column[3 + r] = angular(r) + omega(r);
    }
  }
}

VERNIER_IMPL double JointErrors::transmission(int i, double q) const noexcept {
  if (empty()) return 0;
  return terms_.transmission[static_cast<std::size_t>(i)]
      .sum(q, coefficients_.data() + terms_.transmission_begin(i))
      .value;
}

}  // namespace vernier
