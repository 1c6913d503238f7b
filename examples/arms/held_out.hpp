// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Poses that are held out are visited by no row that is learned from, and how well they are predicted.

#include <algorithm>
#include <string>
#include <vector>

#include "data_instances.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/data/same_pose.hpp"
#include "vernier/data/split.hpp"

namespace support {

/// Takes training rows away that visit a held-out pose, of any station.
/// @param stations training and held-out rows, one split a station
/// @param names    of the stations, for messages
/// @param advice   appended to the message
/// @param same     within which joint values rows are one pose
/// @return         how many rows were taken away
/// @throws vernier::CalibrationFailure where nothing is left to learn from
template <int N>
vernier::Index keep_poses_apart(std::vector<vernier::Split<N>>& stations, const std::vector<std::string>& names,
                                const std::string& advice, const vernier::SamePose& same) {
  namespace vn = vernier;
  vn::Index tests = 0, trains = 0, out = 0;
  for (const auto& station : stations) {
    tests += station.test.size();
    trains += station.train.size();
  }
  vn::JointRows<N> joints(tests + trains, N);
  vn::Index at = 0;
  const auto append = [&](const vn::Dataset<N>& data) {
    joints.middleRows(at, data.size()) = data.joints();
    at += data.size();
  };
  for (const auto& station : stations) append(station.test);
  for (const auto& station : stations) append(station.train);
  const std::vector<vn::Index> poses = vn::pose_numbers(joints, same);
  const vn::Index held_out = *std::max_element(poses.begin(), poses.begin() + tests) + 1;
  auto pose = poses.begin() + tests;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    std::vector<vn::Index> kept;
    for (vn::Index i = 0; i < stations[s].train.size(); ++i)
      if (*pose++ >= held_out) kept.push_back(i);
    out += stations[s].train.size() - static_cast<vn::Index>(kept.size());
    if (kept.empty())
      throw vn::CalibrationFailure(names[s] + ": every pose is also a held-out one, so nothing can be learned from it" +
                                   advice);
    if (static_cast<vn::Index>(kept.size()) < stations[s].train.size())
      stations[s].train = stations[s].train.rows(kept);
  }
  return out;
}

/// Errors of held-out rows. The rows that were learned from are visits, means of the readings of a pose, and so are
/// those that the 95 % ellipsoids are to hold.
template <class Chain>
vernier::CalibrationReport evaluate_visits(const vernier::Calibration<Chain>& calibration,
                                           const vernier::Measurements<Chain::dof>& held_out,
                                           const vernier::JointLimits<Chain::dof>& limits,
                                           const vernier::ControllerMap& controller) {
  namespace vn = vernier;
  vn::CalibrationReport out = vn::evaluate(calibration, held_out, limits, controller);
  const auto types = calibration.errors.model().nominal().model().joint_types();
  vn::Measurements<Chain::dof> visits;
  for (std::size_t s = 0; s < held_out.poses().size(); ++s)
    visits.add(vn::readings_joined(held_out.poses()[s], {.joint_types = types}), held_out.sets()[s].name);
  if (visits.size() < held_out.size())
    out.ellipsoid_coverage = vn::evaluate(calibration, visits, limits, controller).ellipsoid_coverage;
  return out;
}

}  // namespace support
