#pragma once

/// @file
/// Calibrated arms as JSON files: written whole or not at all, exact to the last bit, validated value by value when
/// read.

#include <optional>
#include <string>
#include <vector>

#include "vernier/identification/fitted_arm.hpp"
#include "vernier/io/calibrated_robot.hpp"
#include "vernier/io/detail/learned_json.hpp"
#include "vernier/io/json.hpp"

namespace vernier {

namespace detail {

/// What a model file contains, whatever the number of joints.
struct ModelData {
  std::string name;
  ChainTable nominal;
  VectorX lower, upper;
  Provenance provenance;
  FittedArm identified;
  std::optional<FittedArm> fallback;
  CoverageData coverage;  ///< where there is a fallback
  std::optional<ThermalRates> thermal;
  std::optional<LearnedData> learned;
  std::optional<ErrorModelEstimate> estimate;
};

VERNIER_API nlohmann::ordered_json model_to_json(const ModelData& model);
VERNIER_API void write_model(const std::string& path, const ModelData& model);
/// @param joints   as expected, or 0 for any number
/// @param modified the convention expected
VERNIER_API ModelData read_model(const std::string& path, int joints, bool modified);

/// A calibrated arm without its type.
template <int N, class Convention>
ModelData model_data(const CalibratedRobot<N, Convention>& robot) {
  ModelData out{robot.name(),
                ChainTable(robot.nominal().model().view()),
                robot.limits().lower,
                robot.limits().upper,
                robot.provenance(),
                FittedArm::of(robot.identified()),
                {},
                {},
                {},
                {},
                {}};
  if (robot.estimate() != nullptr) out.estimate = *robot.estimate();
  if (robot.model().thermal() != nullptr) out.thermal = *robot.model().thermal();
  if (const auto* fallback = robot.model().fallback()) {
    out.fallback = FittedArm::of(*fallback);
    out.coverage = CoverageData(*robot.model().coverage());
  }
  if (const auto* corrected = robot.learned()) {
    const CoverageData coverage(corrected->coverage());
    if (const auto* elm = corrected->learned().network())
      out.learned =
          LearnedData{FittedNetwork{elm->layer(), elm->scaling(), elm->theta(), elm->beta(), elm->offset()}, coverage};
    else if (const auto* kernels = corrected->learned().kernels())
      out.learned = LearnedData{FittedKernels{kernels->kernel(), kernels->input_map(), kernels->scaling(),
                                              kernels->centres(), kernels->alpha(), kernels->mean()},
                                coverage};
  }
  return out;
}

}  // namespace detail

/// A calibrated arm as JSON; lengths in m, angles in rad, as the keys state. Callers include <nlohmann/json.hpp>.
/// @throws std::invalid_argument on a value that is not finite
template <int N, class Convention, class Json = nlohmann::ordered_json>
Json to_json(const CalibratedRobot<N, Convention>& robot) {
  return detail::model_to_json(detail::model_data(robot));
}

/// Saves a calibrated arm, whole or not at all; `load` returns the same bits.
/// @throws std::runtime_error when the file cannot be written
/// @throws std::invalid_argument on a value that is not finite
template <int N, class Convention>
void save(const std::string& path, const CalibratedRobot<N, Convention>& robot) {
  detail::write_model(path, detail::model_data(robot));
}

/// Saves the arm of a calibration, with what was learned on top: as seen from its first station.
template <int N, class Convention>
void save(const std::string& path, const Calibration<DhChain<N, Convention>>& calibration,
          const RobotInfo<N>& info = {}) {
  save(path, calibrated_robot(calibration, info));
}

/// What a program has to know before it loads a saved arm.
struct SavedArm {
  int dof;        ///< number of joints
  bool modified;  ///< whether its chain is in Craig's convention
};

/// Reads the number of joints and the convention of a saved arm.
/// @throws DataError naming file and key
VERNIER_API SavedArm saved_arm(const std::string& path);

/// Loads a calibrated arm of N joints: `load<6>(path)`, or `load<6, ModifiedDh>(path)`.
/// @throws DataError naming file and key
template <int N, class Convention = StandardDh>
CalibratedRobot<N, Convention> load(const std::string& path) {
  using Robot = CalibratedRobot<N, Convention>;
  using Chain = typename Robot::Chain;
  const detail::ModelData data = detail::read_model(path, N, Convention::modified);
  std::array<DhRow, N> rows;
  std::copy(data.nominal.rows().begin(), data.nominal.rows().end(), rows.begin());
  const Chain nominal = Chain::from_rows(rows);
  using Model = typename Robot::Model;
  Model model = data.fallback ? Model(nominal, data.identified.typed(nominal), data.fallback->typed(nominal),
                                      data.coverage.template typed<N>())
                              : Model(nominal, data.identified.typed(nominal));
  if (data.thermal) model = model.with_thermal(*data.thermal);
  Robot robot(data.name, model, {data.lower, data.upper}, data.provenance);
  if (data.estimate) robot = robot.with_estimate(*data.estimate);
  if (!data.learned) return robot;
  const JointCoverage<N> gate = data.learned->coverage.template typed<N>();
  if (const auto* network = std::get_if<detail::FittedNetwork>(&data.learned->function))
    return robot.with_learned(ElmPredictor<N, 3>(*network), gate);
  return robot.with_learned(KernelPredictor<N, 3>(*std::get_if<detail::FittedKernels>(&data.learned->function)), gate);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/model_file.ipp"
#endif
