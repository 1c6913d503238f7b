// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/error_terms/detail/tilting_frames.hpp"
#include "vernier/error_terms/payload_bend.hpp"

namespace vernier {

VERNIER_IMPL void PayloadBend::basis(const double* q, const PayloadLoad& load, MatrixRef out) const noexcept {
  detail::TiltingFrames frames;
  detail::find_tilting_frames(springs_.chain().view(), q, frames);
  const Vector3 moment = detail::moment_about_base(springs_.chain(), q, load);
  for (int i = 0; i < joints(); ++i) {
    const Vector3 lever = moment - load.weight * frames.origin[i], torque = lever.cross(down());
    for (int axis = 0; axis < 2; ++axis) {
      const Vector3& about = axis == 0 ? frames.x[i] : frames.y[i];
      const Vector3 turn = about.dot(torque) * about, shift = frames.origin[i].cross(turn);
      for (int r = 0; r < 3; ++r) {
        out(r, 2 * i + axis) = shift(r);
        out(r + 3, 2 * i + axis) = turn(r);
      }
    }
  }
}

VERNIER_IMPL Vector6 PayloadBend::motion(const double* q, const PayloadLoad& load, const double* compliances,
                                         double* rates) const noexcept {
  const detail::ChainTable& chain = springs_.chain();
  detail::TiltingFrames frames;
  detail::find_tilting_frames(chain.view(), q, frames);
  const Vector3 moment = detail::moment_about_base(chain, q, load);
  Vector6 out = Vector6::Zero();
  const auto add = [](const Vector3& shift, const Vector3& turn, double* to) {
    for (int r = 0; r < 3; ++r) {
      to[r] += shift(r);
      to[r + 3] += turn(r);
    }
  };
  if (rates != nullptr) std::fill_n(rates, 6 * joints(), 0.0);
  for (int i = 0; i < joints(); ++i, compliances += 2) {
    const Vector3 &origin = frames.origin[i], lever = moment - load.weight * origin;
    // by a torque, in the base frame's coordinates
    const auto bend = [&](const Vector3& torque) {
      Vector3 turn = compliances[0] * frames.x[i].dot(torque) * frames.x[i];
      turn += compliances[1] * frames.y[i].dot(torque) * frames.y[i];
      return turn;
    };
    const Vector3 torque = lever.cross(down()), turn = bend(torque);
    add(origin.cross(turn), turn, out.data());
    for (int k = 0; rates != nullptr && k < joints(); ++k) {
      const Vector3& axis = frames.axis[k];
      const bool before = k <= i;  // moves the frame, and the load along with it
      if (!chain.revolute(k)) {
        if (before) {
          add(axis.cross(turn), Vector3::Zero(), rates + 6 * k);
        } else {
          const Vector3 pushed = load.weight * axis, turned = bend(pushed.cross(down()));
          add(origin.cross(turned), turned, rates + 6 * k);
        }
        continue;
      }
      if (before) {  // in the frame only the direction of gravity changes
        const Vector3 gravity = down().cross(axis), arm = origin - frames.point[k], moved = axis.cross(arm);
        Vector3 turned = axis.cross(turn);
        turned += bend(lever.cross(gravity));
        Vector3 shift = moved.cross(turn);
        shift += origin.cross(turned);
        add(shift, turned, rates + 6 * k);
      } else {
        const Vector3 beyond = moment - load.weight * frames.point[k], swept = axis.cross(beyond);
        const Vector3 turned = bend(swept.cross(down()));
        add(origin.cross(turned), turned, rates + 6 * k);
      }
    }
  }
  return out;
}

}  // namespace vernier
