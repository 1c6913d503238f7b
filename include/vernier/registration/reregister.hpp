#pragma once

/// @file
/// Re-registration of a fitted arm that was moved, remounted or has drifted: its frames and joint zeros are estimated
/// again, everything else is kept.

#include <algorithm>
#include <string>
#include <vector>

#include "vernier/error_model/error_model.hpp"
#include "vernier/identification/detail/station.hpp"
#include "vernier/identification/sensor_model.hpp"
#include "vernier/registration/frame_update.hpp"

namespace vernier {

/// What is estimated again.
struct ReregisterOptions {
  bool base = true;                ///< the arm, or the sensor, was moved
  bool tool = false;               ///< another tool, or the same remounted
  bool offsets = false;            ///< joint zeros
  double offset_prior_std = 1e-3;  ///< expected change of a joint zero [rad, m]: a prior, so that few poses suffice

  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

/// Outcome of a re-registration, whatever the arm.
struct ReregistrationReport {
  bool determined = false;               ///< whether the poses determine everything that is estimated
  bool converged = false;                ///< whether the iteration converged
  double rms_before = 0;                 ///< position error with the frames of before [m]
  double rms_after = 0;                  ///< position error with the new ones [m]
  FrameMotion motion{};                  ///< how the arm was moved
  ReregisterOptions estimated{};         ///< what was estimated
  std::vector<JointType> joint_types{};  ///< of the arm
  VectorX change_std{};  ///< standard deviations: base twist (6), joint zeros (N), tool twist (6), those estimated

  /// What was estimated and how it changed, a line each [mm, mrad].
  VERNIER_API std::string summary() const;
};

/// A re-registered arm.
template <class Chain>
struct Reregistered : ReregistrationReport {
  ErrorModel<Chain> model;  ///< in its new frames
};

namespace detail {

/// Modelled poses of all samples after a motion, and the geometric Jacobians, 6 x joints each, side by side.
using MovedPoses = FunctionRef<void(const FrameMotion& motion, std::vector<Isometry3>& poses, MatrixX& jacobians)>;

/// Estimates how an arm was moved.
VERNIER_API FrameMotion reregister(const MovedPoses& evaluate, const Station& data, const ReregisterOptions& options,
                                   const SensorModel& sensors, ReregistrationReport& report);

}  // namespace detail

/// Estimates base, tool or joint zeros of a fitted arm again, from a handful of poses; everything else is kept.
/// @param model   as fitted, wherever it stood then
/// @param data    n >= 1 poses from where it stands now
/// @param options what is estimated
/// @param sensors their accuracy; residuals are weighted by squares, whatever its loss, and its `joint_sigma` is not
/// used
/// @throws std::invalid_argument on no data or an unusable option
template <class Chain>
Reregistered<Chain> reregister(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data,
                               const ReregisterOptions& options = {}, const SensorModel& sensors = {}) {
  constexpr int N = Chain::dof;
  const auto moved = [&](const FrameMotion& by) { return model.moved(by.base, JointVector<N>(by.offsets), by.tool); };
  const auto evaluate = [&](const FrameMotion& motion, std::vector<Isometry3>& poses, MatrixX& jacobians) {
    const ErrorModel<Chain> now = moved(motion);
    poses.resize(static_cast<std::size_t>(data.size()));
    jacobians.resize(6, N * data.size());
    for (Index i = 0; i < data.size(); ++i) {
      const PoseAndJacobian<N> at = now.pose_and_jacobian(data.joints(i));
      poses[static_cast<std::size_t>(i)] = at.pose;
      std::copy_n(at.jacobian.data(), 6 * N, jacobians.data() + 6 * N * i);
    }
  };
  const auto types = model.nominal().chain().joint_types();
  ReregistrationReport report;
  const FrameMotion found = detail::reregister(evaluate, detail::station_of(data, sensors), options, sensors, report);
  report.joint_types = {types.begin(), types.end()};
  return {std::move(report), moved(found)};
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/registration/reregister.ipp"
#endif
