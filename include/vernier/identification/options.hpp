// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What an identification may estimate.

#include <string>
#include <vector>

#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// Which frames around the chain are unknown.
enum class Frames { none, base, tool, base_and_tool };

/// Options of `identify`. Lengths in m, angles in rad.
struct IdentifyOptions {
  Frames frames = Frames::none;  ///< frames to identify beside the chain
  bool geometry = true;          ///< whether the chain's own parameters are estimated
  bool hayati = true;  ///< where consecutive axes are parallel, estimate beta in place of d (Hayati and Mirmirani 1985)
  std::vector<std::string> fixed{};     ///< parameters, by name, that keep their values bit for bit
  bool priors = true;                   ///< weakly determined chain parameters get priors of the widths below
  double length_prior_std = 1e-3;       ///< expected size of a length error [m]
  double angle_prior_std = 1e-3;        ///< expected size of a twist error [rad]
  double joint_zero_prior_std = 10e-3;  ///< expected size of a joint's zero error [rad]
  int max_iterations = 200;             ///< of the solver

  /// Whether the base is to be identified.
  bool base_free() const { return frames == Frames::base || frames == Frames::base_and_tool; }
  /// Whether the tool is to be identified.
  bool tool_free() const { return frames == Frames::tool || frames == Frames::base_and_tool; }

  /// @param names of all parameters
  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate(const std::vector<std::string>& names) const;
};

namespace detail {

/// `vernier::parallel_rows` of rows whose number is known at run time.
VERNIER_API std::vector<int> parallel_rows(const ChainTable& chain);

}  // namespace detail

/// Rows (from 0) whose axis is nominally parallel to the neighbouring one, where classical parameters are singular:
/// beta is to be estimated in place of d. A last (standard) or first (modified) row has no such neighbour.
/// @cite Hayati and Mirmirani 1985
template <int N, class Convention>
std::vector<int> parallel_rows(const DhChain<N, Convention>& chain) {
  return detail::parallel_rows(detail::ChainTable(chain.view()));
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/options.ipp"
#endif
