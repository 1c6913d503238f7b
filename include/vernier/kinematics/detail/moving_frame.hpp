// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Frames that are carried along a chain, of one pose or of W poses at a time, and the screws that they meet.

#include "vernier/core/simd.hpp"
#include "vernier/core/types.hpp"
#include "vernier/kinematics/dh.hpp"

namespace vernier::detail {

/// Axes and origin of a frame, in base coordinates, each of `Parts` values. Three values are three coordinates; fewer
/// are vectors that hold the three, and the last lane is idle.
template <class V, int Parts>
struct MovingFrame {
  V x[Parts], y[Parts], z[Parts], p[Parts];

  VERNIER_INLINE void set_identity() {
    for (int k = 0; k < Parts; ++k) x[k] = y[k] = z[k] = p[k] = V{};
    if constexpr (Parts == 3) {
      x[0] = y[1] = z[2] = V{} + 1.0;
    } else if constexpr (Parts == 2) {
      x[0] = z[1] = V{1, 0};
      y[0] = V{0, 1};
    } else {
      x[0] = V{1, 0, 0, 0};
      y[0] = V{0, 1, 0, 0};
      z[0] = V{0, 0, 1, 0};
    }
  }

  /// As a matrix, where V is a scalar.
  IsometryOf<V> isometry() const {
    IsometryOf<V> t = IsometryOf<V>::Identity();  // its last row is set too
    for (int k = 0; k < 3; ++k) t.matrix().row(k) << x[k], y[k], z[k], p[k];
    return t;
  }

  template <class C>
  VERNIER_INLINE static void turn(V (&from)[Parts], V (&towards)[Parts], const C& c, const C& s) {
    VERNIER_UNROLL
    for (int k = 0; k < Parts; ++k) {
      const V turned = c * from[k] + s * towards[k];
      towards[k] = c * towards[k] - s * from[k];
      from[k] = turned;
    }
  }
  template <class C>
  VERNIER_INLINE void rotate_x(const C& c, const C& s) {
    turn(y, z, c, s);
  }
  template <class C>
  VERNIER_INLINE void rotate_y(const C& c, const C& s) {
    turn(z, x, c, s);
  }
  template <class C>
  VERNIER_INLINE void rotate_z(const C& c, const C& s) {
    turn(x, y, c, s);
  }
  template <class C>
  VERNIER_INLINE void move(const V (&axis)[Parts], const C& length) {
    VERNIER_UNROLL
    for (int k = 0; k < Parts; ++k) p[k] += length * axis[k];
  }
};

/// The frame of one pose, in vectors of W coordinates.
template <int W>
using PoseFrame = MovingFrame<typename Simd<W>::Double, 4 / W>;

/// The frames of W poses.
template <int W>
struct BlockFrame : MovingFrame<typename Simd<W>::Double, 3> {
  static constexpr int width = W;

  using Double = typename Simd<W>::Double;

  /// A direction fixed in the frames, in base coordinates.
  VERNIER_INLINE void direction(const double* fixed, Double (&out)[3]) const {
    VERNIER_UNROLL
    for (int k = 0; k < 3; ++k) out[k] = fixed[0] * this->x[k] + fixed[1] * this->y[k] + fixed[2] * this->z[k];
  }

  /// Rotates the frames about their own origins by the rotation of a 4 x 4 matrix, column-major.
  VERNIER_INLINE void rotate(const double* pose) {
    Double axes[3][3];
    for (int k = 0; k < 3; ++k) direction(pose + 4 * k, axes[k]);
    for (int k = 0; k < 3; ++k) this->x[k] = axes[0][k], this->y[k] = axes[1][k], this->z[k] = axes[2][k];
  }

  VERNIER_INLINE void store_positions(double* first, Index stride) const {
    VERNIER_UNROLL
    for (int k = 0; k < 3; ++k) store<W>(first + k * stride, this->p[k]);
  }

  /// Each pose as 16 numbers, row by row.
  VERNIER_INLINE void store_matrices(double* out) const {
    using Pair = typename Simd<2>::Double;
    for (int lane = 0; lane < W; ++lane, out += 16) {
      VERNIER_UNROLL
      for (int k = 0; k < 3; ++k) {
        store<2>(out + 4 * k, Pair{this->x[k][lane], this->y[k][lane]});
        store<2>(out + 4 * k + 2, Pair{this->z[k][lane], this->p[k][lane]});
      }
      store<2>(out + 12, Pair{0, 0});
      store<2>(out + 14, Pair{0, 1});
    }
  }

  VERNIER_INLINE void store_poses(Isometry3* out) const {
    for (int lane = 0; lane < W; ++lane) {
      double* pose = out[lane].data();
      VERNIER_UNROLL
      for (int k = 0; k < 3; ++k) {
        pose[k] = this->x[k][lane];
        pose[4 + k] = this->y[k][lane];
        pose[8 + k] = this->z[k][lane];
        pose[12 + k] = this->p[k][lane];
      }
    }
  }
};

/// Reads a 4 x 4 matrix.
template <int W>
VERNIER_INLINE void load_pose(PoseFrame<W>& frame, const double* from) {
  VERNIER_UNROLL
  for (int k = 0; k < 4 / W; ++k) {
    load<W>(frame.x[k], from + k * W);
    load<W>(frame.y[k], from + 4 + k * W);
    load<W>(frame.z[k], from + 8 + k * W);
    load<W>(frame.p[k], from + 12 + k * W);
  }
}

/// Writes three coordinates and an idle one.
template <int W>
VERNIER_INLINE void store_vector(double* out, const typename Simd<W>::Double (&v)[4 / W]) {
  VERNIER_UNROLL
  for (int k = 0; k < 4 / W; ++k) store<W>(out + k * W, v[k]);
}

/// Writes a 4 x 4 matrix.
template <int W>
VERNIER_INLINE void store_pose(double* out, const PoseFrame<W>& frame) {
  store_vector<W>(out, frame.x);
  store_vector<W>(out + 4, frame.y);
  store_vector<W>(out + 8, frame.z);
  store_vector<W>(out + 12, frame.p);
  out[3] = out[7] = out[11] = 0;
  out[15] = 1;
}

/// Where a chain stands, and which point fixed in its tool frame counts; null for its own base, and the tool's origin.
struct Placement {
  const double* base = nullptr;   // 4 x 4, column-major
  const double* point = nullptr;  // three coordinates

  template <int W>
  VERNIER_INLINE void begin(PoseFrame<W>& frame) const {
    base != nullptr ? load_pose<W>(frame, base) : frame.set_identity();
  }
  template <int W>
  VERNIER_INLINE void begin(BlockFrame<W>& frame) const {
    frame.set_identity();
    if (base == nullptr) return;
    VERNIER_UNROLL
    for (int k = 0; k < 3; ++k) {
      frame.x[k] = typename Simd<W>::Double{} + base[k];
      frame.y[k] = typename Simd<W>::Double{} + base[4 + k];
      frame.z[k] = typename Simd<W>::Double{} + base[8 + k];
      frame.p[k] = typename Simd<W>::Double{} + base[12 + k];
    }
  }
  template <class V, int Parts>
  VERNIER_INLINE void end(MovingFrame<V, Parts>& frame) const {
    if (point == nullptr) return;
    frame.move(frame.x, point[0]);
    frame.move(frame.y, point[1]);
    frame.move(frame.z, point[2]);
  }
};

/// A screw along the chain: what one elementary motion does to everything behind it.
struct ElementaryMotion {
  double axis[4], point[4];

  /// Column of a Jacobian at the tool point.
  VERNIER_INLINE void column(bool rotation, const double* tool, double* out) const {
    if (rotation) {
      const double x = tool[0] - point[0], y = tool[1] - point[1], z = tool[2] - point[2];
      out[0] = axis[1] * z - axis[2] * y;
      out[1] = axis[2] * x - axis[0] * z;
      out[2] = axis[0] * y - axis[1] * x;
    } else {
      out[0] = axis[0], out[1] = axis[1], out[2] = axis[2];
    }
    for (int k = 0; k < 3; ++k) out[3 + k] = rotation ? axis[k] : 0;
  }
};

/// An elementary motion in W poses, coordinates as in a `BlockFrame`.
template <int W>
struct BlockMotion {
  using Double = typename Simd<W>::Double;
  Double axis[3], point[3];

  VERNIER_INLINE void set(const Double (&direction)[3], const Double (&through)[3]) {
    for (int k = 0; k < 3; ++k) axis[k] = direction[k], point[k] = through[k];
  }
  VERNIER_INLINE void set_constant(const double* direction, const double* through) {
    for (int k = 0; k < 3; ++k) axis[k] = Double{} + direction[k], point[k] = Double{} + through[k];
  }
};

/// Writes columns of the Jacobians of W poses into `JacobianRows`.
template <int W>
struct BlockColumns {
  using Double = typename Simd<W>::Double;
  double* entries;          // (0, 0) of the first of the poses
  Index stride;             // from entry to entry: number of all poses
  const Double (&tool)[3];  // where the tool points are

  VERNIER_INLINE BlockColumns(double* first, Index rows, const BlockFrame<W>& frame)
      : entries(first), stride(rows), tool(frame.p) {}

  VERNIER_INLINE void write(int column, bool rotation, const BlockMotion<W>& m) const {
    Double linear[3] = {m.axis[0], m.axis[1], m.axis[2]};
    if (rotation) {
      const Double x = tool[0] - m.point[0], y = tool[1] - m.point[1], z = tool[2] - m.point[2];
      linear[0] = m.axis[1] * z - m.axis[2] * y;
      linear[1] = m.axis[2] * x - m.axis[0] * z;
      linear[2] = m.axis[0] * y - m.axis[1] * x;
    }
    double* out = entries + 6 * column * stride;
    VERNIER_UNROLL
    for (int k = 0; k < 3; ++k) {
      store<W>(out + k * stride, linear[k]);
      store<W>(out + (3 + k) * stride, rotation ? m.axis[k] : Double{});
    }
  }

  /// The column of joint i of a chain.
  VERNIER_INLINE void write_joint(int i, JointType joint, const BlockMotion<W>* motions) const {
    const bool revolute = joint == JointType::revolute;
    write(i, revolute, motions[5 * i + static_cast<int>(revolute ? DhParameter::theta : DhParameter::d)]);
  }

  /// All columns of a chain's parameters, the first of them in column `first`.
  VERNIER_INLINE void write_parameters(int first, const BlockMotion<W>* motions, int joints) const {
    for (int i = 0; i < 5 * joints; i += 5) {
      VERNIER_UNROLL
      for (int k = 0; k < 5; ++k) {
        const auto parameter = static_cast<DhParameter>(k);
        write(first + i + k, parameter != DhParameter::a && parameter != DhParameter::d, motions[i + k]);
      }
    }
  }
};

}  // namespace vernier::detail
