// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The arm of a model file, for all numbers of joints: declared here, and compiled once, in the library
/// `vernier_instances`.

#include "dispatch.hpp"
#include "vernier/io/model_file.hpp"

/// That function, as an instance that is declared (`extern template`) or defined (`template`).
#define VERNIER_MODEL_INSTANCES(keyword, N) \
  keyword CalibratedRobot<N> detail::robot_of<N, StandardDh>(const detail::ModelData&);

namespace vernier {

#define VERNIER_DECLARE(N) VERNIER_MODEL_INSTANCES(extern template, N)
VERNIER_FOR_ALL_DOF(VERNIER_DECLARE)
#undef VERNIER_DECLARE

}  // namespace vernier
