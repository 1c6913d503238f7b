#pragma once

/// @file
/// A calibrated arm as one closed value: everything that is needed to correct its commands, saved and loaded as JSON.

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "vernier/compensation/cartesian.hpp"
#include "vernier/identification/error_model.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// Where a calibration comes from.
struct Provenance {
  std::string data_file{};           ///< name of the file of measured poses; of several, joined by commas
  Index rows = 0;                    ///< measured poses it was fitted to
  std::string date{};                ///< as the caller gives it
  std::string joints = "commanded";  ///< which joint values the data hold: commanded, or encoder
  std::string measured = "poses";    ///< what the sensor saw: poses, or positions
  double position_sigma = 0;         ///< of a visit, per component, as found in the data [m]; 0: not known

  /// Equal in every entry.
  bool operator==(const Provenance&) const = default;
};

/// A nominal chain, its error model in base and tool frames, its limits, and optionally a learned position error on
/// top. A kinematic model (of the arm as it is) and a compensator. Frames are kept by their six values, so that what is
/// loaded from a file is bit for bit what was saved.
template <int N>
class CalibratedRobot {
 public:
  /// Number of joints.
  static constexpr int dof = N;
  /// The kind of chain.
  using Chain = DhChain<N>;
  /// The arm as it is beside the nominal one.
  using Model = ErrorModel<Chain>;
  /// The learned position error.
  using Learned = ElmPredictor<N, 3>;
  /// The identified arm with what was learned.
  using Corrected = CartesianCorrected<Model, Learned>;

  /// @param name       of the arm
  /// @param model      the arm as it is; it knows the nominal one
  /// @param limits     commands stay within them
  /// @param provenance where the calibration comes from
  /// @throws std::invalid_argument when the two chains have joints of different types
  CalibratedRobot(std::string name, const Model& model, const JointLimits<N>& limits, Provenance provenance)
      : name_(std::move(name)), limits_(limits), provenance_(std::move(provenance)), model_(by_values(model)) {
    for (int i = 0; i < N; ++i)
      require(nominal().row(i).joint == identified().row(i).joint, "CalibratedRobot: joint ", i + 1,
              " is of another type in the identified chain than in the nominal one");
  }

  /// The same with a learned position error.
  CalibratedRobot with_learned(const Learned& learned, const JointCoverage<N>& gate) const {
    CalibratedRobot out = *this;
    out.corrected_.emplace(model_, learned, gate);
    return out;
  }

  /// The same arm with another model, standing elsewhere perhaps: what was learned in its base frame turns with it.
  CalibratedRobot with_model(const Model& model, Provenance provenance) const {
    CalibratedRobot out(name_, model, limits_, std::move(provenance));
    if (!corrected_) return out;
    const Matrix3 turn = out.model_.arm().base().linear() * model_.arm().base().linear().transpose();
    const Learned& learned = corrected_->learned();
    return out.with_learned({learned.layer(), learned.scaling(), learned.theta(), learned.beta() * turn.transpose(),
                             turn * learned.offset()},
                            corrected_->coverage());
  }

  /// Its name.
  const std::string& name() const { return name_; }
  /// The chain as designed.
  const Chain& nominal() const { return model_.reference().model(); }
  /// The chain as identified, without joint errors.
  const Chain& identified() const { return model_.arm().model().chain(); }
  const Model& model() const { return model_; }                          ///< the arm as it is, nothing learned on top
  const Framed<Chain>& reference() const { return model_.reference(); }  ///< nominal chain, identified frames
  /// Joint limits.
  const JointLimits<N>& limits() const { return limits_; }
  /// Where the calibration comes from.
  const Provenance& provenance() const { return provenance_; }
  /// The learned stage; null where there is none.
  const Corrected* learned() const { return corrected_ ? &*corrected_ : nullptr; }

  /// The pose of the arm as it is.
  Isometry3 pose(const JointVector<N>& q) const noexcept { return corrected_ ? corrected_->pose(q) : model_.pose(q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->position(q) : model_.position(q);
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->pose_and_jacobian(q) : model_.pose_and_jacobian(q);
  }
  /// Share of what was learned over the joints that holds at q; 1 where nothing was.
  double gate(const JointVector<N>& q) const noexcept {
    return corrected_ ? std::min(corrected_->gate(q), model_.gate(q)) : model_.gate(q);
  }

  /// The pose the arm takes when commanded q.
  Isometry3 predict(const JointVector<N>& q) const noexcept { return pose(q); }
  /// The command that brings the arm where the nominal one would be at q.
  [[nodiscard]] Correction<N> correct(const JointVector<N>& q) const noexcept { return compensated().correct(q); }
  /// The command that brings the arm to a pose in the frame of the measurements; joints near the answer choose the
  /// branch.
  [[nodiscard]] Correction<N> correct(const Isometry3& target, const JointVector<N>& seed) const noexcept {
    return compensated().correct(target, seed);
  }

 private:
  /// This arm by reference: one inverse kinematics serves it with and without a learned part.
  struct AsItIs {
    static constexpr int dof = N;
    const CalibratedRobot* robot;

    Isometry3 pose(const JointVector<N>& q) const noexcept { return robot->pose(q); }
    Vector3 position(const JointVector<N>& q) const noexcept { return robot->position(q); }
    Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return robot->jacobian(q); }
    PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept { return robot->pose_and_jacobian(q); }
    double gate(const JointVector<N>& q) const noexcept { return robot->gate(q); }
  };

  Compensated<AsItIs, Framed<Chain>> compensated() const {
    return Compensated<AsItIs, Framed<Chain>>({this}, reference()).within(limits_);
  }

  static typename Model::Arm by_values(const typename Model::Arm& arm) {
    return typename Model::Arm(arm.model(), FrameParameters(arm.base_values()), FrameParameters(arm.tool_values()));
  }
  static Model by_values(const Model& model) {
    const Chain& nominal = model.reference().model();
    if (model.fallback() == nullptr) return {nominal, by_values(model.arm())};
    return {nominal, by_values(model.arm()), by_values(*model.fallback()), *model.coverage()};
  }

  std::string name_;
  JointLimits<N> limits_;
  Provenance provenance_;
  Model model_;
  std::optional<Corrected> corrected_{};
};

}  // namespace vernier
