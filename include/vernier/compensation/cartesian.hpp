// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Cartesian compensation: learn the position error over the joints, on top of any model.

#include <tuple>

#include "vernier/compensation/compensated.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/joint_coverage.hpp"
#include "vernier/regression/detail/explain_regressor.hpp"

namespace vernier {

/// A model less a learned position error: `position(q) = model.position(q) - gate(q) f(q)`. Orientations are
/// the model's.
template <KinematicModel Model, Predictor Learned>
class CartesianCorrected : public ChecksJoints<CartesianCorrected<Model, Learned>> {
  static_assert(Learned::inputs == Model::dof && Learned::outputs == 3);
  using Checks = ChecksJoints<CartesianCorrected>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// Number of joints.
  static constexpr int dof = Model::dof;

  /// Joins the parts.
  CartesianCorrected(const Model& model, const Learned& learned, const JointCoverage<dof>& gate)
      : model_(model), learned_(learned), gate_(gate) {}

  /// The model that is corrected.
  const Model& model() const { return model_; }
  /// The fitted predictor.
  const Learned& learned() const { return learned_; }
  /// The gate around the measured joint ranges.
  const JointCoverage<dof>& coverage() const { return gate_; }
  /// Share of the learned correction that is used at q, in [0, 1].
  double gate(const JointVector<dof>& q) const noexcept { return gate_(q); }

  /// The learned error at q, `gate(q) f(q)` [m].
  Vector3 error(const JointVector<dof>& q) const noexcept { return gate_(q) * learned_.predict(q); }
  /// Subtracts the learned error from a pose and a Jacobian at q: of the model, or of the same arm with hysteresis.
  void correct(const JointVector<dof>& q, PoseAndJacobian<dof>& at) const noexcept {
    const double gate = gate_(q);
    if (gate <= 0) return;
    Vector3 error;
    Eigen::Matrix<double, 3, dof> slope;
    if constexpr (requires { learned_.predict_and_derivative(q); }) {
      std::tie(error, slope) = learned_.predict_and_derivative(q);
    } else {
      error = learned_.predict(q);
      slope = learned_.derivative(q);
    }
    at.pose.translation() -= gate * error;
    const auto rate = gate_.derivative(q);
    for (int j = 0; j < dof; ++j)
      for (int r = 0; r < 3; ++r) at.jacobian(r, j) -= gate * slope(r, j) + error(r) * rate(j);
  }

  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return model_.position(q) - error(q); }
  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept {
    Isometry3 pose = model_.pose(q);
    pose.translation() -= error(q);
    return pose;
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    PoseAndJacobian<dof> out = model_.pose_and_jacobian(q);
    correct(q, out);
    return out;
  }

 private:
  Model model_;
  Learned learned_;
  JointCoverage<dof> gate_;
};

/// Learns `dX = X_model - X_measured` over the joints, with any regressor, on any model.
/// The paper's own correction is `CartesianCompensation{regressor, {.target = CorrectionTarget::position,
/// .moving_joints = 3}}`.
/// @cite Feng, Dong, Jin
/// @tparam R a `Regressor`
template <class R>
struct CartesianCompensation {
  static_assert(detail::explain_regressor<R>());

  /// Learner of the position error.
  R regressor;
  /// How commands are corrected.
  CorrectionOptions correction{};

  /// @param model   nominal, identified or already compensated
  /// @param data    n >= 1 samples in the frames of the model
  /// @param options seed, executor, observer of the regressor
  /// @throws std::invalid_argument when model and data are more than 50 mm apart on average: they are in different
  /// frames
  template <KinematicModel Model>
  Compensated<CartesianCorrected<Model, PredictorOf<R, Model::dof, 3>>, NominalOf<Model>> fit(
      const Model& model, const Dataset<Model::dof>& data, const FitOptions& options = {}) const {
    demand(data.size() >= 1, "CartesianCompensation: no samples");
    const PointRows error = positions(model, data.joints()) - data.positions();
    detail::require_same_frames("CartesianCompensation", error);
    return {{model, regressor.fit(data.joints(), error, options), JointCoverage<Model::dof>::covering(data.joints())},
            nominal_of(model),
            correction};
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class R>
CartesianCompensation(R) -> CartesianCompensation<R>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R>
CartesianCompensation(R, CorrectionOptions) -> CartesianCompensation<R>;

}  // namespace vernier
