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
#include "vernier/core/types.hpp"
#include "vernier/kinematics/constexpr_trig.hpp"
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
using BlockFrame = MovingFrame<typename Simd<W>::Double, 3>;

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
  VERNIER_INLINE void end(PoseFrame<W>& frame) const {
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

/// All that moves what lies behind it, as parameters are counted, and where the tool is.
template <int N>
struct ElementaryMotions {
  ElementaryMotion all[5 * N];
  Isometry3 tool;

  const ElementaryMotion& of(int i, DhParameter parameter) const { return all[5 * i + static_cast<int>(parameter)]; }
};

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
      placement.end<W>(frame);
      store_pose<W>(out.tool.data(), frame);
    });
    return out;
  }

  /// From base to tool at W joint combinations, joint i of the first at q[i * stride].
  template <int W>
  VERNIER_INLINE void walk_block(const double* q, Index stride, BlockFrame<W>& frame) const {
    using Double = typename Simd<W>::Double;
    Double joint[N], angle[N], sine[N], cosine[N];
    for (std::size_t i = 0; i < N; ++i) {
      load<W>(joint[i], q + static_cast<Index>(i) * stride);
      angle[i] = theta[i] + turning[i] * joint[i];
    }
    sincos<W>(angle, sine, cosine);
    frame.set_identity();
    for (std::size_t i = 0; i < N; ++i) {
      Double offset = Double{} + rows[i].d;
      if (rows[i].joint == JointType::prismatic) offset += joint[i];
      walk_row(i, sine[i], cosine[i], offset, frame, [](DhParameter, const auto&) VERNIER_INLINED {});
    }
  }
};

}  // namespace vernier::detail
