// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibrated arms as JSON files: written whole or not at all, exact to the last bit, validated value by value when
/// read.

#include <string>
#include <utility>

#include "vernier/io/detail/model_data.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/json.hpp"

namespace vernier {

namespace detail {
struct SavedModelParts;
}  // namespace detail

/// A calibrated arm as JSON; lengths in m, angles in rad, as the keys state. Callers include <nlohmann/json.hpp>.
/// @throws std::invalid_argument on a value that is not finite
template <int N, class Convention, class Json = nlohmann::ordered_json>
Json to_json(const CalibratedRobot<N, Convention>& robot) {
  return detail::model_to_json(detail::model_data(robot));
}

/// Saves a calibrated arm, whole or not at all; `load` returns the same bits.
/// @return SHA-256 of the bytes that were written, in hexadecimal
/// @throws std::runtime_error when the file cannot be written
/// @throws std::invalid_argument on a value that is not finite
template <int N, class Convention>
std::string save(const std::string& path, const CalibratedRobot<N, Convention>& robot) {
  return detail::write_model(path, detail::model_data(robot));
}

/// Saves the arm of a calibration, with what was learned on top, as seen from one of its stations.
/// @param path of the file
/// @param calibration as `calibrate` returns it
/// @param info name, limits and provenance
/// @param station from 0
/// @return and throws as for an arm
template <int N, class Convention>
std::string save(const std::string& path, const Calibration<DhChain<N, Convention>>& calibration,
                 const RobotInfo<N>& info = {}, std::size_t station = 0) {
  return save(path, calibrated_robot(calibration, info, station));
}

/// A model file that was read and checked, of an arm of any number of joints.
class SavedModel {
 public:
  /// Number of joints.
  int dof() const { return data_.nominal.joints(); }
  /// Whether the chain is in Craig's convention.
  bool modified() const { return data_.nominal.modified(); }
  /// Name of the arm.
  const std::string& name() const { return data_.name; }
  /// Where the calibration comes from.
  const Provenance& provenance() const { return data_.provenance; }
  /// The file, as it was named.
  const std::string& file() const { return file_; }
  /// SHA-256 of the bytes that were read, in hexadecimal.
  const std::string& hash() const { return hash_; }

  /// Whether its measurements state what the arm carried.
  bool states_payload() const { return data_.identified.errors.terms().payload.has_value(); }
  /// This model under a payload, see `ErrorModel::carrying`.
  VERNIER_API SavedModel carrying(const Payload& payload) const;

  /// The calibrated arm of N joints: `as<6>()`, or `as<6, ModifiedDh>()`.
  /// @throws DataError naming the file, for another number of joints or the other convention
  template <int N, class Convention = StandardDh>
  CalibratedRobot<N, Convention> as() const {
    detail::require_chain(data_, file_, N, Convention::modified);
    return detail::robot_of<N, Convention>(data_);
  }

 private:
  friend struct detail::SavedModelParts;
  SavedModel(std::string file, std::string hash, detail::ModelData data)
      : file_(std::move(file)), hash_(std::move(hash)), data_(std::move(data)) {}

  std::string file_, hash_;
  detail::ModelData data_;
};

/// Reads a model file once, from a pipe as well.
/// @throws DataError naming file and key
VERNIER_API SavedModel read_model(const std::string& path);

/// Loads a calibrated arm of N joints, `read_model(path).as<N>()`: `load<6>(path)`, or `load<6, ModifiedDh>(path)`.
/// @throws DataError naming file and key
template <int N, class Convention = StandardDh>
CalibratedRobot<N, Convention> load(const std::string& path) {
  return read_model(path).as<N, Convention>();
}

namespace detail {

/// The inside of a saved model, for the functions of this folder.
struct SavedModelParts {
  /// A model of its parts.
  static SavedModel make(std::string file, std::string hash, ModelData data) {
    return {std::move(file), std::move(hash), std::move(data)};
  }
  /// The content of a model.
  static const ModelData& data(const SavedModel& model) { return model.data_; }
};

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/model_file.ipp"
#endif
