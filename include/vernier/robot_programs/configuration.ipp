// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numbers>

#include "vernier/robot_programs/configuration.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL JointVector<6> reference_joints(ProgramLanguage language, const ControllerArm& arm) {
  constexpr double quarter = std::numbers::pi / 2;
  JointVector<6> q = JointVector<6>::Zero();
  q(4) = 0.5;
  if (language == ProgramLanguage::krl) {
    q(1) = -quarter;
    q(2) = quarter;
  }
  if (language == ProgramLanguage::fanuc_tp && arm.negative_noflip) q(4) = -0.5;
  return q;
}

VERNIER_IMPL int branch_from(const SingularityDistances& reference, const SingularityDistances& at) {
  return reference.branch() ^ at.branch();
}

VERNIER_IMPL int stated_branch(ProgramLanguage language, const std::vector<int>& configuration) {
  const auto bit_moved = [](int value, int from, int to) { return (value >> from & 1) << to; };
  switch (language) {
    case ProgramLanguage::rapid: {
      const int cfx = configuration[3];
      return bit_moved(cfx, 2, 0) | bit_moved(cfx, 1, 1) | bit_moved(cfx, 0, 2);
    }
    case ProgramLanguage::krl: {
      const int status = configuration[0];
      return bit_moved(status, 0, 0) | bit_moved(~status, 1, 1) | bit_moved(status, 2, 2);
    }
    case ProgramLanguage::fanuc_tp: return (1 - configuration[2]) | (1 - configuration[1]) << 1 | configuration[0] << 2;
    default: return 0;
  }
}

VERNIER_IMPL int binding_bits(ProgramLanguage language) {
  switch (language) {
    case ProgramLanguage::krl: return 3;       // T states the sign of A5
    case ProgramLanguage::fanuc_tp: return 7;  // its turn numbers state no signs
    default: return 0;                         // cfx depends on the type of robot
  }
}

/// The interval of a joint's values that a configuration states [rad]; without bounds where it does not.
VERNIER_LOCAL JointRange stated_interval(ProgramLanguage language, const std::vector<int>& configuration, int joint);

VERNIER_IMPL JointRange stated_interval(ProgramLanguage language, const std::vector<int>& configuration, int joint) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  constexpr double quarter = std::numbers::pi / 2, half = std::numbers::pi;
  switch (language) {
    case ProgramLanguage::rapid: {
      const int entry = joint == 0 ? 0 : joint == 3 ? 1 : joint == 5 ? 2 : -1;
      if (entry < 0) break;
      const double lower = quarter * configuration[static_cast<std::size_t>(entry)];
      return {lower, lower + quarter};
    }
    case ProgramLanguage::krl:
      return (configuration[1] >> joint & 1) != 0 ? JointRange{-infinite, 0} : JointRange{0, infinite};
    case ProgramLanguage::fanuc_tp: {
      const int entry = joint == 0 || joint == 3 ? 3 : joint == 5 ? 5 : -1;
      if (entry < 0) break;
      const double turn = 2 * half * configuration[static_cast<std::size_t>(entry)];
      return {turn - half, turn + half};
    }
    default: break;
  }
  return {-infinite, infinite};
}

VERNIER_IMPL double stated_turn(ProgramLanguage language, const std::vector<int>& configuration, int joint,
                                double angle, double close_to, double lower, double upper) {
  constexpr double whole = 2 * std::numbers::pi, degree = std::numbers::pi / 180;
  const double tolerance = language == ProgramLanguage::krl ? 2 * degree : 0.05 * degree;
  const JointRange stated = stated_interval(language, configuration, joint);
  const double centre = std::isfinite(close_to) ? close_to : 0;
  double best = std::numeric_limits<double>::quiet_NaN(), best_cost = std::numeric_limits<double>::infinity();
  for (int turn = -4; turn <= 4; ++turn) {
    const double q = angle + whole * turn;
    if (!(q >= lower - 1e-6 && q <= upper + 1e-6)) continue;
    const double outside = (std::max)({0.0, stated.lower - q, q - stated.upper});
    if (outside > tolerance) continue;
    const double cost = (outside > 1e-9 ? 1e-6 : 0) + std::abs(q - centre);
    if (cost < best_cost) {
      best = q;
      best_cost = cost;
    }
  }
  return best;
}

}  // namespace detail

VERNIER_IMPL std::vector<int> updated_configuration(ProgramLanguage language, const std::vector<int>& configuration,
                                                    const JointVector<6>& joints) {
  constexpr double quarter = std::numbers::pi / 2, slack = 1e-7;
  std::vector<int> out = configuration;
  const auto outside = [&](int joint, double tolerance) {
    const JointRange stated = detail::stated_interval(language, configuration, joint);
    return joints(joint) < stated.lower - tolerance || joints(joint) > stated.upper + tolerance;
  };
  if (language == ProgramLanguage::rapid && configuration.size() == 4) {
    const int joint[3] = {0, 3, 5};
    for (std::size_t k = 0; k < 3; ++k)
      if (outside(joint[k], slack)) out[k] = static_cast<int>(std::floor(joints(joint[k]) / quarter));
  } else if (language == ProgramLanguage::krl && configuration.size() == 2) {
    for (int j = 0; j < 6; ++j)
      if (outside(j, 2 * std::numbers::pi / 180)) out[1] ^= 1 << j;
  } else if (language == ProgramLanguage::fanuc_tp && configuration.size() == 6) {
    if (outside(5, slack)) out[5] = static_cast<int>(std::floor(joints(5) / (4 * quarter) + 0.5));
  }
  return out;
}

}  // namespace vernier
