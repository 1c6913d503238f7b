// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Models of an IRB 120 that are re-registered, what takes one to another, and the rows of all changes at a pose.

#include "larger.hpp"
#include "real_matrix.hpp"
#include "registrations.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier_test::irb120_models {

using namespace vernier;
using Chain = DhChain<6>;
using Model = ErrorModel<Chain>;
using Joints = JointVector<6>;

const Robot<6> robot = robots::abb_irb120();

inline Vector6 values(const Isometry3& frame) { return FrameParameters(frame).values(); }

const SensorModel sensors{};
const Isometry3 still = Isometry3::Identity();
const Isometry3 elsewhere = frame(Vector6{2, -3, 1.5, 1.2, -1.2, 1.06});  // turned by 2 rad
const Isometry3 other_tool = frame(Vector6{0.03, -0.02, 0.05, 0.3, -0.2, 0.25});

inline Joints random_zeros(Rng& rng, double size) {
  Joints out;
  for (double& x : out) x = size * rng.normal();
  return out;
}

inline JointRows<6> samples(Index n, std::uint64_t seed) { return sample_joints(robot.limits, n, seed); }

/// Joint errors and geometry of an arm, another one where joints 1 and 2 leave [-1.5, 1.5].
inline Model fitted() {
  const FrameParameters base(Vector6{0.4, -0.2, 0.1, 0.1, -0.3, 0.8}), tool(Vector6{0.05, 0.01, 0.12, 0.2, 0.4, -0.6});
  const WithJointErrors<Chain> arm(with_geometric_errors(robot.chain, {}, 1), draw_joint_errors(robot.chain, {}, 2));
  const WithJointErrors<Chain> fallback(with_geometric_errors(robot.chain, {}, 1),
                                        draw_joint_errors(robot.chain, {.harmonics = 0}, 2));
  JointCoverage<6> coverage;
  coverage.ranges[0] = coverage.ranges[1] = {{-1.5, 1.5}};
  coverage.margin.setConstant(0.5);
  return {robot.chain, Model::Arm(arm, base, tool), Model::Arm(fallback, base, tool), coverage};
}

/// No joint errors, holds everywhere.
inline Model rigid() {
  return {robot.chain, Model::Arm(WithJointErrors<Chain>(with_geometric_errors(robot.chain, {}, 1)), still,
                                  frame(Vector6{0.05, 0.01, 0.12, 0.2, 0.4, -0.6}))};
}

/// Largest difference of poses over the joint space [m, rad].
inline double difference(const Model& a, const Model& b) {
  double out = 0;
  const JointRows<6> joints = samples(50, 99);
  for (Index i = 0; i < joints.rows(); ++i) {
    const Joints q = configuration(joints, i);
    out = vernier_test::larger(out, RealMatrix(pose_difference(a.pose(q), b.pose(q))).largest());
  }
  return out;
}

/// Six elements of a column.
inline Vector6 six(const RealMatrix& column, Index first) {
  Vector6 out;
  for (Index k = 0; k < 6; ++k) out(k) = column(first + k);
  return out;
}

/// A model with other base, zeros and tool, all given as small values: 6, 6 and 6.
inline Model changed(const Model& model, const RealMatrix& by) {
  return model.moved(frame(six(by, 0)), six(by, 6), frame(six(by, 12)));
}

/// Zeros of a model's joints.
inline Joints zeros(const Model& model) {
  Joints out;
  for (int i = 0; i < 6; ++i) out(i) = model.identified().model().chain().row(i).theta;
  return out;
}

/// What takes one model to the other: base twist, zeros, tool twist.
inline RealMatrix change(const Model& from, const Model& to) {
  RealMatrix out(18, 1);
  out.set_block(0, 0, values(composed(to.identified().base(), inverse_of(from.identified().base()))));
  out.set_block(6, 0, RealMatrix(zeros(to)) - zeros(from));
  out.set_block(12, 0, values(composed(inverse_of(from.identified().tool()), to.identified().tool())));
  return out;
}

/// Rows of all changes at a pose, from models that differ.
inline RealMatrix effect_of_changes(const Model& model, const Joints& q) {
  RealMatrix out(6, 18);
  constexpr double size = 1e-5;
  for (Index k = 0; k < 18; ++k) {
    RealMatrix step(18, 1);
    step(k) = size;
    const RealMatrix moved = pose_difference(changed(model, step).pose(q), changed(model, -step).pose(q));
    out.set_block(0, k, moved / (2 * size));
  }
  return out;
}

}  // namespace vernier_test::irb120_models
