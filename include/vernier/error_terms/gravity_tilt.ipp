#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/error_terms/gravity_tilt.hpp"

namespace vernier {

namespace detail {

/// Joint axes, points on them, and the frames that tilt, of a chain at a configuration.
struct TiltingFrames {
  Vector3 axis[max_joints], point[max_joints], origin[max_joints];
  Matrix3 rotation[max_joints];
};

/// See `TiltingFrames`; a frame is the one behind the joint, whose z axis is the joint's.
template <class Convention>
void walk_tilting_frames(const ChainView& c, const double* q, TiltingFrames& out) noexcept {
  MovingFrame<double, 3> frame;
  frame.set_identity();
  const auto vector = [](const double* v) { return Vector3(v[0], v[1], v[2]); };
  for (int i = 0; i < c.joints; ++i) {
    const DhRow& row = c.rows[i];
    const double angle = c.theta[i] + c.turning[i] * q[i];
    const auto store = [&] {
      out.rotation[i] << vector(frame.x), vector(frame.y), vector(frame.z);
      out.origin[i] = vector(frame.p);
    };
    walk_row<Convention>(row, c.twist[i], c.hayati[i], std::sin(angle), std::cos(angle),
                         row.joint == JointType::revolute ? row.d : row.d + q[i], frame,
                         [&](DhParameter parameter, const auto&) {  // before each motion
                           if (parameter == DhParameter::theta) {
                             out.axis[i] = vector(frame.z);
                             out.point[i] = vector(frame.p);
                           }
                           if (parameter == DhParameter::a && !Convention::modified) store();
                         });
    if (Convention::modified) store();
  }
}

VERNIER_API void find_tilting_frames(const ChainView& c, const double* q, TiltingFrames& out) noexcept {
  c.modified ? walk_tilting_frames<ModifiedDh>(c, q, out) : walk_tilting_frames<StandardDh>(c, q, out);
}

}  // namespace detail

VERNIER_IMPL GravityTilt::GravityTilt(const detail::ChainTable& chain, const Vector3& down)
    : chain_(chain), down_(down) {
  require(std::abs(down.norm() - 1) < 1e-6, "GravityTilt: the direction of gravity has length ", down.norm(),
          ", must be 1");
}

VERNIER_IMPL void GravityTilt::basis(const double* q, MatrixRef out) const noexcept {
  detail::TiltingFrames frames;
  detail::find_tilting_frames(chain_.view(), q, frames);
  for (int i = 0; i < joints(); ++i) {
    const Vector3 gravity = frames.rotation[i].transpose() * down_;
    for (int axis = 0; axis < 2; ++axis)
      for (int k = 0; k < 3; ++k) {
        const Vector3 turn = gravity(k) * frames.rotation[i].col(axis);
        out.col(6 * i + 3 * axis + k) << frames.origin[i].cross(turn), turn;
      }
  }
}

VERNIER_IMPL Vector6 GravityTilt::motion(const double* q, const double* coefficients, double* rates) const noexcept {
  detail::TiltingFrames frames;
  detail::find_tilting_frames(chain_.view(), q, frames);
  Vector6 out = Vector6::Zero();
  if (rates != nullptr) std::fill_n(rates, 6 * joints(), 0.0);
  for (int i = 0; i < joints(); ++i) {
    const Matrix3& rotation = frames.rotation[i];
    const Vector3& origin = frames.origin[i];
    // by a direction of gravity, the base frame's coordinates in and out
    const auto tilt = [&](const Vector3& gravity) {
      const Vector3 inside = rotation.transpose() * gravity;
      const double* c = coefficients + 6 * i;
      return Vector3((c[0] * inside(0) + c[1] * inside(1) + c[2] * inside(2)) * rotation.col(0) +
                     (c[3] * inside(0) + c[4] * inside(1) + c[5] * inside(2)) * rotation.col(1));
    };
    const Vector3 turn = tilt(down_);
    out.head<3>() += origin.cross(turn);
    out.tail<3>() += turn;
    for (int k = 0; rates != nullptr && k <= i; ++k) {
      Eigen::Map<Vector6> rate(rates + 6 * k);
      const Vector3& axis = frames.axis[k];
      if (!chain_.revolute(k)) {
        rate.head<3>() += axis.cross(turn);
        continue;
      }
      const Vector3 turned = axis.cross(turn) + tilt(down_.cross(axis));
      rate.head<3>() += axis.cross(origin - frames.point[k]).cross(turn) + origin.cross(turned);
      rate.tail<3>() += turned;
    }
  }
  return out;
}

}  // namespace vernier
