// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The roots of an arm's inverse kinematics that suit its geometry, in the joints of its controller.

#include <optional>
#include <stdexcept>

#include "vernier/core/same_value.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/general_six_axis.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace support {

/// Calls `use` with the roots of an arm of six joints that move, in the controller's joints; with null for other arms,
/// whose branch is followed.
/// @param nominal between its frames
/// @param change  how its joints follow from those of the controller
/// @param limits  equal ones hold a joint
template <class Nominal, int N, class Use>
void with_branches([[maybe_unused]] const Nominal& nominal, [[maybe_unused]] const vernier::JointChange<N>& change,
                   [[maybe_unused]] const vernier::JointLimits<N>& limits, const Use& use) {
  if constexpr (N == 6 || N == 7) {
    const auto made = [&]<class Roots>(std::optional<Roots>& roots, const auto&... held) {
      try {
        roots.emplace(nominal, held...);
      } catch (const std::invalid_argument&) {  // another geometry
      }
      return roots.has_value();
    };
    const auto used = [&](const auto&... held) {
      if (std::optional<vernier::ClosedForm<N>> closed_form; made(closed_form, held...)) {
        use(vernier::RootsInControllerJoints<vernier::ClosedForm<N>>(*closed_form, change));
        return true;
      }
      if (std::optional<vernier::GeneralSixAxis<N>> general; made(general, held...)) {
        use(vernier::RootsInControllerJoints<vernier::GeneralSixAxis<N>>(*general, change));
        return true;
      }
      return false;
    };
    if constexpr (N == 6) {
      if (used()) return;
    } else {
      for (int k = 0; k < N; ++k) {
        const int j = change.alone(k);
        if (j < 0 || j >= change.moving() || !vernier::same_value(limits.lower(j), limits.upper(j))) continue;
        vernier::JointVector<N> at = vernier::JointVector<N>::Zero();
        at(j) = limits.lower(j);
        if (used(vernier::HeldJoint{k, change.to_chain(at)(k)})) return;
      }
    }
  }
  use(nullptr);
}

}  // namespace support
