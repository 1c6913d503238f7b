// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibrated geometry written into a URDF file.

#include <string>

#include "vernier/urdf/export_note.hpp"
#include "vernier/urdf/urdf_chain.hpp"

namespace vernier {

/// The file of a chain with another geometry: the origins of the chain's joints are replaced (see `joint_origins`), and
/// a comment with the note is put in; every other byte stays, and so do origins that do not change. Joint zeros become
/// part of the origins, as nobody applies `<calibration>`. Numbers read back exactly.
/// @param chain    as read
/// @param geometry of the same joints, e.g. that of `identify`: where a calibration also has gears, compliance or
///                 functions of joints, not the geometry that was fitted together with them, which is worse alone;
///                 between the chain's own frames where base and tool are to stay
/// @param note     written as a comment
/// @throws std::invalid_argument as `joint_origins`
VERNIER_API std::string export_urdf(const UrdfChain& chain, const ArmGeometry& geometry, const ExportNote& note);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/export_urdf.ipp"
#endif
