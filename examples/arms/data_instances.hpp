// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rows of a file, and readings of a pose, for all numbers of joints: declared here, and compiled once, in the library
/// `vernier_instances`.

#include "dispatch.hpp"
#include "vernier/data/reflectors.hpp"
#include "vernier/data/same_pose.hpp"

/// These functions, as instances that are declared (`extern template`) or defined (`template`).
#define VERNIER_DATA_INSTANCES(keyword, N)                                                                       \
  keyword Dataset<N> detail::dataset_of<N>(const detail::PoseColumns&);                                          \
  keyword Dataset<N> readings_joined<N>(const Dataset<N>&, const SamePose&);                                     \
  keyword std::vector<ReflectorPoses<N>> split_reflectors<N>(const Dataset<N>&, const std::vector<std::string>&, \
                                                             const SamePose&);

namespace vernier {

#define VERNIER_DECLARE(N) VERNIER_DATA_INSTANCES(extern template, N)
VERNIER_FOR_ALL_DOF(VERNIER_DECLARE)
#undef VERNIER_DECLARE

}  // namespace vernier
