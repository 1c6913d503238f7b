// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/error_terms/detail/tilting_frames.hpp"
#include "vernier/error_terms/straightness.hpp"

namespace vernier {

VERNIER_IMPL Straightness::Straightness(const detail::ChainTable& chain, std::vector<JointRange> ranges, int orders)
    : chain_(chain), ranges_(std::move(ranges)), orders_(orders) {
  demand(orders >= 1, "Straightness: ", orders, " orders, must be at least 1");
  demand(ranges_.size() == static_cast<std::size_t>(chain.joints()), "Straightness: ranges of ", ranges_.size(),
         " joints, expected ", chain.joints());
  for (int j = 0; j < chain.joints(); ++j) {
    if (chain.revolute(j)) continue;
    const JointRange& range = ranges_[static_cast<std::size_t>(j)];
    demand(range.lower < range.upper && std::isfinite(range.upper - range.lower), "Straightness: the range of joint ",
           j + 1, " is ", range.lower, " to ", range.upper, " m, must be finite and not empty");
    guides_.push_back(j);
  }
}

namespace detail {

/// An angle that grows by half a turn over a range, and its slope; constant beyond.
struct GuideAngle {
  double angle, slope;
};
VERNIER_LOCAL inline GuideAngle guide_angle(const JointRange& range, double q) noexcept {
  const double rate = std::numbers::pi / (range.upper - range.lower);
  if (q <= range.lower) return {0, 0};
  if (q >= range.upper) return {std::numbers::pi, 0};
  return {rate * (q - range.lower), rate};
}

}  // namespace detail

VERNIER_IMPL void Straightness::basis(const double* q, MatrixRef out) const noexcept {
  detail::TiltingFrames frames;
  detail::find_tilting_frames(chain_.view(), q, frames);
  Index at = 0;
  for (const int p : guides_) {
    const double angle = detail::guide_angle(ranges_[static_cast<std::size_t>(p)], q[p]).angle;
    const Vector3* axes[] = {&frames.x[p], &frames.y[p], &frames.z[p]};
    for (int component = 0; component < 6; ++component) {
      const Vector3& axis = *axes[component % 3];
      Vector3 shift = axis, turn = Vector3::Zero();
      if (component >= 3) {
        shift = frames.origin[p].cross(axis);
        turn = axis;
      }
      for (int k = 1; k <= orders_; ++k, ++at) {
        const double value = std::cos(k * angle);
        for (int r = 0; r < 3; ++r) {
          out(r, at) = value * shift(r);
          out(r + 3, at) = value * turn(r);
        }
      }
    }
  }
}

VERNIER_IMPL Vector6 Straightness::motion(const double* q, const double* coefficients, double* rates) const noexcept {
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
  for (const int p : guides_) {
    const auto [angle, rate] = detail::guide_angle(ranges_[static_cast<std::size_t>(p)], q[p]);
    double value[6], slope[6];
    for (int component = 0; component < 6; ++component) {
      value[component] = slope[component] = 0;
      for (int k = 1; k <= orders_; ++k) {
        const double c = *coefficients++;
        value[component] += c * std::cos(k * angle);
        slope[component] -= c * k * rate * std::sin(k * angle);
      }
    }
    const auto in_base = [&](const double* v) {
      Vector3 sum = v[0] * frames.x[p];
      sum += v[1] * frames.y[p];
      sum += v[2] * frames.z[p];
      return sum;
    };
    const Vector3 &origin = frames.origin[p], moved = in_base(value), turn = in_base(value + 3);
    Vector3 shift = origin.cross(turn);
    shift += moved;
    add(shift, turn, out.data());
    if (rates == nullptr) continue;
    const Vector3 moving = in_base(slope), turning = in_base(slope + 3);
    Vector3 change = frames.axis[p].cross(turn);
    change += moving;
    change += origin.cross(turning);
    add(change, turning, rates + 6 * p);
    for (int k = 0; k < p; ++k) {
      const Vector3& axis = frames.axis[k];
      if (!chain_.revolute(k)) {
        add(axis.cross(turn), Vector3::Zero(), rates + 6 * k);
        continue;
      }
      const Vector3 turned = axis.cross(turn), arm = origin - frames.point[k], swept = axis.cross(arm);
      Vector3 swung = axis.cross(moved);
      swung += swept.cross(turn);
      swung += origin.cross(turned);
      add(swung, turned, rates + 6 * k);
    }
  }
  return out;
}

}  // namespace vernier
