#pragma once

/// @file
/// A frame carried along a Denavit-Hartenberg chain: one walk for single poses, blocks of poses and dual numbers.
///
/// Of a single pose all joints' sines come from one vector operation, and a vector holds the coordinates of an axis; of
/// a block it holds one coordinate of W poses. Both do the same operations in the same order, so they give the same
/// bits.

#include <algorithm>
#include <array>

#include "vernier/core/simd.hpp"
#include "vernier/kinematics/constexpr_trig.hpp"
#include "vernier/kinematics/moving_frame.hpp"

namespace vernier::detail {

/// Rows of a chain, with all that does not depend on the joints.
template <int N, class Convention>
struct ChainRows {
  std::array<DhRow, N> rows{};
  std::array<double, N> theta{}, turning{};  // angles at zero; 1 where the joint adds to them, 0 where it adds to d
  std::array<SinCos, N> twist{}, hayati{};   // of alpha, of beta

  constexpr ChainRows() = default;
  constexpr explicit ChainRows(const std::array<DhRow, N>& table) : rows(table) {
    for (std::size_t i = 0; i < N; ++i) {
      theta[i] = rows[i].theta;
      turning[i] = rows[i].joint == JointType::revolute ? 1 : 0;
      twist[i] = constexpr_sincos(rows[i].alpha);
      hayati[i] = constexpr_sincos(rows[i].beta);
    }
  }

  /// Carries a frame over row i; `record(parameter, axis)` is called before each elementary motion.
  template <class V, int Parts, class C, class Record>
  VERNIER_INLINE void walk_row(std::size_t i, const C& sine, const C& cosine, const C& offset,
                               MovingFrame<V, Parts>& frame, const Record& record) const {
    VERNIER_UNROLL
    for (std::size_t k = 0; k < 5; ++k) {
      const DhParameter parameter = Convention::order[k];
      switch (parameter) {
        case DhParameter::a:
          record(parameter, frame.x);
          frame.move(frame.x, rows[i].a);
          break;
        case DhParameter::alpha:
          record(parameter, frame.x);
          frame.rotate_x(twist[i].cos, twist[i].sin);
          break;
        case DhParameter::beta:
          record(parameter, frame.y);
          if (hayati[i].sin != 0) frame.rotate_y(hayati[i].cos, hayati[i].sin);
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

  /// Sines and cosines of all rows' angles, padded.
  template <int W>
  VERNIER_INLINE void joint_sincos(const double* q, double* sines, double* cosines) const {
    using Double = typename Simd<W>::Double;
    constexpr int vectors = (N + W - 1) / W;
    Double angle[vectors], sine[vectors], cosine[vectors];
    if constexpr (N < W) {
      Double angles{};
      for (std::size_t i = 0; i < N; ++i) angles[i] = theta[i] + turning[i] * q[i];
      angle[0] = angles;
    } else {
      VERNIER_UNROLL
      for (int k = 0; k < vectors; ++k) {
        const int first = std::min(k * W, N - W);  // the last vector overlaps with the one before
        Double joint, adds;
        load<W>(joint, q + first);
        load<W>(adds, turning.data() + first);
        load<W>(angle[k], theta.data() + first);
        angle[k] += adds * joint;
      }
    }
    sincos<W>(angle, sine, cosine);
    VERNIER_UNROLL
    for (int k = 0; k < vectors; ++k) {
      const int first = N < W ? 0 : std::min(k * W, N - W);
      store<W>(sines + first, sine[k]);
      store<W>(cosines + first, cosine[k]);
    }
  }

  /// From where the frame is, the base, to the tool at joints q; `record(row, parameter, axis, point)` sees each
  /// elementary motion before it is made.
  template <int W, class Record>
  VERNIER_INLINE void walk(const double* q, PoseFrame<W>& frame, const Record& record) const {
    double sines[N + W], cosines[N + W];
    joint_sincos<W>(q, sines, cosines);
    for (std::size_t i = 0; i < N; ++i) {
      const DhRow& r = rows[i];
      const double offset = r.joint == JointType::revolute ? r.d : r.d + q[i];
      walk_row(i, sines[i], cosines[i], offset, frame, [&](DhParameter parameter, const auto& axis) VERNIER_INLINED {
        record(static_cast<int>(i), parameter, axis, frame.p);
      });
    }
  }

  /// All elementary motions at joints q.
  ElementaryMotions<N> motions(const double* q, const Placement& placement) const noexcept {
    ElementaryMotions<N> out;
    run_same_bits([&]<int W>() VERNIER_INLINED {
      PoseFrame<W> frame;
      placement.begin<W>(frame);
      walk<W>(q, frame, [&](int i, DhParameter parameter, const auto& axis, const auto& point) VERNIER_INLINED {
        ElementaryMotion& motion = out.all[5 * i + static_cast<int>(parameter)];
        store_vector<W>(motion.axis, axis);
        store_vector<W>(motion.point, point);
      });
      placement.end(frame);
      store_pose<W>(out.tool.data(), frame);
    });
    return out;
  }

  /// From where the frames are to the tool at W joint combinations, joint i of the first at q[i * stride];
  /// `record(row, parameter, axis)` is called before each elementary motion.
  template <int W, class Record>
  VERNIER_INLINE void walk_block(const double* q, Index stride, BlockFrame<W>& frame, const Record& record) const {
    using Double = typename Simd<W>::Double;
    Double joint[N], angle[N], sine[N], cosine[N];
    for (std::size_t i = 0; i < N; ++i) {
      load<W>(joint[i], q + static_cast<Index>(i) * stride);
      angle[i] = theta[i] + turning[i] * joint[i];
    }
    sincos<W>(angle, sine, cosine);
    for (std::size_t i = 0; i < N; ++i) {
      Double offset = Double{} + rows[i].d;
      if (rows[i].joint == JointType::prismatic) offset += joint[i];
      walk_row(i, sine[i], cosine[i], offset, frame, [&](DhParameter parameter, const auto& axis) VERNIER_INLINED {
        record(static_cast<int>(i), parameter, axis);
      });
    }
  }

  /// Walks n joint combinations, W at a time: `use(first row, frames)`; n is at least what a vector holds.
  template <class Use>
  void visit_poses(const JointRows<N>& joints, const Placement& placement, const Use& use) const {
    for_blocks(joints.rows(), [&]<int W>(Index first) VERNIER_INLINED {
      BlockFrame<W> frame;
      placement.begin<W>(frame);
      walk_block<W>(joints.data() + first, joints.rows(), frame, [](int, DhParameter, const auto&) VERNIER_INLINED {});
      placement.end(frame);
      use(first, frame);
    });
  }

  /// The same with all elementary motions, as parameters are counted: `use(first row, frames, motions)`.
  template <class Use>
  void visit_blocks(const JointRows<N>& joints, const Placement& placement, const Use& use) const {
    for_blocks(joints.rows(), [&]<int W>(Index first) VERNIER_INLINED {
      BlockFrame<W> frame;
      BlockMotion<W> motions[5 * N];
      placement.begin<W>(frame);
      walk_block<W>(joints.data() + first, joints.rows(), frame,
                    [&](int i, DhParameter parameter, const auto& axis)
                        VERNIER_INLINED { motions[5 * i + static_cast<int>(parameter)].set(axis, frame.p); });
      placement.end(frame);
      use(first, frame, motions);
    });
  }

 private:
  /// Calls `use.template operator()<W>(first)` for rows first to first + W - 1; the last vector overlaps with the one
  /// before.
  template <class Use>
  static void for_blocks(Index rows, const Use& use) {
    run_same_bits([&]<int W>() VERNIER_INLINED {
      for (Index next = 0; next < rows; next += W) use.template operator()<W>(std::min(next, rows - W));
    });
  }
};

}  // namespace vernier::detail
