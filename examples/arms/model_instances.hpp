// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The arm of a model file, read, written and commanded, for all numbers of joints: declared here, and compiled once,
/// in the library `vernier_instances`.

#include "dispatch.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"

/// These functions, as instances that are declared (`extern template`) or defined (`template`).
#define VERNIER_MODEL_INSTANCES(keyword, N)                                                                          \
  keyword CalibratedRobot<N> detail::robot_of<N, StandardDh>(const detail::ModelData&);                              \
  keyword detail::ModelData detail::model_data<N, StandardDh>(const CalibratedRobot<N>&);                            \
  keyword ErrorModel<DhChain<N>> CalibratedRobot<N>::by_values(const ErrorModel<DhChain<N>>&);                       \
  keyword CorrectedPath<N> detail::correct_path<detail::NoClosedForm, InControllerJoints<CalibratedRobot<N>>>(       \
      const InControllerJoints<CalibratedRobot<N>>&, const detail::NoClosedForm&, const std::vector<PathTarget<N>>&, \
      const PathOptions<N>&);

namespace vernier {

#define VERNIER_DECLARE(N) VERNIER_MODEL_INSTANCES(extern template, N)
VERNIER_FOR_ALL_DOF(VERNIER_DECLARE)
#undef VERNIER_DECLARE

}  // namespace vernier
