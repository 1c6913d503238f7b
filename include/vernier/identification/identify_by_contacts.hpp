// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Identification of an arm's geometry without a measuring instrument: from what its tool point touches.

#include <span>
#include <vector>

#include "vernier/identification/contact_report.hpp"
#include "vernier/identification/detail/contact_identification.hpp"

namespace vernier {

/// Identifies the geometry of an arm, and the point of its tool, from joint values at which that point touches planes,
/// balls and sockets whose places are unknown. It is one least-squares problem: each object has a frame of its own
/// (3 unknowns, 5 for a bar of sockets), in which touches have known coordinates.
///
/// What contacts cannot observe stays nominal and is named: the base frame, the orientation of the tool, the scale of
/// the arm unless an object has a known length, and parameters that others absorb. Chain parameters have priors around
/// nominal, their common width chosen by the evidence (`IdentifyOptions::priors`).
/// @param nominal  the arm as designed; its tool is the start of the tool's point, which must be right to 0.2 m
/// @param contacts what is touched; touches of one object keep the same tool point
/// @param options  which parameters are estimated; of `frames` only whether the tool is among them matters
/// @param sensors  `contact_sigma`, and the loss
/// @param known    the chain as an earlier calibration has it, where the identification starts and which is its prior;
///                 null: priors are around nominal. What touches do not determine stays as it says
/// @throws std::invalid_argument on no contacts, another number of joints, an unusable option, or touches of a plane
///         along a line
/// @complexity     O(n u^2) an iteration for n touches and u unknowns
/// @cite           Hollerbach and Wampler 1996; Zhuang, Motaghedi and Roth 1999; MacKay 1992
template <NominalArm Arm>
IdentifiedByContacts<ChainOf<Arm>> identify_by_contacts(const Arm& nominal, std::span<const Contact> contacts,
                                                        const IdentifyOptions& options = {.frames = Frames::tool},
                                                        const SensorModel& sensors = {.loss = Loss::squared},
                                                        const KnownGeometry* known = nullptr) {
  const Framed<ChainOf<Arm>> arm = in_frames(nominal);
  const detail::GeometryByContacts found =
      detail::identify_geometry_by_contacts(ArmGeometry(arm), contacts, options, sensors, known);
  return {found.report, {found.arm.framed(arm.model()), arm.model()}};
}

}  // namespace vernier
