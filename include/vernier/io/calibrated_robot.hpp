#pragma once

/// @file
/// A calibrated arm as one closed value: everything that is needed to correct its commands, saved and loaded as JSON.

#include <optional>
#include <string>
#include <utility>

#include "vernier/compensation/cartesian.hpp"
#include "vernier/identification/calibrated.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier {

/// Where a calibration comes from.
struct Provenance {
  std::string data_file{};           ///< name of the file of measured poses
  Index rows = 0;                    ///< measured poses it was fitted to
  std::string date{};                ///< as the caller gives it
  std::string joints = "commanded";  ///< which joint values the data hold: commanded, or encoder

  /// Equal in every entry.
  bool operator==(const Provenance&) const = default;
};

/// A nominal chain, what it was identified to be, its frames and limits, and optionally a learned position error on
/// top. A kinematic model (of the arm as it is) and a compensator. Frames are kept by their six values, so that what is
/// loaded from a file is bit for bit what was saved.
template <int N>
class CalibratedRobot {
 public:
  /// Number of joints.
  static constexpr int dof = N;
  /// The kind of chain.
  using Chain = DhChain<N>;
  /// The identified arm beside the nominal one.
  using Geometry = Calibrated<Chain>;
  /// The learned position error.
  using Learned = ElmPredictor<N, 3>;
  /// The identified arm with what was learned.
  using Corrected = CartesianCorrected<Geometry, Learned>;

  /// @param name       of the arm
  /// @param nominal    the chain as designed
  /// @param identified the chain as identified, in its base and tool frames
  /// @param limits     commands stay within them
  /// @param provenance where the calibration comes from
  /// @throws std::invalid_argument when the two chains have joints of different types
  CalibratedRobot(std::string name, const Chain& nominal, const Framed<Chain>& identified, const JointLimits<N>& limits,
                  Provenance provenance)
      : name_(std::move(name)),
        limits_(limits),
        provenance_(std::move(provenance)),
        geometry_(by_values(identified), nominal) {
    for (int i = 0; i < N; ++i)
      require(nominal.row(i).joint == identified.model().row(i).joint, "CalibratedRobot: joint ", i + 1,
              " is of another type in the identified chain than in the nominal one");
  }

  /// The same with a learned position error.
  CalibratedRobot with_learned(const Learned& learned, const JointRangeGate<N>& gate) const {
    CalibratedRobot out = *this;
    out.corrected_.emplace(geometry_, learned, gate);
    return out;
  }

  /// Its name.
  const std::string& name() const { return name_; }
  /// The chain as designed.
  const Chain& nominal() const { return geometry_.reference().model(); }
  /// The chain as identified.
  const Chain& identified() const { return geometry_.actual().model(); }
  const Framed<Chain>& actual() const { return geometry_.actual(); }        ///< identified chain and frames
  const Framed<Chain>& reference() const { return geometry_.reference(); }  ///< nominal chain, identified frames
  /// Joint limits.
  const JointLimits<N>& limits() const { return limits_; }
  /// Where the calibration comes from.
  const Provenance& provenance() const { return provenance_; }
  /// The learned stage; null where there is none.
  const Corrected* learned() const { return corrected_ ? &*corrected_ : nullptr; }

  /// The pose of the arm as it is.
  Isometry3 pose(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->pose(q) : geometry_.pose(q);
  }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->position(q) : geometry_.position(q);
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<N> jacobian(const JointVector<N>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<N> pose_and_jacobian(const JointVector<N>& q) const noexcept {
    return corrected_ ? corrected_->pose_and_jacobian(q) : geometry_.pose_and_jacobian(q);
  }
  /// Share of the learned part that holds at q; 1 where there is none.
  double gate(const JointVector<N>& q) const noexcept { return corrected_ ? corrected_->gate(q) : 1; }

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

  static Framed<Chain> by_values(const Framed<Chain>& framed) {
    const auto p = framed.parameters();
    return Framed<Chain>(framed.model(), FrameParameters(Vector6(p.template head<6>())),
                         FrameParameters(Vector6(p.template tail<6>())));
  }

  std::string name_;
  JointLimits<N> limits_;
  Provenance provenance_;
  Geometry geometry_;
  std::optional<Corrected> corrected_{};
};

}  // namespace vernier
