#pragma once

/// @file
/// The one place where the version is written; the build reads it from here.

#define VERNIER_VERSION_MAJOR 0
#define VERNIER_VERSION_MINOR 1
#define VERNIER_VERSION_PATCH 0
