#pragma once

/// @file
/// Position and orientation errors of many poses, and their statistics.

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/dataset.hpp"

namespace vernier {

/// Statistics of errors, in their unit.
struct ErrorStatistics {
  double mean = 0;    ///< arithmetic mean
  double rms = 0;     ///< root mean square
  double max = 0;     ///< greatest
  double min = 0;     ///< least
  double median = 0;  ///< middle
  double p95 = 0;     ///< 95th percentile
  /// Number of errors.
  Index n = 0;

  /// Of non-negative errors. Quantiles interpolate linearly between order statistics.
  /// @throws std::invalid_argument for no errors at all
  static ErrorStatistics of(const Eigen::Ref<const VectorX>& errors) {
    require(errors.size() >= 1, "ErrorStatistics: no errors");
    std::vector<double> sorted(errors.begin(), errors.end());
    std::sort(sorted.begin(), sorted.end());
    const auto quantile = [&](double share) {
      const double at = share * static_cast<double>(sorted.size() - 1);
      const auto low = static_cast<std::size_t>(at);
      const std::size_t high = std::min(low + 1, sorted.size() - 1);
      return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
    };
    return {errors.mean(), std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size())),
            sorted.back(), sorted.front(),
            quantile(0.5), quantile(0.95),
            errors.size()};
  }
};

namespace detail {

template <class M>
Isometry3 predicted_pose(const M& model, const JointVector<M::dof>& q) {
  if constexpr (KinematicModel<M>) {
    return model.pose(q);
  } else {
    return model.predict(q);
  }
}

}  // namespace detail

/// A kinematic model or a compensator: what says where an arm goes.
template <class M>
concept PosePredictor = KinematicModel<M> || Compensator<M>;

/// `|p_measured - p_predicted|` of every sample [m].
template <PosePredictor M>
VectorX position_errors(const M& model, const Dataset<M::dof>& data) {
  VectorX errors(data.size());
  for (Index i = 0; i < data.size(); ++i)
    errors(i) = (data.position(i) - detail::predicted_pose(model, data.joints(i)).translation()).norm();
  return errors;
}

/// Angle between measured and predicted orientation of every sample [rad].
/// @throws std::invalid_argument where the data have positions only
template <PosePredictor M>
VectorX rotation_errors(const M& model, const Dataset<M::dof>& data) {
  require(data.has_orientations(), "rotation_errors: the data have positions only");
  VectorX errors(data.size());
  for (Index i = 0; i < data.size(); ++i)
    errors(i) =
        log_so3(data.orientation(i) * detail::predicted_pose(model, data.joints(i)).linear().transpose()).norm();
  return errors;
}

/// How well a model predicts measured positions [m].
template <PosePredictor M>
ErrorStatistics prediction_error(const M& model, const Dataset<M::dof>& data) {
  return ErrorStatistics::of(position_errors(model, data));
}

/// Where an arm ends up when commanded, beside where it should be: one row a target.
struct PositioningErrors {
  VectorX position;  ///< [m]
  VectorX rotation;  ///< [rad]
};

/// Sends the actual arm to commands and compares with the reference at the target joints.
/// @param actual    the arm that moves
/// @param reference where it should go
/// @param commands  n x N joints sent to the arm
/// @param targets   n x N joints at which the reference stands where the arm should go
template <KinematicModel Actual, KinematicModel Reference>
PositioningErrors positioning_errors(const Actual& actual, const Reference& reference,
                                     const JointRows<Actual::dof>& commands, const JointRows<Actual::dof>& targets) {
  require(commands.rows() == targets.rows(), "positioning_errors: ", commands.rows(), " commands for ", targets.rows(),
          " targets");
  PositioningErrors errors{VectorX(targets.rows()), VectorX(targets.rows())};
  for (Index i = 0; i < targets.rows(); ++i) {
    const Vector6 e =
        pose_difference(reference.pose(targets.row(i).transpose()), actual.pose(commands.row(i).transpose()));
    errors.position(i) = e.head<3>().norm();
    errors.rotation(i) = e.tail<3>().norm();
  }
  return errors;
}

/// The corrected commands of many targets, n x N.
template <Compensator C>
JointRows<C::dof> corrected_commands(const C& compensator, const JointRows<C::dof>& targets) {
  JointRows<C::dof> out(targets.rows(), C::dof);
  for (Index i = 0; i < targets.rows(); ++i)
    out.row(i) = compensator.correct(targets.row(i).transpose()).command.transpose();
  return out;
}

}  // namespace vernier
