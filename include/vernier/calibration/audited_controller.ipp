#pragma once

#include "vernier/calibration/audited_controller.hpp"

namespace vernier {

VERNIER_IMPL std::optional<ControllerMap> audited_controller(const DataAudit& audit, const ControllerMap& controller,
                                                             int chain_joints) {
  const Index joints = controller.joints(chain_joints);
  MatrixX factors(chain_joints, joints);
  VectorX zeros(chain_joints);
  for (Index i = 0; i < chain_joints; ++i) {
    for (Index j = 0; j < joints; ++j) factors(i, j) = controller.same() ? (i == j ? 1 : 0) : controller.square()(i, j);
    zeros(i) = controller.same() ? 0 : controller.zeros()(i);
  }
  bool found = false;
  for (const DataFinding& finding : audit.findings)  // a coupled joint is taken apart before signs are reversed
    if (finding.kind == FaultKind::joint_coupling) {
      for (Index j = 0; j < joints; ++j) factors(finding.joint, j) -= finding.size * factors(finding.joint - 1, j);
      zeros(finding.joint) -= finding.size * zeros(finding.joint - 1);
      found = true;
    }
  for (const DataFinding& finding : audit.findings)
    if (finding.kind == FaultKind::joint_sign) {
      for (Index j = 0; j < joints; ++j) factors(finding.joint, j) = -factors(finding.joint, j);
      zeros(finding.joint) = -zeros(finding.joint);
      found = true;
    }
  return found ? std::optional<ControllerMap>(ControllerMap(factors, zeros)) : std::nullopt;
}

}  // namespace vernier
