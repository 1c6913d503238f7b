#pragma once

#include "vernier/simulation/touches.hpp"

namespace vernier::detail {

VERNIER_IMPL std::pair<VectorX, MatrixX> distance_from(const VirtualObject& object, const Vector3& point,
                                                       double known) {
  const Vector3 from = point - object.point;
  if (object.kind == ContactKind::socket) return {from - known * object.direction, Matrix3::Identity()};
  const bool plane = object.kind == ContactKind::plane;
  const Vector3 along = plane ? object.direction : Vector3(from.normalized());
  return {VectorX::Constant(1, along.dot(from) - known), MatrixX(along.transpose())};
}

}  // namespace vernier::detail
