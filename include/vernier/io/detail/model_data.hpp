// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The content of a model file, whatever the number of joints: from and to JSON, from and to a calibrated arm.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>

#include "vernier/identification/fitted_arm.hpp"
#include "vernier/io/calibrated_robot.hpp"
#include "vernier/io/detail/learned_json.hpp"
#include "vernier/io/json.hpp"

namespace vernier::detail {

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
  ControllerMap controller{};  ///< `lower` and `upper` are of its joints, 0 behind them
};

VERNIER_API nlohmann::ordered_json model_to_json(const ModelData& model);
/// Writes a model file.
/// @return SHA-256 of its bytes
VERNIER_API std::string write_model(const std::string& path, const ModelData& model);
/// @param content the text of a model file
/// @param file    its name in messages
/// @throws DataError naming file and key
VERNIER_API ModelData parse_model(const std::string& content, const std::string& file);
/// Requires of a model the number of joints and the convention; throws a `DataError` otherwise.
VERNIER_API void require_chain(const ModelData& model, const std::string& file, int joints, bool modified);

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
  out.controller = robot.controller();
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

/// The arm of N joints, of which the model must be.
template <int N, class Convention>
CalibratedRobot<N, Convention> robot_of(const ModelData& data) {
  using Robot = CalibratedRobot<N, Convention>;
  using Chain = typename Robot::Chain;
  std::array<DhRow, N> rows;
  std::copy(data.nominal.rows().begin(), data.nominal.rows().end(), rows.begin());
  const Chain nominal = Chain::from_rows(rows);
  using Model = typename Robot::Model;
  Model model = data.fallback ? Model(nominal, data.identified.typed(nominal), data.fallback->typed(nominal),
                                      data.coverage.template typed<N>())
                              : Model(nominal, data.identified.typed(nominal));
  if (data.thermal) model = model.with_thermal(*data.thermal);
  Robot robot = Robot(data.name, model, {data.lower, data.upper}, data.provenance).with_controller(data.controller);
  if (data.estimate) robot = robot.with_estimate(*data.estimate);
  if (!data.learned) return robot;
  const JointCoverage<N> gate = data.learned->coverage.template typed<N>();
  if (const auto* network = std::get_if<FittedNetwork>(&data.learned->function))
    return robot.with_learned(ElmPredictor<N, 3>(*network), gate);
  return robot.with_learned(KernelPredictor<N, 3>(*std::get_if<FittedKernels>(&data.learned->function)), gate);
}

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/model_data.ipp"
#endif
