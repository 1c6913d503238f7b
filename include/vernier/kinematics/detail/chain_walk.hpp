// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A frame carried along a Denavit-Hartenberg chain. Of a single pose all joints' sines come from one vector operation,
/// and a vector holds the coordinates of an axis; of a block (chain_blocks.hpp) it holds one coordinate of W poses.
/// Both do the same operations in the same order, so they give the same bits.

#include <algorithm>
#include <array>

#include "vernier/core/same_value.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/kinematics/detail/constexpr_trig.hpp"
#include "vernier/kinematics/detail/moving_frame.hpp"

namespace vernier::detail {

/// Carries a frame over a row; `record(parameter, axis)` is called before each elementary motion.
/// @param sine,cosine of the row's theta
/// @param offset      the row's d
template <class Convention, class V, int Parts, class C, class Record>
VERNIER_INLINE void walk_row(const DhRow& row, const SinCos& twist, const SinCos& hayati, const C& sine,
                             const C& cosine, const C& offset, MovingFrame<V, Parts>& frame, const Record& record) {
  VERNIER_UNROLL
  for (std::size_t k = 0; k < 5; ++k) {
    const DhParameter parameter = Convention::order[k];
    switch (parameter) {
      case DhParameter::a:
        record(parameter, frame.x);
        frame.move(frame.x, row.a);
        break;
      case DhParameter::alpha:
        record(parameter, frame.x);
        frame.rotate_x(twist.cos, twist.sin);
        break;
      case DhParameter::beta:
        record(parameter, frame.y);
        if (!same_value(hayati.sin, 0)) frame.rotate_y(hayati.cos, hayati.sin);
        break;
      case DhParameter::d:
        record(parameter, frame.z);
        frame.move(frame.z, offset);
        break;
      case DhParameter::theta:
        record(parameter, frame.z);
        frame.rotate_z(cosine, sine);
        break;
    }
  }
}

/// The rows of a chain of any number of joints, with all that does not depend on the joint values.
struct ChainView {
  int joints;
  bool modified;          ///< Craig's convention
  const DhRow* rows;      ///< one a joint, as all below
  const double* theta;    ///< joint angle at zero
  const double* turning;  ///< 1 where the joint value adds to theta, 0 where it adds to d
  const SinCos* twist;    ///< of alpha
  const SinCos* hayati;   ///< of beta
};

/// Rows of a chain of N joints by value: the numbers that a `ChainView` points to.
template <int N, class Convention>
struct ChainRows {
  std::array<DhRow, N> rows{};
  std::array<double, N> theta{}, turning{};
  std::array<SinCos, N> twist{}, hayati{};

  constexpr ChainRows() = default;
  constexpr explicit ChainRows(const std::array<DhRow, N>& table) : rows(table) {
    for (std::size_t i = 0; i < N; ++i) {
      theta[i] = rows[i].theta;
      turning[i] = rows[i].joint == JointType::revolute ? 1 : 0;
      twist[i] = constexpr_sincos(rows[i].alpha);
      hayati[i] = constexpr_sincos(rows[i].beta);
    }
  }

  ChainView view() const {
    return {N, Convention::modified, rows.data(), theta.data(), turning.data(), twist.data(), hayati.data()};
  }
};

/// From where the frame is, the base, to the tool at joints q; `record(row, parameter, axis, point)` sees each
/// elementary motion before it is made.
/// @tparam N number of joints; 0 where only the chain knows it
template <class Convention, int N, int W, class Record>
VERNIER_INLINE void walk_pose(const ChainView& c, const double* q, PoseFrame<W>& frame, const Record& record) {
  using Double = typename Simd<W>::Double;
  const int joints = N > 0 ? N : c.joints;
  double sines[(N > 0 ? N : max_joints) + W], cosines[(N > 0 ? N : max_joints) + W];
  constexpr int vectors = N > 0 ? (N + W - 1) / W : 1;  // whose sines are computed side by side
  for (int next = 0; next < joints; next += vectors * W) {
    Double angle[vectors], sine[vectors], cosine[vectors];
    VERNIER_UNROLL
    for (int k = 0; k < vectors; ++k) {
      if (joints >= W) {
        const int first = (std::min)(next + k * W, joints - W);  // the last vector overlaps with the one before
        Double joint, turning;
        load<W>(joint, q + first);
        load<W>(turning, c.turning + first);
        load<W>(angle[k], c.theta + first);
        angle[k] += turning * joint;
      } else {
        Double angles{};
        for (int i = 0; i < joints; ++i) angles[i] = c.theta[i] + c.turning[i] * q[i];
        angle[k] = angles;
      }
    }
    sincos<W>(angle, sine, cosine);
    VERNIER_UNROLL
    for (int k = 0; k < vectors; ++k) {
      const int first = (std::max)(0, (std::min)(next + k * W, joints - W));
      store<W>(sines + first, sine[k]);
      store<W>(cosines + first, cosine[k]);
    }
  }
  for (int i = 0; i < joints; ++i) {
    const DhRow& r = c.rows[i];
    const double offset = r.joint == JointType::revolute ? r.d : r.d + q[i];
    walk_row<Convention>(r, c.twist[i], c.hayati[i], sines[i], cosines[i], offset, frame,
                         [&](DhParameter parameter, const auto& axis)
                             VERNIER_INLINED { record(i, parameter, axis, frame.p); });
  }
}

/// Pose, 4 x 4, of a chain of N joints.
template <class Convention, int N>
VERNIER_TEMPLATE_API void chain_pose(const ChainView& chain, const double* q, double* pose,
                                     InstructionSet set = widest_instruction_set()) noexcept {
  run_same_bits(
      [&]<int W>() VERNIER_INLINED {
        PoseFrame<W> frame;
        frame.set_identity();
        walk_pose<Convention, N, W>(chain, q, frame, [](int, DhParameter, const auto&, const auto&) VERNIER_INLINED {});
        store_pose<W>(pose, frame);
      },
      set);
}

/// Pose, 4 x 4, and geometric Jacobian, 6 x N, of a chain of N joints.
template <class Convention, int N>
VERNIER_TEMPLATE_API void chain_pose_and_jacobian(const ChainView& chain, const Placement& placement, const double* q,
                                                  double* pose, double* jacobian) noexcept {
  run_same_bits([&]<int W>() VERNIER_INLINED {
    ElementaryMotion joints[N];
    PoseFrame<W> frame;
    placement.begin<W>(frame);
    walk_pose<Convention, N, W>(chain, q, frame,
                                [&](int i, DhParameter parameter, const auto& axis, const auto& point) VERNIER_INLINED {
                                  if (parameter != DhParameter::theta) return;  // a sliding joint's axis is the same
                                  store_vector<W>(joints[i].axis, axis);
                                  store_vector<W>(joints[i].point, point);
                                });
    placement.end(frame);
    store_pose<W>(pose, frame);
    for (int i = 0; i < N; ++i)
      joints[i].column(chain.rows[i].joint == JointType::revolute, pose + 12, jacobian + 6 * i);
  });
}

// For up to nine joints they are compiled once.
/// @cond
#define VERNIER_DETAIL_CHAIN(EXTERN, CONVENTION, N)                                                                  \
  EXTERN template void chain_pose<CONVENTION, N>(const ChainView&, const double*, double*, InstructionSet) noexcept; \
  EXTERN template void chain_pose_and_jacobian<CONVENTION, N>(const ChainView&, const Placement&, const double*,     \
                                                              double*, double*) noexcept;
#define VERNIER_DETAIL_CHAINS(EXTERN, N)      \
  VERNIER_DETAIL_CHAIN(EXTERN, StandardDh, N) \
  VERNIER_DETAIL_CHAIN(EXTERN, ModifiedDh, N)
/// @endcond
#if !VERNIER_HEADER_ONLY
VERNIER_FOR_JOINTS(VERNIER_DETAIL_CHAINS, extern)
#endif

}  // namespace vernier::detail
