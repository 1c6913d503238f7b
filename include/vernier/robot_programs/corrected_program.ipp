// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/robot_programs/corrected_program.hpp"

namespace vernier {

VERNIER_IMPL std::vector<ReplacedTarget> CorrectedProgram::replaced() const {
  std::vector<ReplacedTarget> out;
  for (const CorrectedTarget& target : targets) out.push_back(target.replaced);
  return out;
}

VERNIER_IMPL JointRows<6> CorrectedProgram::commands() const {
  JointRows<6> out(static_cast<Index>(targets.size()), 6);
  for (Index i = 0; i < out.rows(); ++i)
    set_configuration(out, i, targets[static_cast<std::size_t>(i)].replaced.joints);
  return out;
}

VERNIER_IMPL double CorrectedProgram::mean_correction() const {
  double sum = 0;
  for (const CorrectedTarget& target : targets) sum += target.correction;
  return sum / (std::max)(1.0, static_cast<double>(targets.size()));
}

VERNIER_IMPL double CorrectedProgram::largest_correction() const {
  double out = 0;
  for (const CorrectedTarget& target : targets) out = (std::max)(out, target.correction);
  return out;
}

VERNIER_IMPL double CorrectedProgram::largest_predicted_error() const {
  double out = 0;
  for (const CorrectedTarget& target : targets) out = (std::max)(out, target.predicted_error);
  return out;
}

VERNIER_IMPL std::size_t CorrectedProgram::extrapolated() const {
  std::size_t out = 0;
  for (const CorrectedTarget& target : targets) out += target.gate < 1 ? 1 : 0;
  return out;
}

}  // namespace vernier
