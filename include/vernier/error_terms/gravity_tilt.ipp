// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/error_terms/detail/tilting_frames.hpp"
#include "vernier/error_terms/gravity_tilt.hpp"

namespace vernier {

VERNIER_IMPL GravityTilt::GravityTilt(const detail::ChainTable& chain, const Vector3& down)
    : chain_(chain), down_(down) {
  demand(std::abs(down.norm() - 1) < 1e-6, "GravityTilt: the direction of gravity has length ", down.norm(),
         ", must be 1");
}

VERNIER_IMPL void GravityTilt::basis(const double* q, MatrixRef out) const noexcept {
  detail::TiltingFrames frames;
  detail::find_tilting_frames(chain_.view(), q, frames);
  for (int i = 0; i < joints(); ++i) {
    const double gravity[] = {frames.x[i].dot(down_), frames.y[i].dot(down_), frames.z[i].dot(down_)};
    for (int axis = 0; axis < 2; ++axis)
      for (int k = 0; k < 3; ++k) {
        const Vector3 turn = gravity[k] * (axis == 0 ? frames.x[i] : frames.y[i]), shift = frames.origin[i].cross(turn);
        for (int r = 0; r < 3; ++r) {
          out(r, 6 * i + 3 * axis + k) = shift(r);
          out(r + 3, 6 * i + 3 * axis + k) = turn(r);
        }
      }
  }
}

VERNIER_IMPL Vector6 GravityTilt::motion(const double* q, const double* coefficients, double* rates) const noexcept {
  detail::TiltingFrames frames;
  detail::find_tilting_frames(chain_.view(), q, frames);
  Vector6 out = Vector6::Zero();
  const auto add = [](const Vector3& shift, const Vector3& turn, double* to) {
    for (int r = 0; r < 3; ++r) {
      to[r] += shift(r);
      to[r + 3] += turn(r);
    }
  };
  if (rates != nullptr) std::fill_n(rates, 6 * joints(), 0.0);
  for (int i = 0; i < joints(); ++i) {
    const Vector3& origin = frames.origin[i];
    // by a direction of gravity, the base frame's coordinates in and out
    const auto tilt = [&](const Vector3& gravity) {
      const double x = frames.x[i].dot(gravity), y = frames.y[i].dot(gravity), z = frames.z[i].dot(gravity);
      const double* c = coefficients + 6 * i;
      Vector3 turn = (c[0] * x + c[1] * y + c[2] * z) * frames.x[i];
      turn += (c[3] * x + c[4] * y + c[5] * z) * frames.y[i];
      return turn;
    };
    const Vector3 turn = tilt(down_);
    add(origin.cross(turn), turn, out.data());
    for (int k = 0; rates != nullptr && k <= i; ++k) {
      const Vector3& axis = frames.axis[k];
      if (!chain_.revolute(k)) {
        add(axis.cross(turn), Vector3::Zero(), rates + 6 * k);
        continue;
      }
      Vector3 turned = axis.cross(turn);
      turned += tilt(down_.cross(axis));
      const Vector3 arm = origin - frames.point[k], moved = axis.cross(arm);
      Vector3 shift = moved.cross(turn);
      shift += origin.cross(turned);
      add(shift, turned, rates + 6 * k);
    }
  }
  return out;
}

}  // namespace vernier
