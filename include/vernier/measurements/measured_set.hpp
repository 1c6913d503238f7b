// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measurements by one sensor from one place, whatever the sensor: joint values, circumstances, and the sensor itself
/// behind one function. Least squares, registration and reports know nothing else of a sensor.

#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/data/row_origin.hpp"
#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// n measurements of an arm whose number of joints is known at run time.
class MeasuredSet {
 public:
  /// @param set_name how messages name it; empty: by the sensor's kind
  /// @param at       n x joints [rad, m]
  /// @param by       the sensor, with as many measurements
  /// @throws std::invalid_argument for another number of measurements, or a joint value that is not finite
  template <Sensor S>
  MeasuredSet(std::string set_name, MatrixX at, S by)
      : name(std::move(set_name)),
        joints(std::move(at)),
        kind_(by.kind()),
        values_(by.values()),
        sigma_(by.sigma()),
        unknown_frame_(by.unknown_frame()),
        plausibility_(by.plausibility()),
        size_(by.size()) {
    const auto kept = std::make_shared<const S>(std::move(by));
    if constexpr (requires { kept->positions(); }) positions_ = &kept->positions();
    if constexpr (requires { kept->orientations(); }) orientations_ = &kept->orientations();
    if constexpr (requires { kept->covariances(); }) covariances_ = &kept->covariances();
    sensor_ = kept;
    functions_ = &functions_of<S>;
    if (name.empty()) name = kind_;
    validate();
  }

  std::string name;  ///< how messages name it
  /// Where the sensor stands: sets that locate the base from one place have one base frame. Empty: a place of its own.
  std::string place{};
  std::string reflector{};  ///< which reflector was measured: each has a tool of its own. Empty: the tool point
  MatrixX joints;           ///< n x joints [rad, m]
  MatrixX previous{};       ///< joint values from which each was approached; no rows, or not finite, where unknown
  /// Joint values of the pose in whose tool frame each pose is seen: measurements between two configurations. No rows:
  /// poses are seen in the sensor's frame.
  MatrixX seen_from{};
  VectorX times{};         ///< n, when each was measured; or none
  VectorX temperatures{};  ///< n [deg C]; or none
  MatrixX payloads{};      ///< n x 4, see `Dataset::payloads`; or no rows
  RowOrigin origin{};      ///< where the rows stand in files

  /// Number of measurements.
  Index size() const { return joints.rows(); }
  /// Measured values of each: 1, 3 or 6, see `Sensor`.
  Index values() const { return values_; }
  /// Whether each is one length.
  bool projected() const { return values_ == 1; }
  /// Whether angles are measured.
  bool oriented() const { return values_ == 6; }
  /// Name of the sensor's kind.
  const std::string& kind() const { return kind_; }
  /// Standard deviations of the values.
  const SensorSigma& sigma() const { return sigma_; }
  /// Which parameters of the base frame are unknown, see `Sensor`.
  const std::array<bool, 6>& unknown_frame() const { return unknown_frame_; }
  /// Whether the sensor sees where the arm's base stands: models are validated on such sets, and their base may drift.
  VERNIER_API bool locates() const;
  /// Measured positions [m], n x 3, or null.
  const PointRows* positions() const { return positions_; }
  /// Measured position i; only where there are some.
  Vector3 position(Index i) const { return point(*positions_, i); }
  /// Measured orientations, n; only where `oriented()`, of a sensor that measures them directly.
  const std::vector<Matrix3>& orientations() const { return *orientations_; }
  /// Covariances of the rows of each measurement [m, rad], n; or none, where those of `sigma()` hold.
  bool correlated() const { return covariances_ != nullptr && !covariances_->empty(); }
  /// Covariance of a measurement in multiples of `sigma()`; only where `correlated()`.
  VERNIER_API Matrix6 relative_covariance(Index i) const;
  /// Bounds beyond which these measurements are not of the arm.
  const Plausibility& plausibility() const { return plausibility_; }

  /// Poses as the sensor sees them: those of `joints`, in the tool frames of `seen_from` where there are some.
  /// @param poses_of base_T_tool at n configurations
  VERNIER_API std::vector<Isometry3> seen_poses(
      FunctionRef<std::vector<Isometry3>(const MatrixX& joints)> poses_of) const;
  /// Measurement i at a pose of the tool point as the sensor sees it.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// Base frame that fits poses in the arm's own base frame. Where the sensor leaves rotations open and would stand
  /// upside down, it turns the set's frame by half a turn: rotation vectors are singular there.
  VERNIER_API Isometry3 register_base(std::span<const Isometry3> poses);
  /// The z axis of the sensor's frame in the set's frame.
  Vector3 axis() const { return {turned_(0, 2), turned_(1, 2), turned_(2, 2)}; }
  /// With the accuracy that a user states for its kind.
  /// @throws std::invalid_argument for an unusable one
  VERNIER_API MeasuredSet with(const SensorModel& sensors) const;
  /// This sensor at other joint values, its readings in turn: for derivatives alone.
  VERNIER_API MeasuredSet at_joints(MatrixX other) const;

 private:
  struct Functions {
    void (*sense)(const void* sensor, Index i, const Isometry3& pose, SensedRows& rows);
    Isometry3 (*base_from)(const void* sensor, std::span<const Isometry3> poses);
    MeasuredSet (*with)(const MeasuredSet& set, const SensorModel& sensors);
  };

  template <Sensor S>
  static MeasuredSet with_model(const MeasuredSet& set, const SensorModel& sensors) {
    if constexpr (requires(const S& sensor) {
                    { sensor.with(sensors) } -> std::same_as<S>;
                  }) {
      MeasuredSet out(set.name, set.joints, static_cast<const S*>(set.sensor_.get())->with(sensors));
      out.place = set.place;
      out.reflector = set.reflector;
      out.previous = set.previous;
      out.seen_from = set.seen_from;
      out.times = set.times;
      out.temperatures = set.temperatures;
      out.payloads = set.payloads;
      out.origin = set.origin;
      return out;
    }
    return set;
  }

  template <Sensor S>
  static constexpr Functions functions_of{[](const void* sensor, Index i, const Isometry3& pose, SensedRows& rows) {
                                            static_cast<const S*>(sensor)->sense(i, pose, rows);
                                          },
                                          [](const void* sensor, std::span<const Isometry3> poses) {
                                            return static_cast<const S*>(sensor)->base_from(poses);
                                          },
                                          &with_model<S>};

  VERNIER_API void validate() const;

  std::string kind_;
  Index values_;
  SensorSigma sigma_;
  std::array<bool, 6> unknown_frame_;
  Plausibility plausibility_;
  Index size_;  // of the sensor
  std::shared_ptr<const void> sensor_{};
  const Functions* functions_ = nullptr;
  const PointRows* positions_ = nullptr;
  const std::vector<Matrix3>* orientations_ = nullptr;
  const std::vector<Matrix6>* covariances_ = nullptr;
  Matrix3 turned_ = Matrix3::Identity();  // half a turn, or none: takes the sensor's frame to the set's
};

namespace detail {

/// The first set whose base frame a set has: of the same place.
VERNIER_API std::size_t first_of_place(std::span<const MeasuredSet> sets, std::size_t set);
/// The first set whose tool a set has: of the same point, or itself where each has its own.
VERNIER_API std::size_t first_of_point(std::span<const MeasuredSet> sets, std::size_t set, bool own_tools);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/measured_set.ipp"
#endif
