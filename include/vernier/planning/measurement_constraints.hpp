// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where an arm may be measured: joint limits, a box for the tool, the line of sight of a tracker, no self-collision.

#include <array>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "vernier/core/controller_map.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// A laser tracker or a camera, and the reflector that it sees. In the base frame of the arm [m].
struct Tracker {
  Vector3 position{0, 0, 0};             ///< of the sensor
  Vector3 reflector_direction{0, 0, 1};  ///< to which the reflector looks, in the tool frame
  double acceptance = std::numbers::pi;  ///< largest angle between that and the beam [rad]; pi: seen from all sides
  double min_range = 0;                  ///< shortest distance of the reflector [m]
  double max_range = std::numeric_limits<double>::infinity();  ///< longest [m]
  double beam_radius = 0.02;                                   ///< links keep so far from the beam [m]
};

/// A box with sides along the axes of the arm's base frame [m].
struct ToolBox {
  Vector3 lower;  ///< corner
  Vector3 upper;  ///< the opposite one
};

/// What a configuration to be measured has to obey.
struct MeasurementConstraints {
  VectorX lower{};                    ///< lower joint limits [rad, m]; empty: none
  VectorX upper{};                    ///< upper ones, likewise
  double joint_margin = 0.05;         ///< distance kept from them [rad, m]
  std::optional<ToolBox> tool_box{};  ///< where the tool may be; empty: anywhere
  std::optional<Tracker> tracker{};   ///< what has to see the reflector; empty: nothing
  /// Radii of the links [m], one a joint: link i is a capsule from the origin of frame i - 1 to that of frame i. Empty:
  /// links hide nothing and touch nothing.
  std::vector<double> link_radii{};
  /// Limits are those of this controller's joints; where it has fewer than the chain, values behind them are 0.
  ControllerMap controller{};
};

/// Why a configuration is rejected: the first constraint that it fails, in this order.
enum class Rejection { none, joint_limits, tool_box, range, acceptance, line_of_sight, self_collision };
/// Number of `Rejection`s, `none` included.
inline constexpr std::size_t num_rejections = 7;
/// Words for each, e.g. `near or beyond the joint limits`.
VERNIER_API const char* name_of(Rejection reason);

/// Numbers of configurations by what became of them.
using RejectionCounts = std::array<Index, num_rejections>;

/// The constraints of one arm.
class MeasurementScene {
 public:
  /// @param arm         as designed, with its tool
  /// @param constraints see there
  /// @throws std::invalid_argument naming the value that is not usable
  VERNIER_API MeasurementScene(const ArmGeometry& arm, MeasurementConstraints constraints);

  /// Why the joint values q [rad, m] cannot be measured; `none` where they can.
  VERNIER_API Rejection rejection(const ConstVectorRef& q) const;
  /// The controller whose joints have the limits.
  const ControllerMap& controller() const { return constraints_.controller; }

 private:
  VERNIER_API Rejection check_sight(const Vector3& tool, const Vector3& looks,
                                    const std::vector<Vector3>& points) const;
  VERNIER_API bool collides(const std::vector<Vector3>& points) const;

  ArmGeometry arm_;
  MeasurementConstraints constraints_;
};

/// Smallest distance between the points of two line segments, from a to b and from c to d [m].
/// @cite Ericson 2005 (5.1.9)
VERNIER_API double segment_distance(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/planning/measurement_constraints.ipp"
#endif
