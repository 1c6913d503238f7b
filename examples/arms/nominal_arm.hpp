// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An arm as designed whose number of joints is known at run time: rows of joint values in, rows of poses out.

#include <memory>
#include <string>
#include <vector>

#include "rows_view.hpp"
#include "vernier/core/executor.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"

namespace support {

/// How joint values are looked for.
struct IkSettings {
  bool position_only = false;  ///< the orientation is free
  double tolerance = 1e-9;     ///< [m, rad]
  int restarts = 0;            ///< further starts within the limits
};

/// Joint values that were found, a row a target.
struct IkRows {
  double* joints;             ///< n x joints [rad, m]
  vernier::IkStatus* status;  ///< n
  double* position_error;     ///< n [m]
  double* rotation_error;     ///< n [rad]
};

/// Branches of one target.
struct BranchRows {
  std::vector<std::vector<double>> joints{};  ///< one a branch [rad, m]
  std::vector<bool> within_limits{};          ///< whether all joints are
  std::vector<int> branch{};                  ///< its number, from 0: shoulder, elbow and wrist
  std::string reach{};                        ///< what became of the target, in a sentence
};

/// An arm as designed, between its frames. Joint values are those of the controller, n x joints; poses are n x 16,
/// row by row, in the base frame. Rows are independent, and may be computed on several threads.
class NominalArm {
 public:
  virtual ~NominalArm() = default;

  /// Number of joints of the controller.
  virtual int joints() const = 0;
  /// Poses of the tool, n x 16.
  virtual void poses(RowsView q, double* out, vernier::ExecutorRef executor) const = 0;
  /// Positions of the tool, n x 3 [m].
  virtual void positions(RowsView q, double* out, vernier::ExecutorRef executor) const = 0;
  /// Geometric Jacobians, n x 6 x joints, linear rows first.
  virtual void jacobians(RowsView q, double* out, vernier::ExecutorRef executor) const = 0;
  /// Joint values that reach poses.
  /// @param targets n x 16
  /// @param seeds   n x joints, or one row for all
  virtual void inverse(RowsView targets, RowsView seeds, const IkSettings& settings, const IkRows& out,
                       vernier::ExecutorRef executor) const = 0;
  /// All branches of a pose, of an arm of six joints that move.
  /// @param target   16 numbers
  /// @param close_to joint values near which whole turns are chosen; null: zero
  /// @param held     joint that is held at its value in `close_to`, from 0; -1: none
  /// @throws std::invalid_argument for another arm
  virtual BranchRows branches(const double* target, const double* close_to, int held) const = 0;
};

/// The arm of a description.
/// @throws std::invalid_argument for a number of joints outside 1 .. 9
std::shared_ptr<const NominalArm> nominal_arm(const vernier::RobotDescription& description);

/// Instances for N joints, which the other calls: compiled in a file each.
template <int N>
std::shared_ptr<const NominalArm> nominal_arm_of(const vernier::RobotDescription& description);

}  // namespace support
