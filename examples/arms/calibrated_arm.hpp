// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A calibrated arm whose number of joints is known at run time: rows of joint values in, poses and commands out.

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measured_data.hpp"
#include "rows_view.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/core/executor.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

/// Corrected commands, a row each.
struct CorrectionRows {
  double* command;            ///< n x joints [rad, m]
  vernier::IkStatus* status;  ///< n
  double* predicted_error;    ///< n [m]
  double* gate;               ///< n
};

/// A path to be corrected; joint values are those of the controller.
struct PathTask {
  RowsView poses{};                 ///< n x 16; none: those of the nominal arm at `joints`
  RowsView joints{};                ///< n x joints, near which the branch is chosen; NaN, or none, where any will do
  std::vector<bool> linear{};       ///< n: whether the tool moves there along a line; empty: no move is
  std::vector<double> start{};      ///< joint values before the first target; empty: unknown
  double tolerance = 0.05e-3;       ///< distance of the tool from the line of a linear move [m]
  double max_joint_step = 0.5;      ///< between commands of a linear move [rad, m]
  bool approach = true;             ///< whether each command is for the approach from the one before
  vernier::ObserverRef observer{};  ///< see `vernier::PathOptions`
};

/// A corrected path, a row a point.
struct PathRows {
  std::vector<double> commands{};              ///< n x joints
  std::vector<vernier::Index> target{};        ///< the target it reaches, or towards which it was inserted
  std::vector<bool> inserted{};                ///< whether it lies on the way
  std::vector<vernier::PointStatus> status{};  ///< what became of it
  std::vector<double> predicted_error{};       ///< [m]
  std::vector<double> deviation{};             ///< of the tool from the line, as the model predicts [m]
  double before = 0;                           ///< largest deviation, were the ends alone corrected [m]
  double after = 0;                            ///< largest deviation with the inserted points [m]
};

/// A calibrated arm in joints of its controller. Poses are n x 16, row by row, in the frame of the measurements. Rows
/// are independent, and may be computed on several threads; `previous` has the joint values from which each row is
/// approached: as many rows, or none.
class CalibratedArm {
 public:
  virtual ~CalibratedArm() = default;

  /// Number of joints of the controller.
  virtual int joints() const = 0;
  /// Name of the arm.
  virtual const std::string& name() const = 0;
  /// Where the calibration comes from.
  virtual const vernier::Provenance& provenance() const = 0;
  /// Whether its covariance was kept.
  virtual bool has_covariance() const = 0;
  /// The model file, as text.
  virtual std::string text() const = 0;

  /// Poses of the tool, n x 16.
  virtual void poses(RowsView q, RowsView previous, double* out, vernier::ExecutorRef executor) const = 0;
  /// Poses of the nominal arm in the identified frames, n x 16: the targets of `correct`.
  virtual void nominal_poses(RowsView q, double* out, vernier::ExecutorRef executor) const = 0;
  /// Geometric Jacobians, n x 6 x joints, linear rows first.
  virtual void jacobians(RowsView q, RowsView previous, double* out, vernier::ExecutorRef executor) const = 0;
  /// Commands that bring the arm where the nominal one is at q.
  virtual void correct(RowsView q, RowsView previous, const CorrectionRows& out,
                       vernier::ExecutorRef executor) const = 0;
  /// Commands that bring the arm to poses.
  /// @param targets n x 16
  /// @param seeds   n x joints, or one row for all: they choose the branch
  virtual void correct_poses(RowsView targets, RowsView seeds, RowsView previous, const CorrectionRows& out,
                             vernier::ExecutorRef executor) const = 0;
  /// Commands of a whole path.
  virtual PathRows correct_path(const PathTask& task) const = 0;
  /// Covariances of the pose of visits: shift and rotation vector, n x 36 [m, rad].
  /// @throws std::invalid_argument where the covariance of the calibration was not kept
  virtual void covariances(RowsView q, RowsView previous, double* out) const = 0;
  /// The yearly check.
  /// @throws std::invalid_argument where the covariance was not kept, or for unsuitable poses
  virtual vernier::VerificationReport verify(const MeasuredPoses& poses,
                                             const vernier::VerifyOptions& options) const = 0;
};

/// The arm of a model that was read.
/// @throws vernier::DataError for a chain in the modified convention, which no program writes
std::shared_ptr<const CalibratedArm> calibrated_arm(const vernier::SavedModel& model);

/// Instances for N joints, which the other calls: compiled in a file each.
template <int N>
std::shared_ptr<const CalibratedArm> calibrated_arm_of(const vernier::SavedModel& model);
/// An arm whose number of joints is known.
template <int N>
std::shared_ptr<const CalibratedArm> calibrated_arm_of(const vernier::CalibratedRobot<N>& robot);

}  // namespace support
