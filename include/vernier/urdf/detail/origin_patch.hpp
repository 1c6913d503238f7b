// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// New origins in the text of a URDF file, every other byte kept.

#include <string>
#include <utility>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// A number in digits that read back exactly, with a point wherever it has an exponent (YAML 1.1 needs one).
VERNIER_API std::string exact_number(double value);

/// The text with new origins of some joints and a comment in front of everything else inside of the robot. Attributes
/// are replaced where they are; missing ones, and missing origins, are put in.
/// @param text    of a file that `read_urdf_document` accepts
/// @param origins names of joints and their origins
/// @param comment lines; "--", which XML forbids there, is taken apart
VERNIER_API std::string with_origins(const std::string& text,
                                     const std::vector<std::pair<std::string, Isometry3>>& origins,
                                     const std::vector<std::string>& comment);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/detail/origin_patch.ipp"
#endif
