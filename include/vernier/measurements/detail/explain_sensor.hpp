// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a type lacks to be a `Sensor`, in one sentence for each requirement.

#include "vernier/measurements/sensor.hpp"

namespace vernier::detail {

/// Does not compile for a type that is no `Sensor`: each failed assertion names one requirement. The last one is for
/// requirements that have no sentence.
template <class S>
constexpr bool explain_sensor() {
  if constexpr (!Sensor<S>) {
    static_assert(std::copy_constructible<S>, "Sensor: the sensor must be copyable");
    static_assert(
        requires(const S& sensor) {
          { sensor.kind() } -> std::convertible_to<std::string>;
        },
        "Sensor: `kind()` must be const and return its name in messages and reports");
    static_assert(
        requires(const S& sensor) {
          { sensor.size() } -> std::convertible_to<Index>;
        },
        "Sensor: `size()` must be const and return the number of measurements");
    static_assert(
        requires(const S& sensor) {
          { sensor.values() } -> std::convertible_to<Index>;
        },
        "Sensor: `values()` must be const and return the number of values of a measurement: 1, 3 or 6");
    static_assert(
        requires(const S& sensor) {
          { sensor.sigma() } -> std::same_as<SensorSigma>;
        },
        "Sensor: `sigma()` must be const and return vernier::SensorSigma");
    static_assert(
        requires(const S& sensor, Index i, const Isometry3& pose, SensedRows& rows) { sensor.sense(i, pose, rows); },
        "Sensor: `sense(i, pose, rows)` must be const and take vernier::Index, vernier::Isometry3 and "
        "vernier::SensedRows&");
    static_assert(
        requires(const S& sensor) {
          { sensor.unknown_frame() } -> std::same_as<std::array<bool, 6>>;
        },
        "Sensor: `unknown_frame()` must be const and return std::array<bool, 6>");
    static_assert(
        requires(const S& sensor, std::span<const Isometry3> poses) {
          { sensor.base_from(poses) } -> std::same_as<Isometry3>;
        },
        "Sensor: `base_from(poses)` must be const, take std::span<const vernier::Isometry3> and return "
        "vernier::Isometry3");
    static_assert(
        requires(const S& sensor) {
          { sensor.plausibility() } -> std::same_as<Plausibility>;
        },
        "Sensor: `plausibility()` must be const and return vernier::Plausibility");
    static_assert(Sensor<S>, "Sensor: the type does not satisfy the concept");
  }
  return true;
}

}  // namespace vernier::detail
