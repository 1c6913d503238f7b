// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Measurements of one kind as the set that least squares sees.

#include "vernier/measurements/measurements.hpp"

namespace vernier_test {

template <int N>
vernier::MeasuredSet set_of(const vernier::Dataset<N>& data, const vernier::SensorModel& sensors = {}) {
  return vernier::Measurements<N>(data).sets(sensors).front();
}

template <int N>
vernier::MeasuredSet set_of(const vernier::Distances<N>& data, const vernier::SensorModel& sensors = {}) {
  return vernier::Measurements<N>(data).sets(sensors).front();
}

inline vernier::MeasuredSet set_of(const vernier::Contact& contact, const vernier::SensorModel& sensors = {}) {
  return vernier::detail::contact_set(contact).with(sensors);
}

}  // namespace vernier_test
