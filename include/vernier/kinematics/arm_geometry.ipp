// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>

#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

VERNIER_IMPL VectorX ArmGeometry::parameters() const {
  VectorX out(num_parameters());
  double* next = std::copy_n(base_.values().data(), 6, out.data());
  for (const DhRow& row : chain_.rows())
    for (const double value : {row.a, row.alpha, row.d, row.theta, row.beta}) *next++ = value;
  std::copy_n(tool_.values().data(), 6, next);
  return out;
}

VERNIER_IMPL ArmGeometry ArmGeometry::with_parameters(const ConstVectorRef& values) const {
  demand(values.size() == num_parameters(), "ArmGeometry: ", values.size(), " parameters, expected ", num_parameters());
  const auto frame = [](const FrameParameters& old, const double* now) {
    return std::equal(now, now + 6, old.values().data()) ? old : FrameParameters(Vector6(now));
  };
  std::vector<DhRow> rows = chain_.rows();
  for (int i = 0; i < joints(); ++i) {
    const double* p = values.data() + ArmParameters::of_row(i, DhParameter::a);
    DhRow& row = rows[static_cast<std::size_t>(i)];
    row = {p[0], p[1], p[2], p[3], p[4], row.joint};
  }
  return {detail::ChainTable(std::move(rows), chain_.modified()), frame(base_, values.data()),
          frame(tool_, values.data() + values.size() - 6)};
}

VERNIER_IMPL std::vector<std::string> ArmGeometry::parameter_names() const {
  return detail::framed_names(detail::chain_parameter_names(joints()));
}

VERNIER_IMPL std::vector<ParameterKind> ArmGeometry::parameter_kinds() const {
  return detail::framed_kinds(detail::chain_parameter_kinds(joints()));
}

VERNIER_IMPL PointRows ArmGeometry::positions(const ConstMatrixRef& joints) const {
  PointRows out(joints.rows(), 3);
  const Vector3 point = tool_.isometry().translation();
  detail::evaluate_chain(chain_.view(), {.base = base_.isometry().data(), .point = point.data()}, joints.data(),
                         joints.rows(), joints.outerStride(), {.positions = out.data()});
  return out;
}

VERNIER_IMPL std::vector<Isometry3> ArmGeometry::poses(const ConstMatrixRef& joints) const {
  std::vector<Isometry3> out(static_cast<std::size_t>(joints.rows()));
  detail::evaluate_chain(
      chain_.view(), {.base = base_.isometry().data(), .point = tool_.values().data(), .tool = tool_.isometry().data()},
      joints.data(), joints.rows(), joints.outerStride(), {.poses = out.data()});
  return out;
}

VERNIER_IMPL void ArmGeometry::poses_and_parameter_jacobians(const ConstMatrixRef& joints,
                                                             PosesAndJacobians& out) const {
  out.resize(joints.rows(), num_parameters());
  detail::evaluate_chain(chain_.view(),
                         {base_.isometry().data(), tool_.values().data(), tool_.isometry().data(),
                          base_.rotation_vector_jacobian().data(), tool_.rotation_vector_jacobian().data()},
                         joints.data(), joints.rows(), joints.outerStride(),
                         {.poses = out.poses.data(), .parameters = out.jacobians.data()});
}

}  // namespace vernier
