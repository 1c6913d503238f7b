// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The steps of an identification from contacts, whatever the number of joints.

#include <span>

#include "vernier/identification/contact_report.hpp"
#include "vernier/identification/known_geometry.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier::detail {

/// A geometry identified from contacts, and its report.
struct GeometryByContacts {
  ArmGeometry arm;
  ContactReport report;
};

/// `vernier::identify_by_contacts` for an arm whose number of joints is known at run time.
VERNIER_API GeometryByContacts identify_geometry_by_contacts(const ArmGeometry& nominal,
                                                             std::span<const Contact> contacts,
                                                             const IdentifyOptions& options, const SensorModel& sensors,
                                                             const KnownGeometry* known = nullptr);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/contact_identification.ipp"
#endif
