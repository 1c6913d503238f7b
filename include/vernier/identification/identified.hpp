// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An identified arm, and how well it is known.

#include "vernier/identification/calibrated.hpp"
#include "vernier/identification/identification_report.hpp"

namespace vernier {

/// An identified arm with its report.
template <KinematicModel Model>
struct Identified : IdentificationReport {
  Calibrated<Model> model;  ///< usable as any kinematic model

  /// Joins the two.
  Identified(IdentificationReport report, const Calibrated<Model>& arm)
      : IdentificationReport(std::move(report)), model(arm) {}
};

}  // namespace vernier
