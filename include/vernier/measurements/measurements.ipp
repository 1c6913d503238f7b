// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"
#include "vernier/measurements/bar_sensor.hpp"
#include "vernier/measurements/measurements.hpp"
#include "vernier/measurements/plane_sensor.hpp"
#include "vernier/measurements/socket_sensor.hpp"

namespace vernier::detail {

VERNIER_IMPL MeasuredSet contact_set(const Contact& contact) {
  const auto set = [&](auto sensor) {
    MeasuredSet out("contact " + contact.name(), contact.joints(), std::move(sensor));
    out.origin = contact.origin();
    return out;
  };
  if (contact.kind() == ContactKind::ball) return set(BallSensor(contact.known()));
  if (contact.kind() == ContactKind::plane) return set(PlaneSensor(contact.known()));
  if (contact.has_length()) return set(BarSensor(contact.known()));
  return set(SocketSensor(contact.size()));
}

VERNIER_IMPL std::string set_name(std::string given, const RowOrigin& origin, const char* kind, std::size_t number) {
  if (!given.empty()) return given;
  for (const std::string& file : origin.files) given += (given.empty() ? "" : ", ") + file;
  return given.empty() ? message(kind, ' ', number) : given;
}

}  // namespace vernier::detail
