// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Base and tool frames around any kinematic model.

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/detail/chain_blocks.hpp"
#include "vernier/kinematics/detail/explain_model.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"
#include "vernier/kinematics/frame_parameters.hpp"

namespace vernier {

namespace detail {

/// Moves Jacobian columns from a model's end to a point `lever` away from it (in the model's base) and rotates them
/// into the outer base.
VERNIER_API void move_columns(const Isometry3& base, const Vector3& lever, const double* inner, Index columns,
                              double* out) noexcept;

/// Writes the columns of base and tool parameters, six in front of those of the model and six behind.
/// @param tool_point the pose at the tool point, oriented as the model's end, in the outer base
/// @param jacobian   6 x (columns + 12)
VERNIER_API void frame_columns(const FrameParameters& base, const FrameParameters& tool, const Isometry3& tool_point,
                               Index columns, double* jacobian) noexcept;

/// Turns the axes of a pose as a tool does, whose origin it has already.
VERNIER_API inline void turn_axes(Isometry3& pose, const Isometry3& tool) noexcept {
  for (Index r = 0; r < 3; ++r) {
    const double x = pose(r, 0), y = pose(r, 1), z = pose(r, 2);
    for (Index c = 0; c < 3; ++c) pose(r, c) = x * tool(0, c) + y * tool(1, c) + z * tool(2, c);
  }
}

/// Names and kinds of the parameters of a model between base and tool frames.
VERNIER_API std::vector<std::string> framed_names(std::vector<std::string> model);
VERNIER_API std::vector<ParameterKind> framed_kinds(const std::vector<ParameterKind>& model);

}  // namespace detail

/// `pose(q) = base * model.pose(q) * tool`. Parameters: 6 of the base, those of the model, 6 of the tool.
/// @tparam Model a `KinematicModel`
template <class Model>
class Framed : public ChecksJoints<Framed<Model>> {
  static_assert(detail::explain_kinematic_model<Model>());
  using Checks = ChecksJoints<Framed>;
  static constexpr bool of_chain = requires(const Model& m) { m.view(); };

  static constexpr int model_parameters() {
    if constexpr (requires { Model::num_parameters; }) {
      return Model::num_parameters;
    } else {
      return 0;
    }
  }

 public:
  using Checks::jacobian;
  using Checks::parameter_jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::poses;
  using Checks::poses_and_jacobians;
  using Checks::poses_and_parameter_jacobians;
  using Checks::position;
  using Checks::positions;

  /// Number of joints.
  static constexpr int dof = Model::dof;
  /// Number of parameters.
  static constexpr int num_parameters = 12 + model_parameters();
  /// All parameters [m, rad].
  using Parameters = Eigen::Matrix<double, num_parameters, 1>;

  /// A model between a base and a tool frame; both default to identity.
  explicit Framed(const Model& model, const FrameParameters& base = {}, const FrameParameters& tool = {})
      : model_(model), base_(base), tool_(tool) {}

  /// The model between the frames.
  const Model& model() const { return model_; }
  /// The Denavit-Hartenberg chain inside.
  const auto& chain() const {
    if constexpr (requires { model_.chain(); }) {
      return model_.chain();
    } else {
      return model_;
    }
  }
  /// Base frame, base_T_model.
  const Isometry3& base() const { return base_.isometry(); }
  /// Tool frame, flange_T_tool.
  const Isometry3& tool() const { return tool_.isometry(); }
  /// Base frame with its six values.
  const FrameParameters& base_frame() const { return base_; }
  /// Tool frame with its six values.
  const FrameParameters& tool_frame() const { return tool_; }

  /// These frames around another model.
  template <KinematicModel Other>
  Framed<Other> around(const Other& other) const {
    return Framed<Other>(other, base_, tool_);
  }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept {
    return composed(composed(base(), model_.pose(q)), tool());
  }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept {
    return transformed(base(), transformed(model_.pose(q), translation(tool())));
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    if constexpr (requires { model_.pose_and_jacobian(q, base(), translation(tool())); }) {
      PoseAndJacobian<dof> out = model_.pose_and_jacobian(q, base(), translation(tool()));
      detail::turn_axes(out.pose, tool());
      return out;
    } else {
      const PoseAndJacobian<dof> inner = model_.pose_and_jacobian(q);
      PoseAndJacobian<dof> out;
      detail::move_columns(base(), lever(inner.pose), inner.jacobian.data(), dof, out.jacobian.data());
      out.pose = composed(composed(base(), inner.pose), tool());
      return out;
    }
  }

  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n configurations; equal to those one by one
  /// to 1e-14.
  PointRows positions(const JointRows<dof>& joints, const Vector3& point = Vector3::Zero()) const requires
      requires(const Model& m) {
    m.positions(joints, point);
  }
  {
    if constexpr (of_chain) {
      const Vector3 at_flange = transformed(tool(), point);
      PointRows out(joints.rows(), 3);
      evaluate(joints, {.base = base().data(), .point = at_flange.data()}, {.positions = out.data()});
      return out;
    } else {
      PointRows out = model_.positions(joints, transformed(tool(), point));
      for (Index i = 0; i < out.rows(); ++i) set_point(out, i, transformed(base(), vernier::point(out, i)));
      return out;
    }
  }
  /// base_T_tool at n configurations.
  std::vector<Isometry3> poses(const JointRows<dof>& joints) const requires requires(const Model& m) {
    m.poses(joints);
  }
  {
    std::vector<Isometry3> out = model_.poses(joints);
    for (Isometry3& pose : out) pose = composed(composed(base(), pose), tool());
    return out;
  }
  /// Poses and Jacobians at n configurations; equal to those one by one to 1e-14.
  /// @param joints n x N
  /// @param out    storage to be reused
  PosesAndJacobians poses_and_jacobians(const JointRows<dof>& joints,
                                        PosesAndJacobians out = {}) const requires of_chain {
    out.resize(joints.rows(), dof);
    evaluate(joints, frames(), {.poses = out.poses.data(), .joints = out.jacobians.data()});
    return out;
  }

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
    return detail::framed_names(Model::parameter_names());
  }
  /// What each of them measures.
  static std::vector<ParameterKind> parameter_kinds() requires ParametricModel<Model> {
    return detail::framed_kinds(Model::parameter_kinds());
  }
  /// Derivative of the pose with respect to the parameters, 6 x P.
  ParameterJacobian<num_parameters> parameter_jacobian(const JointVector<dof>& q) const noexcept requires
      ParametricModel<Model> {
    return pose_and_parameter_jacobian(q).jacobian;
  }
  /// Both in one pass.
  PoseAndParameterJacobian<num_parameters> pose_and_parameter_jacobian(
      const JointVector<dof>& q) const noexcept requires ParametricModel<Model> {
    PoseAndParameterJacobian<num_parameters> out;
    if constexpr (of_chain) {
      detail::chain_parameter_jacobian(model_.view(), {base().data(), tool_.values().data()}, q.data(), out.pose.data(),
                                       out.jacobian.data() + 36);
    } else {
      const Isometry3 flange = model_.pose(q);
      const auto inner = model_.parameter_jacobian(q);
      detail::move_columns(base(), lever(flange), inner.data(), Model::num_parameters, out.jacobian.data() + 36);
      const Vector3 end = transformed(flange, translation(tool()));
      out.pose = rigid_motion(rotation(composed(base(), flange)), transformed(base(), end));
    }
    detail::frame_columns(base_, tool_, out.pose, Model::num_parameters, out.jacobian.data());
    detail::turn_axes(out.pose, tool());
    return out;
  }
  /// Poses and parameter Jacobians at n configurations; equal to those one by one to 1e-14.
  /// @param joints n x N
  /// @param out    storage to be reused
  PosesAndJacobians poses_and_parameter_jacobians(const JointRows<dof>& joints,
                                                  PosesAndJacobians out = {}) const requires of_chain {
    out.resize(joints.rows(), num_parameters);
    evaluate(joints, frames(), {.poses = out.poses.data(), .parameters = out.jacobians.data()});
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
  /// From the model's end to the tool point, in the model's base.
  Vector3 lever(const Isometry3& flange) const noexcept {
    return detail::rotated(rotation(flange), translation(tool()));
  }

  detail::ChainFrames frames() const {
    return {base().data(), tool_.values().data(), tool().data(), base_.rotation_vector_jacobian().data(),
            tool_.rotation_vector_jacobian().data()};
  }

  void evaluate(const JointRows<dof>& joints, const detail::ChainFrames& frames,
                const detail::BlockResults& results) const {
    detail::evaluate_chain(model_.view(), frames, joints.data(), joints.rows(), joints.rows(), results);
  }

  Model model_;
  FrameParameters base_, tool_;
};

/// A sphere that contains every position of a tool.
struct ReachSphere {
  Vector3 centre;  ///< base frame [m]
  double radius;   ///< [m]; infinite where none is known
};

/// Around the first axis, by the lengths of all links: joint errors do not change them.
template <class Model>
ReachSphere reach_sphere(const Framed<Model>& arm) {
  ReachSphere out{translation(arm.base()), translation(arm.tool()).norm()};
  for (int i = 0; i < Framed<Model>::dof; ++i) {
    const DhRow& row = arm.chain().row(i);
    out.radius += row.joint == JointType::revolute ? std::hypot(row.a, row.d) : std::numeric_limits<double>::infinity();
  }
  return out;
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/framed.ipp"
#endif
