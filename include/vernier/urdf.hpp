// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Arms from and to URDF files, and the kinematics files of Universal Robots: needs tinyxml2 and yaml-cpp beside what
/// vernier/io.hpp needs.

#include "vernier/urdf/export_urdf.hpp"
#include "vernier/urdf/ur_kinematics.hpp"
#include "vernier/urdf/urdf_text.hpp"
