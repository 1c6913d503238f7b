#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/station.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<Matrix3> rotations(const PointRows& rotation_vectors) {
  std::vector<Matrix3> out;
  out.reserve(static_cast<std::size_t>(rotation_vectors.rows()));
  for (Index i = 0; i < rotation_vectors.rows(); ++i) out.push_back(exp_so3(point(rotation_vectors, i)));
  return out;
}

VERNIER_IMPL Station station_of(const Contact& contact, const SensorModel& sensors) {
  Station out{.joint_values = contact.joints().data(),
              .samples = contact.size(),
              .dof = static_cast<int>(contact.joints().cols()),
              .position_sigma = sensors.contact_sigma,
              .joint_sigma = sensors.joint_sigma};
  (contact.kind() == ContactKind::ball ? out.lengths : out.heights) = &contact.known();
  out.on_axis = contact.kind() == ContactKind::socket;
  return out;
}

}  // namespace vernier::detail
