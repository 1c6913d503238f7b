// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which configurations to measure, so that a calibration is as good as their number allows.

#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/measurements/measurements.hpp"
#include "vernier/planning/detail/expected_rows.hpp"
#include "vernier/planning/measurement_constraints.hpp"
#include "vernier/planning/pose_design.hpp"
#include "vernier/planning/visiting_order.hpp"

namespace vernier {

/// Options of `plan_measurements`. What is fitted decides which measurements are good, so it is part of a plan.
struct PlanOptions {
  Index count = 100;                                          ///< measurements to choose
  DesignCriterion criterion = DesignCriterion::information;   ///< what a choice improves; `region_variance` needs one
  IdentifyOptions geometry{.frames = Frames::base_and_tool};  ///< geometry that will be identified
  ErrorModelOptions errors{};                                 ///< joint errors that may be fitted
  SensorModel sensors{};                                      ///< accuracy of the measurements
  bool oriented = false;                     ///< whether orientations are measured, and not positions alone
  double bin = 10 * std::numbers::pi / 180;  ///< width of the bins of each joint [rad, m]
  int bin_count = 0;                         ///< measurements wanted in each bin that candidates reach
  Index check_every = 20;                    ///< number of poses after which the first one is repeated
  VectorX speeds{};                          ///< of the joints, see `visiting_order`
  int bound_iterations = 0;                  ///< of `information_bound`; 0: no bound
  /// Who watches; must outlive the call. Told after each choice (`Progress::generation` of them, `best`: information
  /// [nat]), and many times before and between. A stop ends the plan with what was chosen until then, which may be
  /// none.
  ObserverRef observer{};
};

/// Candidates of a plan: configurations, and from where each is approached.
template <int N>
struct MeasurementCandidates {
  JointRows<N> joints;         ///< n x N [rad, m]
  JointRows<N> previous{};     ///< likewise; no rows, or not finite, where unknown
  RejectionCounts rejected{};  ///< how many configurations did not become candidates, by the reason
};

/// A range of a joint that no measurement lies in, though candidates do.
struct UncoveredBin {
  int joint;         ///< from 0
  JointRange range;  ///< [rad, m]
};

/// What `plan_measurements` found, whatever the number of joints.
struct PlannedMeasurements {
  /// Candidates, in the order of choice: the first ones alone are the plan of fewer. Fewer than asked for where the
  /// observer stopped it.
  std::vector<Index> chosen{};
  /// Visits, as positions in `chosen`: first three that register the sensor's frame, then a short path through the
  /// rest; the first visit is repeated now and then to see drift.
  std::vector<Index> visits{};
  /// Predicted error (rms of positions) over the region after 0, 1, .. choices, relative to that after the last. Its
  /// size is not given: predictions of the prior rank plans, but are too small by the factor that residuals show.
  VectorX relative_error{};
  VectorX log_det{};                                       ///< information after 0, 1, .. choices [nat]
  double bound = std::numeric_limits<double>::infinity();  ///< no choice has more, see `information_bound`
  std::vector<UncoveredBin> uncovered{};                   ///< by joint and angle
  Index unknowns = 0;                                      ///< of the planned fit

  /// The number of measurements after which ten more reduce the predicted error by less than a share.
  /// @return `chosen.size()` where none does
  VERNIER_API Index enough(double share = 0.02) const;
};

/// A plan with its configurations.
template <int N>
struct MeasurementPlan : PlannedMeasurements {
  JointRows<N> joints;         ///< chosen ones, in the order of choice [rad, m]
  RejectionCounts rejected{};  ///< of the candidates
};

namespace detail {

/// Joint rows of a plan, whatever their number of joints.
struct PlanInput {
  MatrixX candidates, candidates_previous;
  MatrixX measured, measured_previous;
  MatrixX region;
};
VERNIER_API PlannedMeasurements plan_measurements(const ArmGeometry& nominal, const PlanInput& input,
                                                  const PlanOptions& options);
/// Configurations within limits that a scene admits, uniform, and what became of the others.
VERNIER_API MatrixX admitted_joints(const MeasurementScene& scene, const VectorX& lower, const VectorX& upper, Index n,
                                    std::uint64_t seed, RejectionCounts& rejected, const ObserverRef& observer);

}  // namespace detail

/// Candidates drawn uniformly within joint limits, of which constraints admit all. Each counts as approached from the
/// one before, so directions of approach are at random.
/// @param arm         as designed, with its tool
/// @param limits      finite, lower below upper; of the controller's joints (`MeasurementConstraints::controller`)
/// @param constraints their joint limits are replaced by `limits`
/// @param n           number of candidates
/// @param seed        same seed, same candidates
/// @param observer    told of the candidates so far (`Progress::evaluations`), many times; a stop leaves these
/// @throws std::invalid_argument for unbounded limits, or where fewer than one in a thousand is admitted, with the most
///         frequent reason
template <NominalArm Arm>
MeasurementCandidates<Arm::dof> sample_candidates(const Arm& arm, const JointLimits<Arm::dof>& limits,
                                                  MeasurementConstraints constraints, Index n, std::uint64_t seed,
                                                  const ObserverRef& observer = {}) {
  constraints.lower = limits.lower;
  constraints.upper = limits.upper;
  MeasurementCandidates<Arm::dof> out;
  out.joints = detail::admitted_joints(MeasurementScene(ArmGeometry(in_frames(arm)), constraints), limits.lower,
                                       limits.upper, n, seed, out.rejected, observer);
  out.previous = out.joints;
  for (Index i = 1; i < out.joints.rows(); ++i)
    for (Index j = 0; j < Arm::dof; ++j) out.previous(i, j) = out.joints(i - 1, j);
  return out;
}

/// Chooses which candidates to measure for `fit_error_model`: each the one that tells most about all unknowns of the
/// model (geometry, frames, joint errors, hysteresis) beside those before it, or most about positions in a region.
/// @param arm        as designed, with its tool
/// @param candidates to choose from
/// @param options    how many, by which criterion, for which fit
/// @param measured   poses that were measured before: the plan is what to add
/// @param region     joint rows of the working region, whose positions are to be predicted well; without rows some of
///                   the candidates
/// @throws std::invalid_argument for fewer candidates than measurements, an approach for some candidates alone,
///         measurements that are no data set of poses, or an unusable option
template <NominalArm Arm>
MeasurementPlan<Arm::dof> plan_measurements(const Arm& arm, const MeasurementCandidates<Arm::dof>& candidates,
                                            const PlanOptions& options = {},
                                            const Measurements<Arm::dof>& measured = {},
                                            const JointRows<Arm::dof>& region = JointRows<Arm::dof>(0, Arm::dof)) {
  demand(measured.sets().size() == measured.poses().size(),
         "plan_measurements: ", measured.sets().size() - measured.poses().size(), " of ", measured.sets().size(),
         " sets of measurements are no data sets of poses; a plan counts these alone");
  detail::PlanInput input{candidates.joints, candidates.previous, MatrixX(0, Arm::dof), MatrixX(0, Arm::dof), region};
  for (const Dataset<Arm::dof>& poses : measured.poses()) {
    const Index before = input.measured.rows(), rows = before + poses.size();
    input.measured.conservativeResize(rows, Arm::dof);
    input.measured_previous.conservativeResize(rows, Arm::dof);
    input.measured.bottomRows(poses.size()) = poses.joints();
    input.measured_previous.bottomRows(poses.size()) = poses.previous();
  }
  MeasurementPlan<Arm::dof> out{detail::plan_measurements(ArmGeometry(in_frames(arm)), input, options),
                                JointRows<Arm::dof>(), candidates.rejected};
  out.joints = detail::rows_of(candidates.joints, out.chosen);
  return out;
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/planning/plan_measurements.ipp"
#endif
