// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/same_value.hpp"
#include "vernier/kinematics/convert.hpp"

namespace vernier::detail {

VERNIER_IMPL ArmGeometry to_standard(const ChainTable& modified) {
  std::vector<DhRow> rows = modified.rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const DhRow next = i + 1 < rows.size() ? rows[i + 1] : DhRow{};
    rows[i] = {next.a, next.alpha, rows[i].d, rows[i].theta, next.beta, rows[i].joint};
  }
  const DhRow& first = modified.rows().front();
  MovingFrame<double, 3> base;
  base.set_identity();
  base.rotate_x(std::cos(first.alpha), std::sin(first.alpha));
  base.move(base.x, first.a);
  if (!same_value(first.beta, 0)) base.rotate_y(std::cos(first.beta), std::sin(first.beta));
  return {ChainTable(std::move(rows), false), FrameParameters(base.isometry()), {}};
}

}  // namespace vernier::detail
