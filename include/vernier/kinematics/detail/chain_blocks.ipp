// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "vernier/kinematics/detail/chain_blocks.hpp"

namespace vernier::detail {

/// From where the frames are to the tool at W configurations; `record(row, parameter, axis)` is called before each
/// elementary motion. N is the number of joints where it is known, else 0.
template <class Convention, int N, int W, class Record>
VERNIER_INLINE void walk_block(const ChainView& c, const double* joints, Index stride, BlockFrame<W>& frame,
                               const Record& record) {
  using Double = typename Simd<W>::Double;
  const int count = N > 0 ? N : c.joints;
  Double joint[max_joints], sine[max_joints], cosine[max_joints];
  for (int i = 0; i < count; ++i) {
    Double angle[1], s[1], k[1];
    load<W>(joint[i], joints + i * stride);
    angle[0] = c.theta[i] + c.turning[i] * joint[i];
    sincos<W>(angle, s, k);
    sine[i] = s[0];
    cosine[i] = k[0];
  }
  for (int i = 0; i < count; ++i) {
    Double offset = Double{} + c.rows[i].d;
    if (c.rows[i].joint == JointType::prismatic) offset += joint[i];
    walk_row<Convention>(c.rows[i], c.twist[i], c.hayati[i], sine[i], cosine[i], offset, frame,
                         [&](DhParameter parameter, const auto& axis) VERNIER_INLINED { record(i, parameter, axis); });
  }
}

/// Columns of base and tool frame in the parameter Jacobians.
template <int W>
VERNIER_INLINE void write_frames(const BlockColumns<W>& columns, const ChainFrames& frames, int tool_column,
                                 const BlockFrame<W>& frame) {
  constexpr double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double* standing = frames.base + 12;
  BlockMotion<W> m;
  for (int k = 0; k < 3; ++k) {
    m.set_constant(axes + 3 * k, standing);
    columns.write(k, false, m);
    m.set_constant(frames.base_rate + 3 * k, standing);
    columns.write(3 + k, true, m);
  }
  m.set(frame.x, frame.p), columns.write(tool_column, false, m);
  m.set(frame.y, frame.p), columns.write(tool_column + 1, false, m);
  m.set(frame.z, frame.p), columns.write(tool_column + 2, false, m);
  for (int k = 0; k < 3; ++k) {
    frame.direction(frames.tool_rate + 3 * k, m.axis);
    columns.write(tool_column + 3 + k, true, m);
  }
}

/// Evaluates W configurations from row `first`.
template <class Convention, int N, int W>
VERNIER_INLINE void evaluate_block(const ChainView& c, const ChainFrames& frames, const double* joints, Index n,
                                   Index stride, Index first, const BlockResults& results) {
  const Placement placement = frames.placement();
  BlockFrame<W> frame;
  placement.begin<W>(frame);
  if (results.joints == nullptr && results.parameters == nullptr) {
    walk_block<Convention, N, W>(c, joints + first, stride, frame,
                                 [](int, DhParameter, const auto&) VERNIER_INLINED {});
    placement.end(frame);
  } else {
    BlockMotion<W> motions[5 * max_joints];
    walk_block<Convention, N, W>(c, joints + first, stride, frame,
                                 [&](int i, DhParameter parameter, const auto& axis) VERNIER_INLINED {
                                   motions[5 * i + static_cast<int>(parameter)].set(axis, frame.p);
                                 });
    placement.end(frame);
    if (results.joints != nullptr) {
      const BlockColumns<W> columns(results.joints + first, n, frame);
      for (int i = 0; i < c.joints; ++i) columns.write_joint(i, c.rows[i].joint, motions);
    }
    if (results.parameters != nullptr) {
      const BlockColumns<W> columns(results.parameters + first, n, frame);
      const bool framed = frames.base_rate != nullptr;
      columns.write_parameters(framed ? 6 : 0, motions, c.joints);
      if (framed) write_frames<W>(columns, frames, 6 + 5 * c.joints, frame);
    }
  }
  if (results.positions != nullptr) frame.store_positions(results.positions + first, n);
  if (results.poses == nullptr && results.matrices == nullptr) return;
  if (frames.tool != nullptr) frame.rotate(frames.tool);
  if (results.poses != nullptr) frame.store_poses(results.poses + first);
  if (results.matrices != nullptr) frame.store_matrices(results.matrices + 16 * first);
}

template <class Convention, int N>
void evaluate_blocks(const ChainView& c, const ChainFrames& frames, const double* joints, Index n, Index stride,
                     const BlockResults& results, InstructionSet set) {
  run_same_bits(
      [&]<int W>() VERNIER_INLINED {
        for (Index next = 0; next < n; next += W)  // the last vector overlaps with the one before
          evaluate_block<Convention, N, W>(c, frames, joints, n, stride, (std::min)(next, n - W), results);
      },
      set);
}

/// For fewer configurations than a vector holds: the last one is repeated.
VERNIER_LOCAL void evaluate_padded(const ChainView& c, const ChainFrames& frames, const double* joints, Index n,
                                   Index stride, const BlockResults& results, InstructionSet set) {
  constexpr Index padded = 4;
  const Index entries = 6 * (5 * c.joints + (frames.base_rate != nullptr ? 12 : 0));
  std::vector<double> q(static_cast<std::size_t>(padded * c.joints)), positions(3 * padded), joint_columns,
      parameter_columns;
  double matrices[16 * padded];
  std::vector<Isometry3> poses(padded);
  for (int i = 0; i < c.joints; ++i)
    for (Index k = 0; k < padded; ++k)
      q[static_cast<std::size_t>(i * padded + k)] = joints[i * stride + (std::min)(k, n - 1)];
  if (results.joints != nullptr) joint_columns.resize(static_cast<std::size_t>(6 * c.joints * padded));
  if (results.parameters != nullptr) parameter_columns.resize(static_cast<std::size_t>(entries * padded));
  evaluate_chain(c, frames, q.data(), padded, padded,
                 {positions.data(), poses.data(), results.joints != nullptr ? joint_columns.data() : nullptr,
                  results.parameters != nullptr ? parameter_columns.data() : nullptr, matrices},
                 set);
  const auto copy = [n](const double* from, Index columns, double* to) {
    for (Index k = 0; k < columns; ++k) std::copy_n(from + k * padded, n, to + k * n);
  };
  if (results.positions != nullptr) copy(positions.data(), 3, results.positions);
  if (results.poses != nullptr) std::copy_n(poses.begin(), n, results.poses);
  if (results.matrices != nullptr) std::copy_n(matrices, 16 * n, results.matrices);
  if (results.joints != nullptr) copy(joint_columns.data(), 6 * c.joints, results.joints);
  if (results.parameters != nullptr) copy(parameter_columns.data(), entries, results.parameters);
}

VERNIER_IMPL void evaluate_chain(const ChainView& c, const ChainFrames& frames, const double* joints, Index n,
                                 Index stride, const BlockResults& results, InstructionSet set) {
  if (n == 0) return;
  if (n < 4) return evaluate_padded(c, frames, joints, n, stride, results, set);
#if !VERNIER_HEADER_ONLY  // loops of a known length are a tenth faster; header-only users would compile them each time
  if (!c.modified && c.joints == 6) return evaluate_blocks<StandardDh, 6>(c, frames, joints, n, stride, results, set);
  if (!c.modified && c.joints == 7) return evaluate_blocks<StandardDh, 7>(c, frames, joints, n, stride, results, set);
#endif
  c.modified ? evaluate_blocks<ModifiedDh, 0>(c, frames, joints, n, stride, results, set)
             : evaluate_blocks<StandardDh, 0>(c, frames, joints, n, stride, results, set);
}

/// All elementary motions at one configuration, five a row; the pose goes to `pose`.
template <class Convention>
void elementary_motions(const ChainView& c, const Placement& placement, const double* q, ElementaryMotion* motions,
                        double* pose) noexcept {
  run_same_bits([&]<int W>() VERNIER_INLINED {
    PoseFrame<W> frame;
    placement.begin<W>(frame);
    walk_pose<Convention, 0, W>(c, q, frame,
                                [&](int i, DhParameter parameter, const auto& axis, const auto& point) VERNIER_INLINED {
                                  ElementaryMotion& motion = motions[5 * i + static_cast<int>(parameter)];
                                  store_vector<W>(motion.axis, axis);
                                  store_vector<W>(motion.point, point);
                                });
    placement.end(frame);
    store_pose<W>(pose, frame);
  });
}

VERNIER_LOCAL void any_elementary_motions(const ChainView& c, const Placement& placement, const double* q,
                                          ElementaryMotion* motions, double* pose) noexcept {
  c.modified ? elementary_motions<ModifiedDh>(c, placement, q, motions, pose)
             : elementary_motions<StandardDh>(c, placement, q, motions, pose);
}

VERNIER_IMPL void chain_parameter_jacobian(const ChainView& c, const Placement& placement, const double* q,
                                           double* pose, double* jacobian) noexcept {
  ElementaryMotion motions[5 * max_joints];
  any_elementary_motions(c, placement, q, motions, pose);
  for (int i = 0; i < c.joints; ++i) {
    VERNIER_UNROLL
    for (int k = 0; k < 5; ++k) {
      const auto parameter = static_cast<DhParameter>(k);
      const bool rotation = parameter != DhParameter::a && parameter != DhParameter::d;
      motions[5 * i + k].column(rotation, pose + 12, jacobian + 6 * (5 * i + k));
    }
  }
}

VERNIER_IMPL void chain_links(const ChainView& c, const double* q, double* axes, double* points,
                              double* origins) noexcept {
  ElementaryMotion motions[5 * max_joints];
  double pose[16];
  any_elementary_motions(c, {}, q, motions, pose);
  const int first = static_cast<int>(c.modified ? ModifiedDh::order.front() : StandardDh::order.front());
  for (int i = 0; i < c.joints; ++i) {
    const bool revolute = c.rows[i].joint == JointType::revolute;
    const ElementaryMotion& joint = motions[5 * i + static_cast<int>(revolute ? DhParameter::theta : DhParameter::d)];
    std::copy_n(joint.axis, 3, axes + 3 * i);
    std::copy_n(joint.point, 3, points + 3 * i);
    std::copy_n(i + 1 < c.joints ? motions[5 * (i + 1) + first].point : pose + 12, 3, origins + 3 * i);
  }
}

#if !VERNIER_HEADER_ONLY
VERNIER_FOR_JOINTS(VERNIER_DETAIL_CHAINS, )
#endif

}  // namespace vernier::detail
