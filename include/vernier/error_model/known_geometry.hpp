// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An earlier calibration as the prior of an identification from contacts, which know nothing of joint errors: those of
/// the earlier one are held.

#include <span>
#include <vector>

#include "vernier/data/contacts.hpp"
#include "vernier/error_model/arm_prior.hpp"
#include "vernier/identification/known_geometry.hpp"

namespace vernier {

/// The chain of an earlier calibration with its covariance.
/// @param prior   the earlier calibration
/// @param nominal the arm as designed
/// @throws std::invalid_argument for an arm of another number of joints or convention
VERNIER_API KnownGeometry known_geometry(const ArmPrior& prior, const ArmGeometry& nominal);

/// Touches at the joint values that joint errors make of those that were commanded: an identification from them holds
/// these errors. How each touch was approached is not known, so hysteresis is in its middle.
/// @throws std::invalid_argument for errors that are not of joint values: tilts, bending links, straightness
VERNIER_API std::vector<Contact> at_effective_joints(std::span<const Contact> contacts, const JointErrors& errors);

/// What was identified from contacts beside joint errors that were held: unknowns of both with their covariance. That
/// between both is not known and left out.
/// @param geometry of the identification, see `geometry_estimate`
/// @param earlier  whose joint errors were held
VERNIER_API ErrorModelEstimate with_joint_errors_of(const ErrorModelEstimate& geometry,
                                                    const ErrorModelEstimate& earlier);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/known_geometry.ipp"
#endif
