// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

#include "vernier/core/rng.hpp"
#include "vernier/identification/commanded_parameters.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/identifiable_parameters.hpp"

namespace vernier {

VERNIER_IMPL std::vector<std::string> unseen_parameters(const ArmGeometry& nominal, const ControllerMap& controller,
                                                        const IdentifyOptions& options) {
  std::vector<std::string> out;
  const int joints = controller.joints(nominal.joints());
  if (joints == nominal.joints()) return out;
  std::vector<JointType> types;
  for (const DhRow& row : nominal.chain().rows()) types.push_back(row.joint);
  types = controller.types(types);
  constexpr Index samples = 60;
  Rng rng(1);
  MatrixX shown(samples, joints);
  for (Index i = 0; i < samples; ++i)
    for (Index j = 0; j < joints; ++j) {
      const double widest = types[static_cast<std::size_t>(j)] == JointType::revolute ? std::numbers::pi : 0.5;
      shown(i, j) = rng.uniform(-widest, widest);
    }
  const detail::IdentificationPlan plan(nominal, options);
  // frames anywhere: at the nominal ones, the measured point may lie on the last axis
  const FrameParameters base(Vector6{0.3, -0.2, 0.1, 0.2, -0.3, 0.4}), tool(Vector6{0.05, 0.07, 0.03, 0.3, 0.2, -0.1});
  PosesAndJacobians at;
  nominal.with_frames(base, tool).poses_and_parameter_jacobians(controller.to_chain(shown), at);
  MatrixX jacobian(6 * samples, static_cast<Index>(plan.candidates.size()));
  for (Index i = 0; i < samples; ++i)
    for (Index c = 0; c < jacobian.cols(); ++c) {
      const Index parameter = plan.candidates[static_cast<std::size_t>(c)];
      for (Index r = 0; r < 6; ++r)
        jacobian(6 * i + r, c) = plan.scales(parameter) * at.jacobians(i, 6 * parameter + r);
    }
  for (const auto& dependent : IdentifiableParameters(jacobian).dependent)
    out.push_back(plan.names[static_cast<std::size_t>(plan.candidates[static_cast<std::size_t>(dependent.column)])]);
  return out;
}

}  // namespace vernier
