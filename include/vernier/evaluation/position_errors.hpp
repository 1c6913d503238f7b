// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Position and orientation errors of many poses, and their statistics.

#include <concepts>
#include <span>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/kinematics/detail/explain_model.hpp"

namespace vernier {

/// Statistics of errors, in their unit.
struct ErrorStatistics {
  double mean = 0;    ///< arithmetic mean
  double rms = 0;     ///< root mean square
  double max = 0;     ///< maximum
  double min = 0;     ///< minimum
  double median = 0;  ///< `quantile` at 0.5
  double p95 = 0;     ///< `quantile` at 0.95
  /// Number of errors.
  Index n = 0;

  /// Of non-negative errors.
  /// @throws std::invalid_argument without errors
  VERNIER_API static ErrorStatistics of(const ConstVectorRef& errors);
};

/// A model of the pose of an arm at joints q: `pose(q)` of a kinematic model, or `predict(q)` of a compensator.
template <class M>
concept PosePredictor = KinematicModel<M> || requires(const M& model, const JointVector<M::dof>& q) {
  { model.predict(q) } -> std::same_as<Isometry3>;
};

/// Errors of an arm sent to commands, one row per target.
struct PositioningErrors {
  VectorX position;  ///< [m]
  VectorX rotation;  ///< [rad]
};

namespace detail {

template <PosePredictor M>
std::vector<Isometry3> predicted_poses(const M& model, const JointRows<M::dof>& joints) {
  std::vector<Isometry3> poses(static_cast<std::size_t>(joints.rows()));
  for (Index i = 0; i < joints.rows(); ++i) {
    const JointVector<M::dof> q = configuration(joints, i);
    if constexpr (KinematicModel<M>)
      poses[static_cast<std::size_t>(i)] = model.pose(q);
    else
      poses[static_cast<std::size_t>(i)] = model.predict(q);
  }
  return poses;
}

/// Poses of all samples; of a model with `approached_from`, each with the approach of its sample.
template <PosePredictor M>
std::vector<Isometry3> predicted_poses(const M& model, const Dataset<M::dof>& data) {
  if constexpr (requires(const JointVector<M::dof>& q) { model.approached_from(q).pose(q); }) {
    std::vector<Isometry3> poses(static_cast<std::size_t>(data.size()));
    for (Index i = 0; i < data.size(); ++i)
      poses[static_cast<std::size_t>(i)] =
          model.approached_from(configuration(data.previous(), i)).pose(data.joints(i));
    return poses;
  } else {
    return predicted_poses(model, data.joints());
  }
}

/// Does not compile where a model cannot predict the poses of data of N joints, and says why.
template <class M, int N>
constexpr bool explain_prediction() {
  if constexpr (requires { requires M::dof != N; }) {
    static_assert(M::dof == N, "the data have another number of joints than the model");
  } else if constexpr (!PosePredictor<M>) {
    explain_kinematic_model<M>();
  }
  return true;
}

VERNIER_API VectorX position_errors_of(std::span<const Isometry3> predicted, const PointRows& positions);
VERNIER_API VectorX rotation_errors_of(std::span<const Isometry3> predicted, const PointRows& orientations);
VERNIER_API PositioningErrors pose_errors(std::span<const Isometry3> desired, std::span<const Isometry3> reached);

}  // namespace detail

/// `|p_measured - p_predicted|` of every sample [m]; a model with `approached_from` predicts each sample with its
/// approach.
template <PosePredictor M>
VectorX position_errors(const M& model, const Dataset<M::dof>& data) {
  return detail::position_errors_of(detail::predicted_poses(model, data), data.positions());
}

/// Angle between measured and predicted orientation of every sample [rad], predicted as for `position_errors`.
/// @throws std::invalid_argument where the data have positions only
template <PosePredictor M>
VectorX rotation_errors(const M& model, const Dataset<M::dof>& data) {
  demand(data.has_orientations(), "rotation_errors: the data have positions only");
  return detail::rotation_errors_of(detail::predicted_poses(model, data), data.orientations());
}

/// Statistics of `position_errors` [m].
template <PosePredictor M>
ErrorStatistics prediction_error(const M& model, const Dataset<M::dof>& data) {
  return ErrorStatistics::of(position_errors(model, data));
}

/// Does not compile, and says what the model lacks or the data have.
template <class M, int N>
  requires(!PosePredictor<M> || M::dof != N)
ErrorStatistics prediction_error(const M&, const Dataset<N>&) {
  static_assert(detail::explain_prediction<M, N>());
  return {};
}

/// Errors of the poses that an arm reaches when sent to commands, with respect to a reference at the target joints.
/// @param actual    the arm that moves
/// @param reference model of the desired poses
/// @param commands  n x N joints sent to the arm
/// @param targets   n x N joints at which the reference has the desired poses
template <KinematicModel Actual, KinematicModel Reference>
PositioningErrors positioning_errors(const Actual& actual, const Reference& reference,
                                     const JointRows<Actual::dof>& commands, const JointRows<Actual::dof>& targets) {
  demand(commands.rows() == targets.rows(), "positioning_errors: ", commands.rows(), " commands for ", targets.rows(),
         " targets");
  return detail::pose_errors(detail::predicted_poses(reference, targets), detail::predicted_poses(actual, commands));
}

/// The corrected commands of many targets, n x N.
/// @param compensator a `Compensator`
/// @param targets     n x N joints
template <class C>
  requires requires(const C& compensator, const JointVector<C::dof>& q) { compensator.correct(q).command; }
JointRows<C::dof> corrected_commands(const C& compensator, const JointRows<C::dof>& targets) {
  JointRows<C::dof> out(targets.rows(), C::dof);
  for (Index i = 0; i < targets.rows(); ++i)
    out.row(i) = compensator.correct(targets.row(i).transpose()).command.transpose();
  return out;
}

/// The corrected commands of many targets in a matrix whose size is known at run time only.
/// @throws std::invalid_argument on another number of columns
template <class C, ColumnsAtRunTime Rows>
JointRows<C::dof> corrected_commands(const C& compensator, const Rows& targets) {
  return corrected_commands(compensator, detail::joint_rows<C::dof>(targets));
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/position_errors.ipp"
#endif
