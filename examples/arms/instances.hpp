// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What takes longest to compile, for arms of all numbers of joints: declared here, and compiled once, in the library
/// `vernier_instances`, which programs and the Python module share.

#include "dispatch.hpp"
#include "instance_list.hpp"

namespace vernier {

#define VERNIER_DECLARE(N) VERNIER_INSTANCES(extern template, N)
VERNIER_FOR_ALL_DOF(VERNIER_DECLARE)
#undef VERNIER_DECLARE

}  // namespace vernier
