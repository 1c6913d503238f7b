// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A kinematic model, and roots of an arm's inverse kinematics, as functions of the controller's joints.

#include <cmath>
#include <type_traits>
#include <utility>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/concepts.hpp"

namespace vernier {

/// A `ControllerMap` of a chain of N joints, without allocation. Where the controller has fewer joints, further values
/// follow: by how much passive joints differ from their law, 0 in every command. Limits hold them there.
template <int N>
class JointChange {
 public:
  /// @throws std::invalid_argument where the map is of another number of joints
  explicit JointChange(const ControllerMap& map = {}) : same_(map.same()), moving_(map.joints(N)) {
    if (same_) return;
    square_ = map.square();
    inverse_ = map.inverse();
    zeros_ = map.zeros();
  }

  /// Joint values of the chain [rad, m].
  JointVector<N> to_chain(const JointVector<N>& controller) const noexcept {
    return same_ ? controller : JointVector<N>(zeros_ + square_ * controller);
  }
  /// Joint values of the controller [rad, m].
  JointVector<N> to_controller(const JointVector<N>& chain) const noexcept {
    return same_ ? chain : JointVector<N>(inverse_ * (chain - zeros_));
  }
  /// The derivative with respect to the controller's joints, of that with respect to the chain's.
  Jacobian<N> derivative(const Jacobian<N>& jacobian) const noexcept {
    return same_ ? jacobian : Jacobian<N>(jacobian * square_);
  }
  /// An upper bound of how much faster joints of the chain move than those of the controller; 1 for signs alone.
  double stretch() const noexcept {
    if (same_) return 1;
    double row = 0, column = 0;
    for (int i = 0; i < N; ++i) {
      double of_row = 0, of_column = 0;
      for (int j = 0; j < N; ++j) {
        of_row += std::abs(square_(i, j));
        of_column += std::abs(square_(j, i));
      }
      row = of_row > row ? of_row : row;
      column = of_column > column ? of_column : column;
    }
    return std::sqrt(row * column);
  }
  /// The joint of the controller that alone moves a joint of the chain, and nothing else; -1 where there is none.
  int alone(int chain_joint) const noexcept {
    if (same_) return chain_joint;
    int out = -1;
    for (int j = 0; j < N; ++j) {
      if (same_value(square_(chain_joint, j), 0)) continue;
      if (out >= 0) return -1;
      out = j;
    }
    for (int i = 0; i < N; ++i)
      if (i != chain_joint && !same_value(square_(i, out), 0)) return -1;
    return out;
  }
  /// Number of controller joints; further values are 0.
  int moving() const noexcept { return moving_; }
  /// Whether nothing changes.
  bool same() const noexcept { return same_; }

 private:
  bool same_;
  int moving_;
  Eigen::Matrix<double, N, N> square_{}, inverse_{};
  JointVector<N> zeros_{};
};

/// A model whose joint values are those of the controller. It has the members `nominal`, `gate` and `approached_from`
/// of the model, where that has them, in the same joints. A law of passive joints is kept by limits, see `JointChange`.
template <KinematicModel M>
class InControllerJoints : public ChecksJoints<InControllerJoints<M>> {
  using Checks = ChecksJoints<InControllerJoints>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// Number of joints of the chain.
  static constexpr int dof = M::dof;

  /// @param model  in joints of the chain
  /// @param change how they follow from those of the controller
  InControllerJoints(M model, const JointChange<M::dof>& change) : model_(std::move(model)), change_(change) {}

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return model_.pose(change_.to_chain(q)); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return model_.position(change_.to_chain(q)); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    PoseAndJacobian<dof> out = model_.pose_and_jacobian(change_.to_chain(q));
    out.jacobian = change_.derivative(out.jacobian);
    return out;
  }
  /// The nominal arm.
  auto nominal() const requires(requires(const M& model) { model.nominal(); }) {
    using Nominal = std::remove_cvref_t<decltype(model_.nominal())>;
    return InControllerJoints<Nominal>(model_.nominal(), change_);
  }
  /// Share of what was learned over the joints that is used at q.
  double gate(const JointVector<dof>& q) const noexcept
      requires(requires(const M& model) { model.gate(JointVector<M::dof>()); }) {
    return model_.gate(change_.to_chain(q));
  }
  /// The arm as it moves to the next configuration from known joint values: a view of this model.
  auto approached_from(const JointVector<dof>& previous) const noexcept
      requires(requires(const M& model) { model.approached_from(JointVector<M::dof>()); }) {
    using Approached = decltype(model_.approached_from(previous));
    return InControllerJoints<Approached>(model_.approached_from(change_.to_chain(previous)), change_);
  }
  /// A sphere that contains every position of its tool.
  auto reach_sphere() const requires(requires(const M& model) { model.reach_sphere(); }) {
    return model_.reach_sphere();
  }

  /// The model in joints of the chain.
  const M& in_chain_joints() const { return model_; }
  /// How its joints follow from those of the controller.
  const JointChange<dof>& change() const { return change_; }

 private:
  M model_;
  JointChange<dof> change_;
};

/// Roots of a nominal arm in the controller's joints, for `all_branches` and `correct_path`.
template <BranchRoots Roots>
class RootsInControllerJoints : public ChecksJoints<RootsInControllerJoints<Roots>> {
  using Checks = ChecksJoints<RootsInControllerJoints>;

 public:
  using Checks::distances;
  using Checks::roots;

  /// Number of joints.
  static constexpr int dof = Roots::dof;

  /// @throws std::invalid_argument where the joint that is held has no controller joint of its own
  RootsInControllerJoints(Roots roots, const JointChange<dof>& change) : roots_(std::move(roots)), change_(change) {
    demand(roots_.held_joint() < 0 || held_joint() >= 0, "RootsInControllerJoints: joint ", roots_.held_joint() + 1,
           " is held, but others move with it");
  }

  /// See `ClosedForm::roots`.
  InverseRoots<dof> roots(const Isometry3& target, const JointVector<dof>& close_to = JointVector<dof>::Zero(),
                          double width = 0) const noexcept {
    InverseRoots<dof> out = roots_.roots(target, change_.to_chain(close_to), width);
    for (int k = 0; k < out.count; ++k) {
      InverseRoot<dof>& root = out.roots[static_cast<std::size_t>(k)];
      root.joints = change_.to_controller(root.joints);
    }
    return out;
  }
  /// See `ClosedForm::distances`.
  SingularityDistances distances(const JointVector<dof>& q) const noexcept {
    return roots_.distances(change_.to_chain(q));
  }
  /// The joint that is held, counted from 0; -1 where all move.
  int held_joint() const { return roots_.held_joint() < 0 ? -1 : change_.alone(roots_.held_joint()); }
  /// A length of links [m] for bounds of derivatives, which grow by the square of `JointChange::stretch`.
  double arm_length() const {
    const double stretch = change_.stretch();
    return stretch > 1 ? stretch * stretch * (roots_.arm_length() + 1) : roots_.arm_length();
  }

 private:
  Roots roots_;
  JointChange<dof> change_;
};

}  // namespace vernier
