#pragma once

/// @file
/// Reading measured poses of an arm: joint columns must be angles for revolute joints and lengths for prismatic ones.

#include <filesystem>

#include "vernier/data/csv.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace support {

/// @throws vernier::DataError naming the column whose unit does not fit the joint
template <int N>
void require_joint_units(const std::filesystem::path& path, const vernier::DhChain<N>& chain) {
  const vernier::detail::CsvTable table(path);
  for (int i = 0; i < N; ++i) {
    const bool prismatic = chain.row(i).joint == vernier::JointType::prismatic;
    const std::string stem = vernier::message("q", i + 1);
    if (const auto wrong = table.find(stem, !prismatic))
      throw vernier::DataError(vernier::message(path.string(), ", line 1: column ", wrong->name, ", but joint ", i + 1,
                                                prismatic ? " is prismatic: a length" : " is revolute: an angle",
                                                " is needed"));
  }
}

/// Measured poses, their columns checked against the arm.
/// @throws vernier::DataError on a malformed file
template <int N>
vernier::Dataset<N> read_poses(const std::filesystem::path& path, const vernier::DhChain<N>& chain,
                               bool positions_only) {
  vernier::Dataset<N> data = vernier::read_dataset<N>(path);
  require_joint_units(path, chain);
  return positions_only ? vernier::Dataset<N>(data.joints(), data.positions()) : data;
}

}  // namespace support
