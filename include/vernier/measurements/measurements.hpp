// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// All measurements of an arm as one value: poses from one place or several, distances, contacts, and sensors of a
/// user's own.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/data/contacts.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/data/ranges.hpp"
#include "vernier/measurements/detail/explain_sensor.hpp"
#include "vernier/measurements/distance_sensor.hpp"
#include "vernier/measurements/measured_set.hpp"
#include "vernier/measurements/pose_sensor.hpp"
#include "vernier/measurements/position_sensor.hpp"

namespace vernier {

template <int N>
class Measurements;

namespace detail {

/// A contact as a set.
VERNIER_API MeasuredSet contact_set(const Contact& contact);
/// A name for messages: the one that is given, else the files of the rows, else the kind with a number.
VERNIER_API std::string set_name(std::string given, const RowOrigin& origin, const char* kind, std::size_t number);

/// Number of joints of data; 0 of anything else.
template <class Data>
inline constexpr int joints_of_one = 0;
template <int M>
inline constexpr int joints_of_one<Dataset<M>> = M;
template <int M>
inline constexpr int joints_of_one<Distances<M>> = M;
template <int M>
inline constexpr int joints_of_one<Measurements<M>> = M;
/// Number of joints of data, or of a range of them; 0 of anything else.
template <class Data>
inline constexpr int joints_of = joints_of_one<Data>;
template <class Data>
  requires requires { typename Data::value_type; }
inline constexpr int joints_of<Data> = joints_of_one<typename Data::value_type>;

/// Data of an arm of another number of joints than N.
template <class Data, int N>
concept DataOfOtherJoints = (joints_of<Data> != 0 && joints_of<Data> != N);

}  // namespace detail

/// Measurements of an N-joint arm, of any kind and from any number of places:
///
///     Measurements<6> measured(poses);                       // a data set, or several: one a station
///     measured.add(wire).add(contact).add(joints, gauge);    // distances, touches, a sensor of your own
template <int N>
class Measurements {
 public:
  Measurements() = default;
  /// Poses from one station.
  Measurements(Dataset<N> poses) { add(std::move(poses)); }  // NOLINT: a data set is measurements
  /// Distances from one fixed point.
  Measurements(Distances<N> distances) { add(std::move(distances)); }  // NOLINT
  /// Poses, one set a station, or distances, one set a fixed point.
  template <class Sets>
    requires RangeOf<Sets, Dataset<N>> || RangeOf<Sets, Distances<N>> Measurements(const Sets& sets) {  // NOLINT
      for (const auto& set : sets) add(set);
    }
  /// Data of an arm with another number of joints are refused.
  template <detail::DataOfOtherJoints<N> Data>
  Measurements(const Data&) {  // NOLINT
    static_assert(detail::joints_of<Data> == N, "the data have another number of joints than the arm");
  }

  /// Poses from a further station, which has a base frame of its own.
  /// @param poses of the station
  /// @param name  how messages call it; by default its file
  /// @param place where it stands, see `MeasuredSet::place`
  /// @param reflector which one it measured, see `MeasuredSet::reflector`
  Measurements& add(Dataset<N> poses, std::string name = {}, std::string place = {}, std::string reflector = {}) {
    name = detail::set_name(std::move(name), poses.origin(), "station", poses_.size() + 1);
    MeasuredSet set =
        poses.has_orientations()
            ? MeasuredSet(std::move(name), poses.joints(), oriented(poses))
            : MeasuredSet(std::move(name), poses.joints(),
                          PositionSensor(poses.positions(), SensorModel{}.position_sigma, poses.covariances()));
    set.place = std::move(place);
    set.reflector = std::move(reflector);
    set.previous = poses.previous();
    set.times = poses.times();
    set.temperatures = poses.temperatures();
    set.payloads = poses.payloads();
    set.origin = poses.origin();
    sets_.insert(sets_.begin() + static_cast<std::ptrdiff_t>(poses_.size()), std::move(set));
    poses_.push_back(std::move(poses));
    return *this;
  }
  /// Distances from a further fixed point.
  /// @param distances from it
  /// @param name      how messages call it; by default its file
  Measurements& add(const Distances<N>& distances, std::string name = {}) {
    name = detail::set_name(std::move(name), distances.origin(), "distances", sets_.size() - poses_.size() + 1);
    sets_.push_back(MeasuredSet(std::move(name), distances.joints(), DistanceSensor(distances.lengths())));
    sets_.back().origin = distances.origin();
    return *this;
  }
  /// Touches of an object.
  /// @throws std::invalid_argument for another number of joints
  Measurements& add(const Contact& contact) {
    demand(contact.joints().cols() == N, "contact ", contact.name(), ": ", contact.joints().cols(),
           " joints, the arm has ", N);
    sets_.push_back(detail::contact_set(contact));
    return *this;
  }
  /// Touches of several objects.
  template <RangeOf<Contact> Contacts>
  Measurements& add(const Contacts& contacts) {
    for (const Contact& contact : contacts) add(contact);
    return *this;
  }
  /// Data of an arm with another number of joints are refused.
  template <detail::DataOfOtherJoints<N> Data>
  Measurements& add(const Data&, std::string = {}) {
    static_assert(detail::joints_of<Data> == N, "the data have another number of joints than the arm");
    return *this;
  }
  /// Measurements by any sensor.
  /// @tparam S     a `Sensor`
  /// @param joints n x N [rad, m]
  /// @param sensor with n measurements
  /// @param name   how messages call it; by default its kind
  /// @throws std::invalid_argument for another number of measurements
  template <class S>
  Measurements& add(const JointRows<N>& joints, S sensor, std::string name = {}) {
    if constexpr (detail::explain_sensor<S>() && Sensor<S>) {
      MeasuredSet set(std::move(name), joints, std::move(sensor));
      const auto end =
          std::find_if(sets_.begin(), sets_.end(), [](const MeasuredSet& other) { return !other.locates(); });
      sets_.insert(set.locates() ? end : sets_.end(), std::move(set));
    }
    return *this;
  }
  /// Measurements by any sensor, of as many joints as are known at run time.
  /// @throws std::invalid_argument for another number of measurements, or of joints
  template <ColumnsAtRunTime Rows, class S>
  Measurements& add(const Rows& joints, S sensor, std::string name = {}) {
    return add(detail::joint_rows<N>(joints), std::move(sensor), std::move(name));
  }
  /// Measurements between two configurations by a sensor of one length: each sees the pose at `to` in the tool frame of
  /// the pose at `from`, wherever the base stands. With a `DistanceSensor` these are distances between two positions of
  /// the tool point.
  /// @tparam S      a `Sensor`
  /// @param from,to n x N [rad, m]
  /// @param sensor  with n measurements
  /// @param name    how messages call it; by default its kind
  /// @throws std::invalid_argument for other numbers of measurements or of joints, a sensor of several values, or a
  ///         joint value that is not finite
  template <class From, class To, class S>
  Measurements& add_between(const From& from, const To& to, S sensor, std::string name = {}) {
    if constexpr (detail::explain_sensor<S>() && Sensor<S>) {
      MeasuredSet set(std::move(name), detail::fixed_rows<N>(to), std::move(sensor));
      set.seen_from = detail::fixed_rows<N>(from);
      demand(from.rows() == to.rows(), set.name, ": ", from.rows(), " first configurations and ", to.rows(), " second");
      for (Index i = 0; i < set.size(); ++i)
        demand(detail::finite_row(set.seen_from, i), set.name, ", ", set.origin.where(i),
               ": a joint value of the first configuration is not finite");
      demand(set.projected(), set.name, ": between two configurations a sensor has one value, not ", set.values());
      sets_.push_back(std::move(set));
    }
    return *this;
  }

  /// Poses, one set a station.
  const std::vector<Dataset<N>>& poses() const { return poses_; }
  /// All sets: those of `poses` first, then others that locate the base, then the rest as they were added.
  const std::vector<MeasuredSet>& sets() const { return sets_; }
  /// All sets with the accuracy that is stated for the library's sensors.
  std::vector<MeasuredSet> sets(const SensorModel& sensors) const {
    std::vector<MeasuredSet> out;
    for (const MeasuredSet& set : sets_) out.push_back(set.with(sensors));
    return out;
  }
  /// These measurements with other poses, as many sets in the same order, which keep their names.
  /// @throws std::invalid_argument for another number of sets
  Measurements with_poses(std::vector<Dataset<N>> poses) const {
    demand(poses.size() == poses_.size(), "with_poses: ", poses.size(), " sets of poses for ", poses_.size());
    Measurements out;
    for (std::size_t s = 0; s < poses.size(); ++s)
      out.add(std::move(poses[s]), sets_[s].name, sets_[s].place, sets_[s].reflector);
    out.sets_.insert(out.sets_.end(), sets_.begin() + static_cast<std::ptrdiff_t>(poses_.size()), sets_.end());
    return out;
  }
  /// Number of measurements.
  Index size() const {
    Index sum = 0;
    for (const MeasuredSet& set : sets_) sum += set.size();
    return sum;
  }

 private:
  static PoseSensor oriented(const Dataset<N>& poses) {
    std::vector<Matrix3> orientations;
    for (Index i = 0; i < poses.size(); ++i) orientations.push_back(poses.orientation(i));
    return PoseSensor(poses.positions(), std::move(orientations),
                      {SensorModel{}.position_sigma, SensorModel{}.orientation_sigma}, poses.covariances());
  }

  std::vector<Dataset<N>> poses_;
  std::vector<MeasuredSet> sets_;
};

namespace detail {

/// The poses of measurements that are nothing but poses from one station.
/// @throws std::invalid_argument otherwise
template <int N>
const Dataset<N>& only_poses(const Measurements<N>& measured, const char* caller) {
  demand(measured.sets().size() == 1 && measured.poses().size() == 1, caller, ": ", measured.sets().size(),
         " sets of measurements, it takes the poses of one station");
  return measured.poses().front();
}

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/measurements.ipp"
#endif
