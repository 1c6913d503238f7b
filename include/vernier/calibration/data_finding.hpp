// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A fault of measured poses, as an audit reports it.

#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// What is wrong with measured poses, or what they cannot tell.
enum class FaultKind {
  length_unit,             ///< measured positions are in another unit
  joint_unit,              ///< joint angles are in degrees where radians are expected, or the other way round
  joint_sign,              ///< a joint counts in the other direction
  joint_zero,              ///< a joint counts from another zero
  joint_coupling,          ///< a joint's values contain those of the joint before it
  unexplained,             ///< no fault that is known makes the data plausible
  mirrored_frame,          ///< measured coordinates are left-handed
  orientation_convention,  ///< orientations are no rotation vectors, or those of the inverse rotation
  shifted_rows,            ///< joints and poses of some rows are off by one or more rows against each other
  swapped_rows,            ///< the poses of two rows are exchanged
  duplicate_rows,          ///< a measured pose occurs again, in all digits
  outlier,                 ///< the pose of a row is not that of its joints
  joints_read,             ///< joint values scatter about repeated commands: they were read, not commanded
  approach_never_varies,   ///< a joint always comes from the same side
  session_drift            ///< base and sensor move against each other while poses are measured
};

/// One finding of an audit.
struct DataFinding {
  FaultKind kind;             ///< what it is
  int joint = -1;             ///< the joint, from 0; -1 where no single joint is concerned
  std::vector<Index> rows{};  ///< rows concerned, ascending, from 0; empty: all
  /// How large it is: the factor of a unit, the zero [rad, m], the factor of the joint before in a coupled one, the
  /// median position error that nothing explains [m], the number of rows of a shift, the displacement of an
  /// outlier or a drift [m; rad where orientations alone show it], the scatter of a reading [rad, m]; else 0.
  double size = 0;
  std::string message{};  ///< a sentence: what it is, where, and what to do
};

}  // namespace vernier
