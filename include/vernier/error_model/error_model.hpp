// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A fitted error model: all that is known of a real arm, as one kinematic model that is safe outside the data.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/data/joint_coverage.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

namespace detail {

/// The Jacobian of `interpolated(outside(q), inside(q), gate(q))`; `jacobian` holds that of `outside` and is
/// overwritten.
/// @param slope gradient of the gate
VERNIER_API void blend_jacobians(double gate, const double* slope, const Isometry3& inside,
                                 const double* inside_jacobian, const Isometry3& outside, Index joints,
                                 double* jacobian) noexcept;

/// A blend of two models by a gate: `inside` where the joints were measured, `outside` elsewhere. Null pointers:
/// `inside` alone.
template <class Near, int N>
struct GatedModels {
  const Near& inside;
  const Near* outside;
  const JointCoverage<N>* coverage;

  double gate(const JointVector<N>& q) const noexcept { return coverage != nullptr ? (*coverage)(q) : 1; }

  Isometry3 pose(const JointVector<N>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate >= 1) return inside.pose(q);
    const Isometry3 fallback = outside->pose(q);
    return gate <= 0 ? fallback : interpolated(fallback, inside.pose(q), gate);
  }
  Vector3 position(const JointVector<N>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate >= 1) return inside.position(q);
    const Vector3 fallback = outside->position(q);
    return gate <= 0 ? fallback : Vector3(fallback + gate * (inside.position(q) - fallback));
  }
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept {
    const double gate = this->gate(q);
    if (gate >= 1) return inside.pose_and_jacobian(q);
    PoseAndJacobian<N> out = outside->pose_and_jacobian(q);
    if (gate <= 0) return out;
    const PoseAndJacobian<N> at = inside.pose_and_jacobian(q);
    const Eigen::Matrix<double, 1, N> slope = coverage->derivative(q);
    blend_jacobians(gate, slope.data(), at.pose, at.jacobian.data(), out.pose, N, out.jacobian.data());
    out.pose = interpolated(out.pose, at.pose, gate);
    return out;
  }
};

}  // namespace detail

/// Linear change of a geometry with temperature.
struct ThermalRates {
  double reference = 0;  ///< temperature for which the model's parameters hold [deg C]
  double lower = 0;      ///< the measured temperatures [deg C]; beyond them the geometry stays as at their ends
  double upper = 0;      ///< likewise
  VectorX parameters{};  ///< changes of the parameters as `ArmGeometry` counts them [m/K, rad/K]

  /// Equal in every entry.
  VERNIER_API bool operator==(const ThermalRates& other) const {
    return same_value(reference, other.reference) && same_value(lower, other.lower) && same_value(upper, other.upper) &&
           parameters == other.parameters;
  }
};

template <class C>
class ApproachedErrorModel;

/// An arm with geometric and joint errors in identified frames. Transmissions and tilts are functions of joint angles,
/// known where the joints were measured: outside, the model falls back smoothly (by `JointCoverage`) to one fitted
/// without them. It keeps the nominal arm in the same frames, so that commands can be corrected towards it.
template <class C>
class ErrorModel : public ChecksJoints<ErrorModel<C>> {
  using Checks = ChecksJoints<ErrorModel>;

 public:
  using Checks::approached_from;
  using Checks::gate;
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// The kind of chain.
  using Chain = C;
  /// Chain, joint errors and frames.
  using Arm = Framed<WithJointErrors<Chain>>;
  /// Number of joints.
  static constexpr int dof = Chain::dof;

  /// A model that is valid everywhere.
  ErrorModel(const Chain& nominal, Arm identified)
      : identified_(std::move(identified)), nominal_(identified_.around(nominal)) {}

  /// @param nominal    the chain as designed
  /// @param identified with all terms, for where the joints were measured
  /// @param fallback   without transmissions and tilts, for elsewhere
  /// @param coverage   where the joints were measured
  ErrorModel(const Chain& nominal, Arm identified, Arm fallback, JointCoverage<dof> coverage)
      : identified_(std::move(identified)),
        outside_(Outside{std::move(fallback), std::move(coverage)}),
        nominal_(identified_.around(nominal)) {}

  /// The arm with all terms.
  const Arm& identified() const { return identified_; }
  /// The nominal chain in the identified frames.
  const Framed<Chain>& nominal() const { return nominal_; }
  /// The arm that is valid outside the measured joint ranges; null where `identified` is valid everywhere.
  const Arm* fallback() const { return outside_ ? &outside_->arm : nullptr; }
  /// A sphere that contains every position of its tool, whatever the joints.
  ReachSphere reach_sphere() const {
    ReachSphere out = vernier::reach_sphere(identified_);
    if (fallback() != nullptr) {  // positions are blended
      const ReachSphere other = vernier::reach_sphere(*fallback());
      out.radius = (std::max)(out.radius, other.radius) + (out.centre - other.centre).norm();
    }
    out.radius *= 1 + 1e-6;  // tilts are rotations to first order
    return out;
  }
  /// The measured joint ranges; null where `identified` is valid everywhere.
  const JointCoverage<dof>* coverage() const { return outside_ ? &outside_->coverage : nullptr; }

  /// This model with a geometry that changes with temperature; its present parameters are those at the reference.
  /// @throws std::invalid_argument for another number of rates
  ErrorModel with_thermal(ThermalRates rates) const {
    demand(rates.parameters.size() == 12 + 5 * dof && rates.parameters.allFinite(),
           "ErrorModel: ", rates.parameters.size(), " thermal rates of ", 12 + 5 * dof,
           " parameters, all must be finite");
    ErrorModel out = *this;
    out.thermal_ = std::move(rates);
    return out;
  }
  /// How the geometry changes with temperature; null where it does not, or that is unknown.
  const ThermalRates* thermal() const { return thermal_ ? &*thermal_ : nullptr; }
  /// The arm at a temperature [deg C], at the nearest measured one outside the measured range; the nominal arm stays.
  /// This model without its change with temperature.
  ErrorModel at_temperature(double celsius) const {
    if (!thermal_ || !std::isfinite(celsius)) return *this;
    const double measured = std::clamp(celsius, thermal_->lower, thermal_->upper);
    ErrorModel out = *this;  // the nominal arm stays, and so do targets
    out.identified_ = warmer(identified_, measured - thermal_->reference);
    if (out.outside_) out.outside_->arm = warmer(outside_->arm, measured - thermal_->reference);
    out.thermal_->reference = measured;
    return out;
  }

  /// The arm under a payload, in place of the mean one of its measurements; as it is where they state none, or the
  /// payload is not finite. A centre that is not finite is at the tool point. The nominal arm stays.
  ErrorModel carrying(const Payload& payload) const {
    if (identified_.model().joint_errors().terms().payload == std::nullopt) return *this;
    const auto loaded = [&](const Arm& arm) {
      return arm.around(WithJointErrors<Chain>(
          arm.chain(), arm.model().joint_errors().carrying(payload.at(translation(arm.tool())))));
    };
    ErrorModel out = *this;
    out.identified_ = loaded(identified_);
    if (out.outside_) out.outside_->arm = loaded(outside_->arm);
    return out;
  }

  /// This arm in another place, with another tool and other joint zeros; the nominal arm is moved along.
  /// @param base    applied in front: motion of the frame of the measurements
  /// @param offsets added to the joint values [rad, m]
  /// @param tool    applied behind
  ErrorModel moved(const Isometry3& base, const JointVector<dof>& offsets, const Isometry3& tool) const {
    const auto move = [&](const Arm& arm) {
      auto p = arm.chain().parameters();
      for (int i = 0; i < dof; ++i)
        p(5 * i + static_cast<int>(arm.chain().row(i).joint == JointType::revolute ? DhParameter::theta
                                                                                   : DhParameter::d)) += offsets(i);
      return Arm(WithJointErrors<Chain>(arm.chain().with_parameters(p), arm.model().joint_errors()),
                 Isometry3(base * arm.base()), Isometry3(arm.tool() * tool));
    };
    ErrorModel out = outside_ ? ErrorModel(nominal_.model(), move(identified_), move(outside_->arm), outside_->coverage)
                              : ErrorModel(nominal_.model(), move(identified_));
    if (thermal_) {  // frames are changed along: what a kelvin does to them there
      const Arm now = move(identified_), then = move(warmer(identified_, 1));
      VectorX rates = thermal_->parameters;
      rates.template head<6>() = then.base_frame().values() - now.base_frame().values();
      rates.template tail<6>() = then.tool_frame().values() - now.tool_frame().values();
      out.thermal_ = thermal_;
      out.thermal_->parameters = rates;
    }
    return out;
  }

  /// This arm moved, with offsets whose number is known at run time.
  /// @throws std::invalid_argument on another number
  template <SizedAtRunTime Q>
  ErrorModel moved(const Isometry3& base, const Q& offsets, const Isometry3& tool) const {
    return moved(base, detail::joint_vector<dof>(offsets), tool);
  }

  /// The arm as it moves to the next configuration from given joint values: with the hysteresis of its joints.
  /// Non-owning: the model must outlive the view.
  /// @param previous joint values [rad, m]
  ApproachedErrorModel<Chain> approached_from(const JointVector<dof>& previous) const noexcept {
    return {*this, previous};
  }

  /// Share of `identified` in the prediction at q, in [0, 1]; the rest is `fallback`.
  double gate(const JointVector<dof>& q) const noexcept { return gated().gate(q); }

  /// base_T_tool; where the joints have hysteresis, in the middle of both directions of approach.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return gated().pose(q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return gated().position(q); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return gated().pose_and_jacobian(q);
  }

 private:
  struct Outside {
    Arm arm;
    JointCoverage<dof> coverage;
  };

  detail::GatedModels<Arm, dof> gated() const noexcept { return {identified_, fallback(), coverage()}; }

  /// An arm warmed up.
  Arm warmer(const Arm& arm, double kelvin) const {
    const ArmGeometry geometry(arm.around(arm.chain()));
    const Framed<Chain> now =
        geometry.with_parameters(geometry.parameters() + kelvin * thermal_->parameters).framed(arm.chain());
    return now.around(WithJointErrors<Chain>(now.model(), arm.model().joint_errors()));
  }

  Arm identified_;
  std::optional<Outside> outside_{};
  Framed<Chain> nominal_;
  std::optional<ThermalRates> thermal_{};
};

/// An `ErrorModel` that came from known joint values: a view of it, see `ErrorModel::approached_from`.
template <class C>
class ApproachedErrorModel : public ChecksJoints<ApproachedErrorModel<C>> {
  using Checks = ChecksJoints<ApproachedErrorModel>;

 public:
  using Checks::gate;
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// The kind of chain.
  using Chain = C;
  /// Number of joints.
  static constexpr int dof = Chain::dof;

  /// @param model    seen through this; must outlive it
  /// @param previous joint values from which it moves to the next configuration [rad, m]
  ApproachedErrorModel(const ErrorModel<Chain>& model, const JointVector<dof>& previous) noexcept
      : near_(around(model.identified(), previous)), coverage_(model.coverage()) {
    if (model.fallback() != nullptr) far_.emplace(around(*model.fallback(), previous));
  }
  /// The model, approached from joint values whose number is known at run time.
  /// @throws std::invalid_argument on another number
  template <SizedAtRunTime Q>
  ApproachedErrorModel(const ErrorModel<Chain>& model, const Q& previous)
      : ApproachedErrorModel(model, detail::joint_vector<dof>(previous)) {}

  /// Share of the joint-wise terms in the prediction at q, in [0, 1].
  double gate(const JointVector<dof>& q) const noexcept { return gated().gate(q); }
  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return gated().pose(q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return gated().position(q); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return gated().pose_and_jacobian(q);
  }

 private:
  using Arm = Framed<ApproachedArm<Chain>>;

  static Arm around(const typename ErrorModel<Chain>::Arm& arm, const JointVector<dof>& previous) noexcept {
    return arm.around(ApproachedArm<Chain>(arm.model(), previous));
  }
  detail::GatedModels<Arm, dof> gated() const noexcept { return {near_, far_ ? &*far_ : nullptr, coverage_}; }

  Arm near_;
  std::optional<Arm> far_{};
  const JointCoverage<dof>* coverage_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/error_model.ipp"
#endif
