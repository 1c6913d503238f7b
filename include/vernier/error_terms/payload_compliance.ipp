// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/error_terms/payload_compliance.hpp"
#include "vernier/kinematics/detail/chain_blocks.hpp"

namespace vernier {

namespace detail {

/// Axes of the joints, points on them, and the weight of a load at the end of a chain with its moment about the base.
struct LoadedLinks {
  double axes[3 * max_joints], points[3 * max_joints], origins[3 * max_joints];
  Vector3 moment;

  Vector3 axis(int i) const { return {axes[3 * i], axes[3 * i + 1], axes[3 * i + 2]}; }
  Vector3 point(int i) const { return {points[3 * i], points[3 * i + 1], points[3 * i + 2]}; }
  /// The moment about a point on axis k.
  Vector3 about(int k, double weight) const {
    const Vector3 shift = weight * point(k);
    return moment - shift;
  }
};

/// Turns the first of two columns of a rotation towards the second.
VERNIER_LOCAL inline void turn_axes(Matrix3& rotation, int from, int towards, const SinCos& angle) noexcept {
  for (int r = 0; r < 3; ++r) {
    const double a = rotation(r, from), b = rotation(r, towards);
    rotation(r, from) = angle.cos * a + angle.sin * b;
    rotation(r, towards) = angle.cos * b - angle.sin * a;
  }
}

VERNIER_LOCAL LoadedLinks loaded_links(const ChainTable& chain, const double* q, const PayloadLoad& load) noexcept {
  LoadedLinks out;
  const ChainView view = chain.view();
  chain_links(view, q, out.axes, out.points, out.origins);
  Matrix3 flange = Matrix3::Identity();
  for (int i = 0; i < view.joints; ++i) {
    const double angle = view.rows[i].theta + (chain.revolute(i) ? q[i] : 0);
    const SinCos turned{std::sin(angle), std::cos(angle)};
    if (view.modified) {
      turn_axes(flange, 1, 2, view.twist[i]);
      turn_axes(flange, 2, 0, view.hayati[i]);
      turn_axes(flange, 0, 1, turned);
    } else {
      turn_axes(flange, 0, 1, turned);
      turn_axes(flange, 1, 2, view.twist[i]);
      turn_axes(flange, 2, 0, view.hayati[i]);
    }
  }
  const double* end = out.origins + 3 * (view.joints - 1);
  out.moment = flange * load.moment;
  for (int r = 0; r < 3; ++r) out.moment(r) += load.weight * end[r];
  return out;
}

}  // namespace detail

VERNIER_IMPL Vector3 detail::moment_about_base(const ChainTable& chain, const double* q,
                                               const PayloadLoad& load) noexcept {
  return loaded_links(chain, q, load).moment;
}

VERNIER_IMPL Payload Payload::of(const ConstMatrixRef& payloads, Index row) {
  return {payloads(row, 0), {payloads(row, 1), payloads(row, 2), payloads(row, 3)}};
}

VERNIER_IMPL Payload Payload::at(const Vector3& tool_point) const {
  Payload out = *this;
  for (Index k = 0; k < 3; ++k)
    if (!std::isfinite(centre(k))) out.centre(k) = tool_point(k);
  return out;
}

VERNIER_IMPL PayloadCompliance::PayloadCompliance(const detail::ChainTable& chain, const Vector3& down,
                                                  const Payload& reference)
    : chain_(chain), down_(down), reference_(reference) {
  demand(std::abs(down.norm() - 1) < 1e-6, "PayloadCompliance: the direction of gravity has length ", down.norm(),
         ", must be 1");
  demand(std::isfinite(reference.mass) && reference.mass >= 0 && std::isfinite(reference.centre.sum()),
         "PayloadCompliance: the reference payload of ", reference.mass, " kg is not finite, or negative");
}

VERNIER_IMPL PayloadLoad PayloadCompliance::load(const Payload& payload) const noexcept {
  PayloadLoad out;
  if (!std::isfinite(payload.mass) || !std::isfinite(payload.centre.sum())) return out;
  out.weight = detail::standard_gravity * (payload.mass - reference_.mass);
  for (Index k = 0; k < 3; ++k)
    out.moment(k) =
        detail::standard_gravity * (payload.mass * payload.centre(k) - reference_.mass * reference_.centre(k));
  return out;
}

VERNIER_IMPL void PayloadCompliance::torques(const double* q, const PayloadLoad& load, double* out) const noexcept {
  const detail::LoadedLinks links = detail::loaded_links(chain_, q, load);
  for (int i = 0; i < joints(); ++i) {
    const Vector3 axis = links.axis(i), lever = links.about(i, load.weight);
    out[i] = chain_.revolute(i) ? axis.dot(lever.cross(down_)) : load.weight * axis.dot(down_);
  }
}

VERNIER_IMPL void PayloadCompliance::add(const double* q, const PayloadLoad& load, const double* compliances,
                                         double* joints, double* derivative) const noexcept {
  const detail::LoadedLinks links = detail::loaded_links(chain_, q, load);
  const int n = this->joints();
  for (int i = 0; i < n; ++i) {
    const Vector3 axis = links.axis(i), lever = links.about(i, load.weight), pull = lever.cross(down_);
    const bool revolute = chain_.revolute(i);
    joints[i] += compliances[i] * (revolute ? axis.dot(pull) : load.weight * axis.dot(down_));
    for (int k = 0; k < n; ++k) {
      const Vector3 turn = links.axis(k);
      double slope = 0;
      if (k < i) {
        if (!chain_.revolute(k)) continue;
        const Vector3 turned = turn.cross(axis), swept = turn.cross(lever);
        slope = revolute ? turned.dot(pull) + axis.dot(swept.cross(down_)) : load.weight * turned.dot(down_);
      } else if (revolute) {
        const Vector3 about = links.about(k, load.weight);
        Vector3 moved = load.weight * turn;
        if (chain_.revolute(k)) moved = turn.cross(about);
        slope = axis.dot(moved.cross(down_));
      }
      derivative[k * n + i] += compliances[i] * slope;
    }
  }
}

}  // namespace vernier
