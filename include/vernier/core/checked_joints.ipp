// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/checked_joints.hpp"

namespace vernier::detail {

VERNIER_IMPL [[noreturn]] void refuse_joint_values(Index values, int joints) {
  throw std::invalid_argument(
      message(counted(values, "joint value", "joint values"), " for an arm of ", counted(joints, "joint", "joints")));
}

}  // namespace vernier::detail
