// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "vernier/io/detail/learned_json.hpp"

namespace vernier::detail {

inline constexpr std::array<std::string_view, 4> activation_names{"sigmoid", "tanh", "sine", "radial_basis"};
inline constexpr std::array<std::string_view, 3> input_map_names{"raw", "sines_and_cosines", "sine_cosine_products"};
inline constexpr std::array<std::string_view, 2> kernel_names{"squared_exponential", "matern_5_2"};
inline constexpr std::array<std::string_view, 3> scaling_names{"none", "min_max", "standard"};

/// A matrix, column by column.
VERNIER_LOCAL MatrixX matrix_from_json(const JsonNode& node, Index rows, Index columns) {
  const VectorX values = node.numbers(static_cast<std::size_t>(rows * columns));
  return Eigen::Map<const MatrixX>(values.data(), rows, columns);
}

VERNIER_IMPL OrderedJson learned_to_json(const LearnedData& learned) {
  const auto flat = [](const MatrixX& values) {
    return list_of(Eigen::Map<const VectorX>(values.data(), values.size()));
  };
  if (const FittedKernels* kernels = std::get_if<FittedKernels>(&learned.function))
    return {{"kind", "kernels"},
            {"kernel", kernel_names[static_cast<std::size_t>(kernels->kernel)]},
            {"input_map", input_map_names[static_cast<std::size_t>(kernels->input_map)]},
            {"feature_offset", list_of(kernels->scaling.offset)},
            {"feature_factor", list_of(kernels->scaling.factor)},
            {"samples", kernels->centres.rows()},
            {"centres", flat(kernels->centres)},
            {"coefficients_m", flat(kernels->alpha)},
            {"mean_m", list_of(kernels->mean)},
            {"coverage", coverage_to_json(learned.coverage)}};
  const FittedNetwork& elm = *std::get_if<FittedNetwork>(&learned.function);
  const HiddenLayer& layer = elm.layer;
  return {{"kind", "elm"},
          {"hidden_nodes", layer.nodes},
          {"activation", activation_names[static_cast<std::size_t>(layer.activation)]},
          {"input_map", input_map_names[static_cast<std::size_t>(layer.input_map)]},
          {"input_scaling", scaling_names[static_cast<std::size_t>(layer.input_scaling)]},
          {"weight_limit", layer.weight_limit},
          {"feature_offset", list_of(elm.scaling.offset)},
          {"feature_factor", list_of(elm.scaling.factor)},
          {"hidden_weights", list_of(elm.theta)},
          {"output_weights_m", flat(elm.beta)},
          {"output_offset_m", list_of(elm.offset)},
          {"coverage", coverage_to_json(learned.coverage)}};
}

VERNIER_LOCAL FittedNetwork network_from_json(const JsonNode& node, int joints) {
  FittedNetwork out;
  HiddenLayer& layer = out.layer;
  layer.nodes = static_cast<int>(node.at("hidden_nodes").integer(1, 100000));
  layer.activation = static_cast<Activation>(named(node.at("activation"), activation_names));
  layer.input_map = static_cast<InputMap>(named(node.at("input_map"), input_map_names));
  layer.input_scaling = static_cast<Scaling>(named(node.at("input_scaling"), scaling_names));
  layer.weight_limit = node.at("weight_limit").number();
  if (!(layer.weight_limit > 0)) node.at("weight_limit").fail("must be positive");
  const auto features = static_cast<std::size_t>(layer.features(joints));
  out.scaling = {node.at("feature_offset").numbers(features), node.at("feature_factor").numbers(features)};
  out.theta = node.at("hidden_weights").numbers(static_cast<std::size_t>(layer.dimension(joints)));
  out.beta = matrix_from_json(node.at("output_weights_m"), layer.nodes, 3);
  out.offset = node.at("output_offset_m").numbers(3);
  return out;
}

VERNIER_LOCAL FittedKernels kernels_from_json(const JsonNode& node, int joints) {
  FittedKernels out;
  out.kernel = static_cast<Kernel>(named(node.at("kernel"), kernel_names));
  out.input_map = static_cast<InputMap>(named(node.at("input_map"), input_map_names));
  const Index samples = static_cast<Index>(node.at("samples").integer(1, 1000000));
  const Index features = feature_count(out.input_map, joints);
  out.scaling = {node.at("feature_offset").numbers(static_cast<std::size_t>(features)),
                 node.at("feature_factor").numbers(static_cast<std::size_t>(features))};
  out.centres = matrix_from_json(node.at("centres"), samples, features);
  out.alpha = matrix_from_json(node.at("coefficients_m"), samples, 3);
  out.mean = node.at("mean_m").numbers(3);
  return out;
}

VERNIER_IMPL LearnedData learned_from_json(const JsonNode& node, int joints) {
  constexpr std::array<std::string_view, 2> kinds{"elm", "kernels"};
  const CoverageData coverage = coverage_from_json(node.at("coverage"), joints);
  if (named(node.at("kind"), kinds) == 0) return {network_from_json(node, joints), coverage};
  return {kernels_from_json(node, joints), coverage};
}

}  // namespace vernier::detail
