// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/simulation/touches.hpp"

#include "vernier/core/detail/dense.hpp"

namespace vernier::detail {

VERNIER_IMPL TouchStep step_towards(const VirtualObject& object, const Vector3& point, double known,
                                    const ConstMatrixRef& jacobian) {
  const Vector3 from = point - object.point, end = known * object.direction;
  const Vector3 along = object.kind == ContactKind::plane ? object.direction : Vector3(from.normalized());
  VectorX residual = from - end;
  MatrixX rows = jacobian.topRows(3);
  if (object.kind != ContactKind::socket) {  // the component along a direction alone
    residual.setConstant(1, along.dot(from) - known);
    rows = matrix_product(along.transpose(), rows);
  }
  const double left = residual.norm(), least = 1e-9 * rows.squaredNorm();
  MatrixX gram = matrix_product(rows, rows.transpose());
  for (Index k = 0; k < gram.cols(); ++k) gram(k, k) += least;
  solve_general(gram, residual);
  return {transposed_product(rows, residual), left};
}

}  // namespace vernier::detail
