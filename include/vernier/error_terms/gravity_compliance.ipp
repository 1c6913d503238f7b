// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/error_terms/gravity_compliance.hpp"

namespace vernier {

namespace detail {

/// Axes, points on them and link origins of a chain at a configuration; a column a joint.
struct LinkVectors {
  double axes[3 * max_joints], points[3 * max_joints], origins[3 * max_joints];

  Vector3 axis(int i) const { return column(axes, i); }
  Vector3 point(int i) const { return column(points, i); }
  Vector3 origin(int i) const { return column(origins, i); }
  static Vector3 column(const double* of, int i) { return {of[3 * i], of[3 * i + 1], of[3 * i + 2]}; }
};

}  // namespace detail

VERNIER_IMPL GravityCompliance::GravityCompliance(const detail::ChainTable& chain, const Vector3& down)
    : chain_(chain), down_(down) {
  demand(std::abs(down.norm() - 1) < 1e-6, "GravityCompliance: the direction of gravity has length ", down.norm(),
         ", must be 1");
}

VERNIER_IMPL void GravityCompliance::basis(const double* q, MatrixRef out) const noexcept {
  detail::LinkVectors links;
  detail::chain_links(chain_.view(), q, links.axes, links.points, links.origins);
  const int n = joints();
  out.setZero();
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) {
      const Vector3 arm = links.origin(j) - links.point(i);
      out(i, index(i, j)) = links.axis(i).dot(chain_.revolute(i) ? arm.cross(down_) : down_);
    }
}

VERNIER_IMPL void GravityCompliance::add(const double* q, const double* products, double* joints,
                                         double* derivative) const noexcept {
  detail::LinkVectors links;
  detail::chain_links(chain_.view(), q, links.axes, links.points, links.origins);
  const int n = this->joints();
  const auto slope = [&](int i, int k) -> double& { return derivative[k * n + i]; };
  for (int i = 0; i < n; ++i) {
    const Vector3 axis = links.axis(i);
    // moment(k): weights of the links from k on, about a point on axis k
    const auto moment = [&](int k) {
      Vector3 sum = Vector3::Zero();
      for (int j = (std::max)(i, k); j < n; ++j) {
        const Vector3 arm = links.origin(j) - links.point(k);
        sum += products[index(i, j)] * arm;
      }
      return sum;
    };
    const bool revolute = chain_.revolute(i);
    double weight = 0;
    for (int j = i; j < n; ++j) weight += products[index(i, j)];
    const Vector3 lever = moment(i);
    joints[i] += revolute ? axis.dot(lever.cross(down_)) : weight * axis.dot(down_);
    for (int k = 0; k < n; ++k) {
      const Vector3 turn = links.axis(k);
      if (k < i) {
        if (!chain_.revolute(k)) continue;
        const Vector3 turned = turn.cross(axis);
        slope(i, k) += revolute ? turned.dot(lever.cross(down_)) + axis.dot(turn.cross(lever).cross(down_))
                                : weight * turned.dot(down_);
      } else if (revolute) {
        double outboard = 0;  // weight of the links from k on
        for (int j = k; j < n; ++j) outboard += products[index(i, j)];
        const Vector3 moved = chain_.revolute(k) ? Vector3(turn.cross(moment(k))) : Vector3(outboard * turn);
        slope(i, k) += axis.dot(moved.cross(down_));
      }
    }
  }
}

}  // namespace vernier
