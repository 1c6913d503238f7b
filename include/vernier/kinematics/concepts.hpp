// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The concepts of kinematics: a model that maps joints to the pose of its tool. Nominal chains, identified chains,
/// chains with frames, simulated arms and models with a learned correction are all kinematic models.

#include <concepts>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A pose and its geometric Jacobian, computed in one pass.
template <int N>
struct PoseAndJacobian {
  Isometry3 pose;        ///< base_T_tool
  Jacobian<N> jacobian;  ///< 6 x N, linear rows first, base frame, at the tool point
};

/// A pose and its derivative with respect to P parameters, computed in one pass.
template <int P>
struct PoseAndParameterJacobian {
  Isometry3 pose;                 ///< base_T_tool
  ParameterJacobian<P> jacobian;  ///< 6 x P, rows as in `Jacobian`
};

/// Poses and their derivatives with respect to P values at n configurations.
struct PosesAndJacobians {
  std::vector<Isometry3> poses;  ///< base_T_tool
  MatrixX jacobians;  ///< n x 6P: row i is the 6 x P Jacobian of configuration i, column by column, so that an entry of
                      ///< all n is contiguous. `jacobians.row(i).reshaped(6, P)` is that Jacobian.

  /// Allocates for n configurations.
  VERNIER_API void resize(Index n, Index columns) {
    poses.resize(static_cast<std::size_t>(n));
    jacobians.resize(n, 6 * columns);
  }
};

namespace detail {

/// Evaluates configurations one at a time by `evaluate(q)`, which yields a pose and a 6 x P Jacobian.
template <int N, class Evaluate>
PosesAndJacobians evaluate_rows(const JointRows<N>& joints, Index columns, PosesAndJacobians out,
                                const Evaluate& evaluate) {
  out.resize(joints.rows(), columns);
  for (Index i = 0; i < joints.rows(); ++i) {
    const auto at = evaluate(configuration(joints, i));
    out.poses[static_cast<std::size_t>(i)] = at.pose;
    for (Index k = 0; k < 6 * columns; ++k) out.jacobians(i, k) = at.jacobian.data()[k];
  }
  return out;
}

}  // namespace detail

/// Forward kinematics of N joints, with derivatives. None of the calls allocates or throws.
///
/// - `M::dof`: number of joints, a compile-time constant
/// - `pose(q)`: base_T_tool; `position(q)`: its translation [m]
/// - `jacobian(q)`: 6 x N as in `Jacobian`; the exact derivative of `pose`
/// - `pose_and_jacobian(q)`: both; the primitive that solvers call
///
/// `testing::kinematic_model_violations` checks what types cannot express.
template <class M>
concept KinematicModel = requires(const M& model, const JointVector<M::dof>& q) {
  requires M::dof >= 1;
  { model.pose(q) }
  noexcept->std::same_as<Isometry3>;
  { model.position(q) }
  noexcept->std::same_as<Vector3>;
  { model.jacobian(q) }
  noexcept->std::same_as<Jacobian<M::dof>>;
  { model.pose_and_jacobian(q) }
  noexcept->std::same_as<PoseAndJacobian<M::dof>>;
};

/// What a parameter measures; decides its unit in reports and its physical size in priors.
enum class ParameterKind { length, angle };

/// A kinematic model described by P real parameters.
///
/// - `M::num_parameters`: P; `parameters()`: their values [m, rad]
/// - `with_parameters(p)`: the same model with other values
/// - `parameter_names()`, `parameter_kinds()`: P entries, e.g. `d3`, length
/// - `parameter_jacobian(q)`: 6 x P, derivative of the pose, rows as in `Jacobian`
/// - `pose(q, p)`: the pose as one function of joints and parameters, in any scalar (dual numbers included)
template <class M>
concept ParametricModel = KinematicModel<M> &&
    requires(const M& model, const JointVector<M::dof>& q, const Eigen::Matrix<double, M::num_parameters, 1>& p) {
  { model.parameters() } -> std::same_as<Eigen::Matrix<double, M::num_parameters, 1>>;
  { model.with_parameters(p) } -> std::same_as<M>;
  { M::parameter_names() } -> std::same_as<std::vector<std::string>>;
  { M::parameter_kinds() } -> std::same_as<std::vector<ParameterKind>>;
  { model.parameter_jacobian(q) }
  noexcept->std::same_as<ParameterJacobian<M::num_parameters>>;
  { model.template pose<double>(q, p) } -> std::same_as<Isometry3>;
};

/// Pose and parameter Jacobian; in one pass where the model has a member for it.
template <ParametricModel M>
PoseAndParameterJacobian<M::num_parameters> pose_and_parameter_jacobian(const M& model,
                                                                        const JointVector<M::dof>& q) noexcept {
  if constexpr (requires { model.pose_and_parameter_jacobian(q); }) {
    return model.pose_and_parameter_jacobian(q);
  } else {
    return {model.pose(q), model.parameter_jacobian(q)};
  }
}

/// Tool positions of n configurations, n x 3 [m]. Calls the model's own `positions(joints)` where it has one.
template <KinematicModel M>
PointRows positions(const M& model, const JointRows<M::dof>& joints) {
  if constexpr (requires { model.positions(joints); }) return model.positions(joints);
  PointRows out(joints.rows(), 3);
  for (Index i = 0; i < joints.rows(); ++i) set_point(out, i, model.position(configuration(joints, i)));
  return out;
}

/// Tool positions of n configurations in a matrix whose size is known at run time only.
/// @throws std::invalid_argument on another number of columns
template <KinematicModel M, ColumnsAtRunTime Rows>
PointRows positions(const M& model, const Rows& joints) {
  return positions(model, detail::joint_rows<M::dof>(joints));
}

/// Poses of n configurations. Calls the model's own `poses(joints)` where it has one.
template <KinematicModel M>
std::vector<Isometry3> poses(const M& model, const JointRows<M::dof>& joints) {
  if constexpr (requires { model.poses(joints); }) return model.poses(joints);
  std::vector<Isometry3> out;
  out.reserve(static_cast<std::size_t>(joints.rows()));
  for (Index i = 0; i < joints.rows(); ++i) out.push_back(model.pose(configuration(joints, i)));
  return out;
}

/// Poses of n configurations in a matrix whose size is known at run time only.
/// @throws std::invalid_argument on another number of columns
template <KinematicModel M, ColumnsAtRunTime Rows>
std::vector<Isometry3> poses(const M& model, const Rows& joints) {
  return poses(model, detail::joint_rows<M::dof>(joints));
}

/// Poses and Jacobians of n configurations. Calls the model's own `poses_and_jacobians(joints, out)` where it has
/// one.
/// @param model  any kinematic model
/// @param joints n x N
/// @param out    storage to be used again
template <KinematicModel M>
PosesAndJacobians poses_and_jacobians(const M& model, const JointRows<M::dof>& joints, PosesAndJacobians out = {}) {
  if constexpr (requires { model.poses_and_jacobians(joints, std::move(out)); }) {
    return model.poses_and_jacobians(joints, std::move(out));
  } else {
    return detail::evaluate_rows(joints, M::dof, std::move(out),
                                 [&](const auto& q) { return model.pose_and_jacobian(q); });
  }
}

/// Poses and Jacobians of n configurations in a matrix whose size is known at run time only.
/// @throws std::invalid_argument on another number of columns
template <KinematicModel M, ColumnsAtRunTime Rows>
PosesAndJacobians poses_and_jacobians(const M& model, const Rows& joints, PosesAndJacobians out = {}) {
  return poses_and_jacobians(model, detail::joint_rows<M::dof>(joints), std::move(out));
}

/// Poses and parameter Jacobians of n configurations, as above.
template <ParametricModel M>
PosesAndJacobians poses_and_parameter_jacobians(const M& model, const JointRows<M::dof>& joints,
                                                PosesAndJacobians out = {}) {
  if constexpr (requires { model.poses_and_parameter_jacobians(joints, std::move(out)); }) {
    return model.poses_and_parameter_jacobians(joints, std::move(out));
  } else {
    return detail::evaluate_rows(joints, M::num_parameters, std::move(out),
                                 [&](const auto& q) { return pose_and_parameter_jacobian(model, q); });
  }
}

/// The nominal arm of a model, towards which commands are corrected: its `nominal()` where it has one (an identified
/// model keeps the nominal chain in the identified frames), else the model itself (a nominal chain).
template <KinematicModel M>
decltype(auto) nominal_of(const M& model) {
  if constexpr (requires { model.nominal(); }) {
    return model.nominal();
  } else {
    return (model);
  }
}

/// Type of `nominal_of(model)`, by value.
template <KinematicModel M>
using NominalOf = std::remove_cvref_t<decltype(nominal_of(std::declval<const M&>()))>;

}  // namespace vernier
