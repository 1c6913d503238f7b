// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which of an arm's configurations a target of a robot program means: quadrants, turns and flags of the languages.

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vernier/kinematics/all_branches.hpp"
#include "vernier/robot_programs/program_target.hpp"

namespace vernier {

/// What a controller's joints are called and where its arm bends, as far as its language does not settle it.
struct ControllerArm {
  bool negative_noflip = true;  ///< Fanuc: whether joint 5 is negative where the configuration is N
};

namespace detail {

/// Joint values of which the language's flags are known: RAPID's cfx 0, KRL's S 2, Fanuc's N U T.
VERNIER_API JointVector<6> reference_joints(ProgramLanguage language, const ControllerArm& arm);
/// The factors whose sign differs from the reference: bit 0 shoulder, bit 1 elbow, bit 2 wrist.
VERNIER_API int branch_from(const SingularityDistances& reference, const SingularityDistances& at);
/// The bits of `branch_from` as a configuration states them.
VERNIER_API int stated_branch(ProgramLanguage language, const std::vector<int>& configuration);
/// The bits that a branch must have in common with what is stated; others only choose between several.
VERNIER_API int binding_bits(ProgramLanguage language);
/// Of the values of a joint that differ by whole turns, the one within limits that the configuration means: the
/// nearest to `close_to` where it does not say, or to 0 where `close_to` is not finite. NaN where there is none.
VERNIER_API double stated_turn(ProgramLanguage language, const std::vector<int>& configuration, int joint, double angle,
                               double close_to, double lower, double upper);

}  // namespace detail

/// The configuration with those numbers replaced that joint values contradict: quadrants (RAPID), bits of T for joints
/// more than 2 degrees from 0 (KRL), the last turn number (Fanuc). Flags of the branch stay.
/// @param language      of the program
/// @param configuration as in `ProgramTarget`
/// @param joints        corrected joint values [rad]
VERNIER_API std::vector<int> updated_configuration(ProgramLanguage language, const std::vector<int>& configuration,
                                                   const JointVector<6>& joints);

/// Joint values of a target, or why there are none.
struct ControllerJoints {
  std::optional<JointVector<6>> joints{};  ///< [rad]
  std::string reason{};                    ///< where there are none
};

/// The joint values to which a controller moves for a pose: of all branches and turns those that the configuration
/// states; without one, on the branch of `close_to` the nearest, else the nearest of all.
/// @param roots         of the nominal arm, in the frames of the controller's
/// @param controller    kinematic model that the controller uses
/// @param limits        of its joints
/// @param language      of the program
/// @param arm           what the language leaves open
/// @param pose          base_T_flange
/// @param configuration as in `ProgramTarget`; empty where the program states none
/// @param close_to          joint values before [rad]; not finite where unknown
template <BranchRoots Roots, KinematicModel M>
  requires(Roots::dof == 6 && M::dof == 6)
[[nodiscard]] ControllerJoints controller_joints(const Roots& roots, const M& controller, const JointLimits<6>& limits,
                                                 ProgramLanguage language, const ControllerArm& arm,
                                                 const Isometry3& pose, const std::vector<int>& configuration,
                                                 const JointVector<6>& close_to) {
  const bool known = close_to.allFinite();
  if (configuration.empty() && !known) return {{}, "no configuration, and no joint values before it are known"};
  BranchOptions<6> options{.limits = limits};
  if (known) options.close_to = close_to;
  const Branches<6> found = all_branches(roots, controller, pose, options);
  if (found.count == 0) return {{}, found.describe()};
  if (configuration.empty()) {
    const int branch = roots.distances(close_to).branch();
    const Branch<6>* best = nullptr;
    const auto cost = [&](const Branch<6>& b) {
      return (b.joints - close_to).cwiseAbs().maxCoeff() + (b.singularities.branch() == branch ? 0 : 1e3);
    };
    for (const Branch<6>& b : found)
      if (b.within_limits && (best == nullptr || cost(b) < cost(*best))) best = &b;
    if (best == nullptr) return {{}, "beyond the limits of the joints"};
    return {best->joints, {}};
  }
  const SingularityDistances reference = roots.distances(detail::reference_joints(language, arm));
  const int stated = detail::stated_branch(language, configuration), binding = detail::binding_bits(language);
  ControllerJoints turned, exact;
  int fits = 0, exact_fits = 0;
  for (const Branch<6>& b : found) {
    JointVector<6> q;
    for (int j = 0; j < 6; ++j)
      q(j) =
          detail::stated_turn(language, configuration, j, b.joints(j), close_to(j), limits.lower(j), limits.upper(j));
    if (!q.allFinite()) continue;
    const int differs = detail::branch_from(reference, roots.distances(q)) ^ stated;
    if ((differs & binding) != 0) continue;
    ++fits;
    turned.joints = q;
    if (differs != 0) continue;
    ++exact_fits;
    exact.joints = q;
  }
  if (exact_fits == 1) return exact;
  if (fits == 1) return turned;
  return {{},
          fits == 0 ? "no joint values within the limits have its configuration"
                    : "several joint values have its configuration"};
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/configuration.ipp"
#endif
