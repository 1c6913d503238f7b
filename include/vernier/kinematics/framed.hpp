#pragma once

/// @file
/// A model standing somewhere, with something in its hand: base and tool frames around any kinematic model.

#include <string>
#include <vector>

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/moving_frame.hpp"

namespace vernier {

/// A frame as six parameters beside its matrix: x, y, z [m], rotation vector rx, ry, rz [rad].
class FrameParameters {
 public:
  FrameParameters() : FrameParameters(Isometry3::Identity()) {}
  /// From a matrix or from its six values.
  FrameParameters(const Isometry3& frame) : frame_(frame) {  // NOLINT(google-explicit-constructor)
    values_ << frame.translation(), log_so3(frame.linear());
    rate_ = left_jacobian_so3(values_.tail<3>());
  }
  /// From a matrix or from its six values.
  explicit FrameParameters(const Vector6& values)
      : values_(values), frame_(isometry<double>(values)), rate_(left_jacobian_so3(values.tail<3>())) {}

  /// x, y, z [m], rx, ry, rz [rad].
  const Vector6& values() const { return values_; }
  /// As a matrix.
  const Isometry3& isometry() const { return frame_; }

  /// What a rate of the rotation vector is as an angular velocity, outside the frame.
  const Matrix3& rate() const { return rate_; }

  /// The frame of six values, in any scalar.
  template <class S>
  static IsometryOf<S> isometry(const Eigen::Matrix<S, 6, 1>& values) {
    IsometryOf<S> frame = IsometryOf<S>::Identity();
    frame.translation() = values.template head<3>();
    frame.linear() = exp_so3(values.template tail<3>());
    return frame;
  }

 private:
  Vector6 values_;
  Isometry3 frame_;
  Matrix3 rate_;
};

/// `pose(q) = base * model.pose(q) * tool`. Parameters: 6 of the base, those of the model, 6 of the tool.
template <KinematicModel Model>
class Framed {
 public:
  /// Number of joints.
  static constexpr int dof = Model::dof;

  /// A model between a base and a tool frame; both default to identity.
  explicit Framed(const Model& model, const FrameParameters& base = {}, const FrameParameters& tool = {})
      : model_(model), base_(base), tool_(tool) {}

  /// The model it stands on.
  const Model& model() const { return model_; }
  /// Base frame, base_T_model.
  const Isometry3& base() const { return base_.isometry(); }
  /// Tool frame, flange_T_tool.
  const Isometry3& tool() const { return tool_.isometry(); }

  /// Base frame by its six values.
  const Vector6& base_values() const { return base_.values(); }
  /// Tool frame by its six values.
  const Vector6& tool_values() const { return tool_.values(); }

  /// The same frames around another model.
  template <KinematicModel Other>
  Framed<Other> around(const Other& other) const {
    return Framed<Other>(other, base_, tool_);
  }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return base() * model_.pose(q) * tool(); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept {
    return base() * (model_.pose(q) * tool().translation());
  }
  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n joint combinations; equal to those one by
  /// one to 1e-14.
  PointRows positions(const JointRows<dof>& joints, const Vector3& point = Vector3::Zero()) const requires
      requires(const Model& m) {
    m.positions(joints, point);
  }
  {
    const PointRows inner = model_.positions(joints, tool() * point);
    return inner.lazyProduct(base().linear().transpose()).rowwise() + base().translation().transpose();
  }
  /// base_T_tool at n joint combinations.
  std::vector<Isometry3> poses(const JointRows<dof>& joints) const requires requires(const Model& m) {
    m.poses(joints);
  }
  {
    std::vector<Isometry3> out = model_.poses(joints);
    for (Isometry3& pose : out) pose = base() * pose * tool();
    return out;
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }

  /// Both in one pass.
  [[gnu::noinline]] PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    if constexpr (requires { model_.pose_and_jacobian(q, base(), tool().translation()); }) {
      PoseAndJacobian<dof> out = model_.pose_and_jacobian(q, base(), tool().translation());
      out.pose.linear() *= tool().linear();
      return out;
    } else {
      const PoseAndJacobian<dof> inner = model_.pose_and_jacobian(q);
      return {base() * inner.pose * tool(), at_tool(inner.jacobian, inner.pose)};
    }
  }

 private:
  /// Moves Jacobian columns from the model's end to the tool point and turns them into the outer base.
  template <int P>
  Eigen::Matrix<double, 6, P> at_tool(const Eigen::Matrix<double, 6, P>& inner,
                                      const Isometry3& flange) const noexcept {
    const Vector3 lever = flange.linear() * tool().translation();
    Eigen::Matrix<double, 6, P> out;
    for (int k = 0; k < P; ++k) {
      const Vector3 omega = inner.col(k).template tail<3>();
      out.col(k).template head<3>() = base().linear() * (inner.col(k).template head<3>() + omega.cross(lever));
      out.col(k).template tail<3>() = base().linear() * omega;
    }
    return out;
  }

  static constexpr int model_parameters() {
    if constexpr (requires { Model::num_parameters; }) {
      return Model::num_parameters;
    } else {
      return 0;
    }
  }

 public:
  /// Number of parameters.
  static constexpr int num_parameters = 12 + model_parameters();
  /// All parameters [m, rad].
  using Parameters = Eigen::Matrix<double, num_parameters, 1>;

  /// Their values [m, rad].
  Parameters parameters() const requires ParametricModel<Model> {
    Parameters p;
    p << base_.values(), model_.parameters(), tool_.values();
    return p;
  }

  /// A frame whose six values do not change keeps its matrix bit for bit.
  Framed with_parameters(const Parameters& p) const requires ParametricModel<Model> {
    const auto frame = [](const FrameParameters& old, const Vector6& values) {
      return values == old.values() ? old : FrameParameters(values);
    };
    return Framed(model_.with_parameters(p.template segment<Model::num_parameters>(6)),
                  frame(base_, p.template head<6>()), frame(tool_, p.template tail<6>()));
  }

  /// Their names, in the order of `parameters`.
  static std::vector<std::string> parameter_names() requires ParametricModel<Model> {
    std::vector<std::string> names;
    for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) names.push_back(std::string("base_") + axis);
    for (auto& name : Model::parameter_names()) names.push_back(std::move(name));
    for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) names.push_back(std::string("tool_") + axis);
    return names;
  }

  /// What each of them measures.
  static std::vector<ParameterKind> parameter_kinds() requires ParametricModel<Model> {
    std::vector<ParameterKind> frame(6, ParameterKind::length), kinds;
    std::fill(frame.begin() + 3, frame.end(), ParameterKind::angle);
    kinds = frame;
    for (const ParameterKind kind : Model::parameter_kinds()) kinds.push_back(kind);
    kinds.insert(kinds.end(), frame.begin(), frame.end());
    return kinds;
  }

  /// Derivative of the pose with respect to the parameters, 6 x P.
  ParameterJacobian<num_parameters> parameter_jacobian(const JointVector<dof>& q) const noexcept requires
      ParametricModel<Model> {
    return pose_and_parameter_jacobian(q).jacobian;
  }

  /// Both in one pass.
  [[gnu::noinline]] PoseAndParameterJacobian<num_parameters> pose_and_parameter_jacobian(
      const JointVector<dof>& q) const noexcept requires ParametricModel<Model> {
    constexpr int tool_column = 6 + Model::num_parameters;
    PoseAndParameterJacobian<num_parameters> out;
    out.jacobian.setZero();
    auto inner = out.jacobian.template middleCols<Model::num_parameters>(6);
    if constexpr (requires { model_.pose_and_parameter_jacobian(q, base(), tool().translation()); }) {
      const auto at = model_.pose_and_parameter_jacobian(q, base(), tool().translation());
      out.pose = at.pose;
      inner = at.jacobian;
    } else {
      const Isometry3 flange = model_.pose(q);
      out.pose = base() * flange * Eigen::Translation3d(tool().translation());
      inner = at_tool(model_.parameter_jacobian(q), flange);
    }
    const Matrix3 rotation = out.pose.linear();
    const Vector3 arm = out.pose.translation() - base().translation();  // base origin to tool point
    out.jacobian.template block<3, 3>(0, 0).setIdentity();
    out.jacobian.template block<3, 3>(0, 3) = -skew(arm) * base_.rate();
    out.jacobian.template block<3, 3>(3, 3) = base_.rate();
    out.jacobian.template block<3, 3>(0, tool_column) = rotation;
    out.jacobian.template block<3, 3>(3, tool_column + 3) = rotation * tool_.rate();
    out.pose.linear() = rotation * tool().linear();
    return out;
  }

  /// Poses and Jacobians at n joint combinations, several at a time; equal to those one by one to 1e-14.
  /// @param joints n x N
  /// @param out    storage to be used again
  PosesAndJacobians<dof> poses_and_jacobians(const JointRows<dof>& joints,
                                             PosesAndJacobians<dof> out = {}) const requires requires {
    Model::block;
  }
  {
    if (joints.rows() < Model::block)
      return detail::one_by_one(joints, std::move(out), [&](const auto& q) { return pose_and_jacobian(q); });
    const Matrix3 turn = tool().linear();
    model_.visit_motions(joints, {base().data(), tool_.values().data()}, out,
                         [&](const auto& columns, const auto& motions, auto& frame) VERNIER_INLINED {
                           for (int i = 0; i < dof; ++i) columns.write_joint(i, model_.row(i).joint, motions);
                           frame.rotate(turn.data());
                         });
    return out;
  }

  /// Poses and parameter Jacobians at n joint combinations, several at a time; equal to those one by one to 1e-14.
  /// @param joints n x N
  /// @param out    storage to be used again
  PosesAndJacobians<num_parameters> poses_and_parameter_jacobians(
      const JointRows<dof>& joints, PosesAndJacobians<num_parameters> out = {}) const requires requires {
    Model::block;
  }
  {
    if (joints.rows() < Model::block)
      return detail::one_by_one(joints, std::move(out), [&](const auto& q) { return pose_and_parameter_jacobian(q); });
    const Matrix3 axes = Matrix3::Identity(), turn = tool().linear();
    const Matrix3 base_rate = base_.rate(), tool_rate = tool_.rate();
    const Vector3 standing = base().translation();
    model_.visit_motions(joints, {base().data(), tool_.values().data()}, out,
                         [&](const auto& columns, const auto& motions, auto& frame) VERNIER_INLINED {
                           constexpr int tool_column = 6 + Model::num_parameters;
                           detail::BlockMotion<std::decay_t<decltype(frame)>::width> m;
                           columns.write_parameters(6, motions);
                           for (int k = 0; k < 3; ++k) {
                             m.set_constant(axes.col(k).data(), standing.data());
                             columns.write(k, false, m);
                             m.set_constant(base_rate.col(k).data(), standing.data());
                             columns.write(3 + k, true, m);
                           }
                           m.set(frame.x, frame.p), columns.write(tool_column, false, m);
                           m.set(frame.y, frame.p), columns.write(tool_column + 1, false, m);
                           m.set(frame.z, frame.p), columns.write(tool_column + 2, false, m);
                           for (int k = 0; k < 3; ++k) {
                             frame.direction(tool_rate.col(k).data(), m.axis);
                             columns.write(tool_column + 3 + k, true, m);
                           }
                           frame.rotate(turn.data());
                         });
    return out;
  }

  /// The pose as a function of joints and parameters, in any scalar.
  template <class S>
  IsometryOf<S> pose(const Eigen::Matrix<S, dof, 1>& q,
                     const Eigen::Matrix<S, num_parameters, 1>& p) const requires ParametricModel<Model> {
    const Eigen::Matrix<S, Model::num_parameters, 1> inner = p.template segment<Model::num_parameters>(6);
    return FrameParameters::isometry<S>(p.template head<6>()) * model_.template pose<S>(q, inner) *
           FrameParameters::isometry<S>(p.template tail<6>());
  }

 private:
  Model model_;
  FrameParameters base_, tool_;
};

}  // namespace vernier
