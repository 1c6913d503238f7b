// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A chain of any number of joints evaluated at many configurations, several at a time.

#include "vernier/core/types.hpp"
#include "vernier/kinematics/detail/chain_walk.hpp"

namespace vernier::detail {

/// Base and tool frames around a chain, and how their parameters move them; null for none.
struct ChainFrames {
  const double* base = nullptr;       ///< 4 x 4
  const double* point = nullptr;      ///< the tool point in the last link frame
  const double* tool = nullptr;       ///< 4 x 4, whose rotation is that of the tool
  const double* base_rate = nullptr;  ///< 3 x 3, Jacobian of the base frame's rotation vector
  const double* tool_rate = nullptr;  ///< 3 x 3, of the tool frame's

  Placement placement() const { return {base, point}; }
};

/// Where results of n configurations go; null for what is not wanted.
struct BlockResults {
  double* positions = nullptr;   ///< n x 3
  Isometry3* poses = nullptr;    ///< n
  double* joints = nullptr;      ///< n x 6N, Jacobians as in `JacobianRows`
  double* parameters = nullptr;  ///< n x 30N, or n x (30N + 72) with those of base and tool where frames have rates
  double* matrices = nullptr;    ///< n x 16, each pose row by row
};

/// Evaluates a chain at n >= 1 configurations.
/// @param joints n x N, columns `stride` apart
/// @param set    does not change a bit
VERNIER_API void evaluate_chain(const ChainView& chain, const ChainFrames& frames, const double* joints, Index n,
                                Index stride, const BlockResults& results,
                                InstructionSet set = widest_instruction_set());

/// Pose, 4 x 4, and parameter Jacobian, 6 x 5N, at one configuration.
VERNIER_API void chain_parameter_jacobian(const ChainView& chain, const Placement& placement, const double* q,
                                          double* pose, double* jacobian) noexcept;

/// Joint axes, points on them and origins of the link frames at one configuration, each 3 x N, in the base frame.
VERNIER_API void chain_links(const ChainView& chain, const double* q, double* axes, double* points,
                             double* origins) noexcept;

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/chain_blocks.ipp"
#endif
