// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vernier/calibration/pose_advice.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/identification/observability.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<PoseAdvice> pose_advice(const ErrorModelEstimate& estimate,
                                                 const IdentificationReport& identification, const VectorX& lower,
                                                 const VectorX& upper, const SensorModel& sensors, bool oriented,
                                                 std::size_t max_parameters, int poses,
                                                 const ControllerMap& controller) {
  std::vector<PoseAdvice> out;
  const std::vector<std::string> weak = identification.names(ParameterState::weak);
  if (weak.empty()) return out;
  constexpr Index candidates = 200;
  const ArmGeometry& arm = estimate.arm.geometry(0);
  Rng rng(1);
  std::vector<JointType> types;
  for (const DhRow& row : arm.chain().rows()) types.push_back(row.joint);
  types = controller.types(types);
  MatrixX shown(candidates, static_cast<Index>(types.size()));
  for (Index c = 0; c < candidates; ++c)
    for (Index i = 0; i < shown.cols(); ++i) {
      const double widest = types[static_cast<std::size_t>(i)] == JointType::revolute ? std::numbers::pi : 0.5;
      shown(c, i) = rng.uniform((std::max)(lower(i), -widest), (std::min)(upper(i), widest));
    }
  const MatrixX joints = controller.to_chain(shown);
  std::vector<RowBlock> blocks(candidates);
  estimate.arm.linearise(0, joints, MatrixX(), blocks.data());
  std::vector<MatrixX> rows;
  for (const RowBlock& block : blocks) {
    MatrixX& whitened = rows.emplace_back(oriented ? 6 : 3, block.dense.cols());
    for (Index c = 0; c < whitened.cols(); ++c)
      for (Index v = 0; v < whitened.rows(); ++v)
        whitened(v, c) = block.dense(v, c) / (v < 3 ? sensors.position_sigma : sensors.orientation_sigma);
  }
  const Index dense = estimate.arm.num_dense();
  const std::vector<std::string> names = estimate.arm.names();
  const VectorX scales = estimate.arm.scales();
  for (const std::string& name : weak) {
    const Index at = std::find(names.begin(), names.end(), name) - names.begin();
    if (at >= dense || out.size() == max_parameters) continue;
    const HelpfulPoses helpful =
        helpful_poses(VERNIER_LATER(estimate.covariance).topLeftCorner(dense, dense), rows, at, poses);
    if (helpful.poses.empty()) continue;
    const Index parameter = estimate.arm.geometric()[static_cast<std::size_t>(at)].parameter;
    PoseAdvice advice{name,
                      identification.parameters[static_cast<std::size_t>(parameter)].kind,
                      std::sqrt(estimate.covariance(at, at)) * scales(at),
                      std::sqrt(helpful.variances.back()) * scales(at),
                      {},
                      types};
    for (const Index pose : helpful.poses) advice.poses.push_back(row_of(shown, pose));
    out.push_back(std::move(advice));
  }
  return out;
}

}  // namespace vernier::detail
