#pragma once

/// @file
/// Measurements from one place, whatever the number of joints.

#include <vector>

#include "vernier/data/contacts.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/identification/sensor_model.hpp"

namespace vernier::detail {

/// What was measured from one place, poses or distances, or touched, and how well. Refers to the measurements.
struct Station {
  const double* joint_values;               ///< n x dof, by columns
  Index samples;                            ///< n
  int dof;                                  ///< number of joints
  const double* previous_values = nullptr;  ///< n x dof, by columns: from where it was approached; null for unknown
  const VectorX* times = nullptr;           ///< n, when it was measured; or null
  const VectorX* temperatures = nullptr;    ///< n [deg C]; or null
  const PointRows* positions = nullptr;     ///< n, or null where none were measured
  const VectorX* lengths = nullptr;         ///< n distances from the origin of the station's frame, or null
  const VectorX* heights = nullptr;         ///< n heights above the plane z = 0 of that frame, or null
  double height_sign = 1;                   ///< of heights: -1 where they count down
  bool on_axis = false;                     ///< heights are those of points on the z axis: x = y = 0, too
  std::vector<Matrix3> orientations{};      ///< n, or empty where they are not used
  double position_sigma = 1;                ///< of a position, per component, of a distance or a height [m]
  double orientation_sigma = 1;             ///< [rad]
  double joint_sigma = 0;                   ///< of the joint readings [rad, m]; 0: exact

  /// Number of samples.
  Index size() const { return samples; }
  /// Joint values [rad, m], n x dof.
  Eigen::Map<const MatrixX> joints() const { return {joint_values, samples, dof}; }
  /// Joint values from which samples were approached [rad, m], n x dof; no rows where unknown.
  Eigen::Map<const MatrixX> previous() const { return {previous_values, previous_values ? samples : 0, dof}; }
  bool oriented() const { return !orientations.empty(); }
  /// Whether a sample is one number: the position's component along some direction.
  bool projected() const { return lengths != nullptr || (heights != nullptr && !on_axis); }
  /// Measured values of a sample.
  Index values() const { return projected() ? 1 : oriented() ? 6 : 3; }
  double height(Index i) const { return height_sign * (*heights)(i); }
  Vector3 position(Index i) const { return positions != nullptr ? point(*positions, i) : Vector3(0, 0, height(i)); }
};

/// Rotation matrices of rotation vectors.
VERNIER_API std::vector<Matrix3> rotations(const PointRows& rotation_vectors);

/// Measured poses as a station.
template <int N>
Station station_of(const Dataset<N>& data, const SensorModel& sensors) {
  Station out{.joint_values = data.joints().data(),
              .samples = data.size(),
              .dof = N,
              .previous_values = data.previous().data(),
              .times = &data.times(),
              .temperatures = data.temperatures().size() > 0 ? &data.temperatures() : nullptr,
              .positions = &data.positions(),
              .position_sigma = sensors.position_sigma,
              .orientation_sigma = sensors.orientation_sigma,
              .joint_sigma = sensors.joint_sigma};
  if (sensors.use_orientations && data.has_orientations()) out.orientations = rotations(data.orientations());
  return out;
}

/// Measured distances as a station whose base frame has the fixed point as its origin.
template <int N>
Station station_of(const Distances<N>& data, const SensorModel& sensors) {
  return {.joint_values = data.joints().data(),
          .samples = data.size(),
          .dof = N,
          .lengths = &data.lengths(),
          .position_sigma = sensors.distance_sigma,
          .joint_sigma = sensors.joint_sigma};
}

/// Touches as a station whose frame is that of the object: the plane z = 0, the centre of a ball, a socket, the axis z
/// of a bar. Refers to the contact.
VERNIER_API Station station_of(const Contact& contact, const SensorModel& sensors);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/station.ipp"
#endif
