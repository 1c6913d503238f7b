// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The one place where the version is written; the build reads it from here.

/// Changes with every incompatible release.
#define VERNIER_VERSION_MAJOR 0
/// Changes with every release that adds.
#define VERNIER_VERSION_MINOR 2
/// Changes with every release that only mends.
#define VERNIER_VERSION_PATCH 0
