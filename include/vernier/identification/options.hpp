#pragma once

/// @file
/// What an identification may move, what it trusts, and what it reports.

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier {

/// Which frames around the chain are unknown.
enum class Frames { none, base, tool, base_and_tool };

/// How residuals are weighed.
enum class Loss {
  squared,  ///< least squares
  huber,    ///< linear beyond 2.8 sigma of a 3-vector, sigma estimated from the residuals (MAD)
  cauchy,   ///< logarithmic, likewise
};

/// Options of `identify`. Lengths in m, angles in rad.
struct IdentifyOptions {
  Frames frames = Frames::none;  ///< frames to identify beside the chain
  bool geometry = true;          ///< whether the chain's own parameters may move
  bool hayati = true;  ///< where consecutive axes are parallel, free beta and hold d (Hayati and Mirmirani 1985)
  std::vector<std::string> fixed{};   ///< parameters, by name, that keep their values bit for bit
  bool use_orientations = true;       ///< measured orientations count too, where there are any
  double position_sigma = 0.03e-3;    ///< of the sensor, per component [m]; only the ratio of the sigmas matters
  double orientation_sigma = 0.1e-3;  ///< of the sensor, per component [rad]
  /// How residuals are weighed.
  Loss loss = Loss::squared;
  bool priors = true;                     ///< weakly determined chain parameters get a prior of the sizes below
  double length_size = 1e-3;              ///< expected size of a length error [m]
  double angle_size = 1e-3;               ///< expected size of a twist error [rad]
  double joint_zero_size = 10e-3;         ///< expected size of a joint's zero error [rad]
  std::optional<Isometry3> base_start{};  ///< a known base (identity where not given); the start where the base is free
  std::optional<Isometry3> tool_start{};  ///< likewise for the tool
  int max_iterations = 200;               ///< of the solver

  /// Whether the base is to be identified.
  bool base_free() const { return frames == Frames::base || frames == Frames::base_and_tool; }
  /// Whether the tool is to be identified.
  bool tool_free() const { return frames == Frames::tool || frames == Frames::base_and_tool; }

  /// @throws std::invalid_argument naming the value
  void validate(const std::vector<std::string>& names) const {
    for (const auto& [name, value] : {std::pair{"position_sigma", position_sigma},
                                      {"orientation_sigma", orientation_sigma},
                                      {"length_size", length_size},
                                      {"angle_size", angle_size},
                                      {"joint_zero_size", joint_zero_size}})
      require(value > 0 && std::isfinite(value), "IdentifyOptions: ", name, " is ", value, ", must be positive");
    require(max_iterations >= 1, "IdentifyOptions: max_iterations is ", max_iterations, ", must be at least 1");
    for (const auto& name : fixed)
      require(std::find(names.begin(), names.end(), name) != names.end(), "IdentifyOptions: no parameter is called '",
              name, "'; they are called like ", names.front(), " or ", names[names.size() / 2]);
  }
};

/// Rows (from 0) whose axis is nominally parallel to the neighbouring one, where classical parameters are singular:
/// beta is to be freed and d held. A last (standard) or first (modified) row has no such neighbour.
/// @cite Hayati and Mirmirani 1985
template <int N, class Convention>
std::vector<int> parallel_rows(const DhChain<N, Convention>& chain) {
  constexpr bool standard = Convention::order.front() == DhParameter::theta;
  std::vector<int> rows;
  for (int i = standard ? 0 : 1; i < (standard ? N - 1 : N); ++i) {
    const JointType neighbour = chain.row(standard ? i + 1 : i - 1).joint;
    if (std::abs(std::sin(chain.row(i).alpha)) < 0.02 && std::abs(std::sin(chain.row(i).beta)) < 0.02 &&
        chain.row(i).joint == JointType::revolute && neighbour == JointType::revolute)
      rows.push_back(i);
  }
  return rows;
}

}  // namespace vernier
