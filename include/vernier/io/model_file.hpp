#pragma once

/// @file
/// Calibrated arms as JSON files: whole or not at all, exact to the last bit, checked value by value when read.

#include <cmath>
#include <filesystem>
#include <string>

#include "vernier/core/version.hpp"
#include "vernier/io/calibrated_robot.hpp"
#include "vernier/io/error_model_json.hpp"

namespace vernier {

namespace detail {

/// The version of model files written, and the only one read.
inline constexpr int model_schema_version = 2;
inline constexpr std::array<std::string_view, 4> activation_names{"sigmoid", "tanh", "sine", "radial_basis"};
inline constexpr std::array<std::string_view, 2> input_map_names{"raw", "sines_and_cosines"};
inline constexpr std::array<std::string_view, 2> joint_readings{"commanded", "encoder"};
inline constexpr std::array<std::string_view, 2> measured_names{"poses", "positions"};
inline constexpr std::array<std::string_view, 3> scaling_names{"none", "min_max", "standard"};

/// The position of a name in a list, for the enums that are stored by name.
template <std::size_t K>
int named(const JsonNode& node, const std::array<std::string_view, K>& names) {
  const std::string name = node.text();
  for (std::size_t i = 0; i < K; ++i)
    if (names[i] == name) return static_cast<int>(i);
  node.fail("'" + quotable(name) + "' is unknown");
}

template <int N>
nlohmann::ordered_json learned_to_json(const ElmPredictor<N, 3>& elm, const JointCoverage<N>& gate) {
  const HiddenLayer& layer = elm.layer();
  return {{"kind", "elm"},
          {"hidden_nodes", layer.nodes},
          {"activation", activation_names[static_cast<std::size_t>(layer.activation)]},
          {"input_map", input_map_names[static_cast<std::size_t>(layer.input_map)]},
          {"input_scaling", scaling_names[static_cast<std::size_t>(layer.input_scaling)]},
          {"weight_limit", layer.weight_limit},
          {"feature_offset", list_of(elm.scaling().offset)},
          {"feature_factor", list_of(elm.scaling().factor)},
          {"hidden_weights", list_of(elm.theta())},
          {"output_weights_m", list_of(MatrixX(elm.beta()).reshaped())},
          {"output_offset_m", list_of(elm.offset())},
          {"coverage", coverage_to_json<N>(gate)}};
}

template <int N>
CalibratedRobot<N> with_learned_from_json(const CalibratedRobot<N>& robot, const JsonNode& node) {
  if (const std::string kind = node.at("kind").text(); kind != "elm")
    node.at("kind").fail("'" + quotable(kind) + "' is unknown");
  HiddenLayer layer;
  layer.nodes = static_cast<int>(node.at("hidden_nodes").integer(1, 100000));
  layer.activation = static_cast<Activation>(named(node.at("activation"), activation_names));
  layer.input_map = static_cast<InputMap>(named(node.at("input_map"), input_map_names));
  layer.input_scaling = static_cast<Scaling>(named(node.at("input_scaling"), scaling_names));
  layer.weight_limit = node.at("weight_limit").number();
  if (!(layer.weight_limit > 0)) node.at("weight_limit").fail("must be positive");
  const auto features = static_cast<std::size_t>(layer.features(N));
  const ColumnScaling scaling{node.at("feature_offset").numbers(features), node.at("feature_factor").numbers(features)};
  const VectorX theta = node.at("hidden_weights").numbers(static_cast<std::size_t>(layer.dimension(N)));
  const VectorX beta = node.at("output_weights_m").numbers(3 * static_cast<std::size_t>(layer.nodes));
  const Vector3 offset = node.at("output_offset_m").numbers(3);
  return robot.with_learned({layer, scaling, theta, beta.reshaped(layer.nodes, 3), offset},
                            coverage_from_json<N>(node.at("coverage")));
}

/// Checks what every model file says first.
inline JsonNode model_root(const nlohmann::json& document, const std::filesystem::path& path) {
  const JsonNode root(document, path.string());
  if (!root.has("schema_version")) root.fail("key 'schema_version' is missing; is this a model that calibrate saved?");
  const auto version = root.at("schema_version").integer(0, INT32_MAX);
  if (version != model_schema_version)
    root.at("schema_version")
        .fail(message("version ", version, " is unknown; this program reads version ", model_schema_version));
  return root;
}

}  // namespace detail

/// A calibrated arm as JSON; lengths in m, angles in rad, as the keys say.
template <int N>
nlohmann::ordered_json to_json(const CalibratedRobot<N>& robot) {
  using Json = nlohmann::ordered_json;
  Json joints = Json::array();
  for (int i = 0; i < N; ++i) {
    const bool revolute = robot.nominal().row(i).joint == JointType::revolute;
    Json joint{{"type", revolute ? "revolute" : "prismatic"}, {"nominal", detail::row_to_json(robot.nominal().row(i))}};
    if (const double lower = robot.limits().lower(i); std::isfinite(lower))
      joint[revolute ? "lower_rad" : "lower_m"] = lower;
    if (const double upper = robot.limits().upper(i); std::isfinite(upper))
      joint[revolute ? "upper_rad" : "upper_m"] = upper;
    joints.push_back(std::move(joint));
  }
  require(std::isfinite(robot.provenance().position_sigma), "save_calibrated_robot: position_sigma is not finite");
  const Provenance& from = robot.provenance();
  Json out{{"schema_version", detail::model_schema_version},
           {"written_by",
            message("vernier ", VERNIER_VERSION_MAJOR, ".", VERNIER_VERSION_MINOR, ".", VERNIER_VERSION_PATCH)},
           {"name", robot.name()},
           {"provenance",
            {{"data_file", from.data_file},
             {"rows", from.rows},
             {"date", from.date},
             {"joints", from.joints},
             {"measured", from.measured},
             {"position_sigma_m", from.position_sigma}}},
           {"joints", std::move(joints)},
           {"arm", detail::arm_to_json(robot.model().arm())}};
  if (const auto* fallback = robot.model().fallback()) {
    out["outside_arm"] = detail::arm_to_json(*fallback);
    out["coverage"] = detail::coverage_to_json<N>(*robot.model().coverage());
  }
  if (const auto* corrected = robot.learned())
    out["learned"] = detail::learned_to_json<N>(corrected->learned(), corrected->coverage());
  return out;
}

/// Saves a calibrated arm, whole or not at all; `load_calibrated_robot` gives back the same bits.
/// @throws std::runtime_error when the file cannot be written
/// @throws std::invalid_argument on a value that is not finite
template <int N>
void save_calibrated_robot(const std::filesystem::path& path, const CalibratedRobot<N>& robot) {
  std::string text;
  try {
    text = to_json(robot).dump(1);
  } catch (const nlohmann::json::exception&) {  // a name that is not UTF-8
    throw std::invalid_argument("save_calibrated_robot: a name is not valid text");
  }
  write_file(path, text + "\n");
}

/// The number of joints of a saved arm.
/// @throws DataError naming file and key
inline int calibrated_robot_dof(const std::filesystem::path& path) {
  const nlohmann::json document = read_json(path);
  const JsonNode joints = detail::model_root(document, path).at("joints");
  if (joints.size() < 1 || joints.size() > 100) joints.fail(message("has ", joints.size(), " joints"));
  return static_cast<int>(joints.size());
}

/// Loads a calibrated arm of N joints.
/// @throws DataError naming file and key
template <int N>
CalibratedRobot<N> load_calibrated_robot(const std::filesystem::path& path) {
  const nlohmann::json document = read_json(path);
  const JsonNode root = detail::model_root(document, path);
  const JsonNode joints = root.at("joints");
  joints.require_size(N);
  std::array<DhRow, N> nominal{};
  JointLimits<N> limits;
  for (int i = 0; i < N; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const JsonNode joint = joints.at(k);
    constexpr std::array<std::string_view, 2> types{"revolute", "prismatic"};
    const auto type = static_cast<JointType>(detail::named(joint.at("type"), types));
    nominal[k] = detail::row_from_json(joint.at("nominal"), type);
    const bool revolute = type == JointType::revolute;
    if (joint.has_quantity("lower")) limits.lower(i) = joint.at(revolute ? "lower_rad" : "lower_m").number();
    if (joint.has_quantity("upper")) limits.upper(i) = joint.at(revolute ? "upper_rad" : "upper_m").number();
    if (!(limits.lower(i) < limits.upper(i))) joint.fail("the lower limit is not below the upper one");
  }
  const JsonNode from = root.at("provenance");
  const auto any_text = [](const JsonNode& node) { return node.is_empty_text() ? std::string() : node.text(); };
  const auto one_of = [&](const char* key, const auto& names) {
    return std::string(names[static_cast<std::size_t>(detail::named(from.at(key), names))]);
  };
  const Provenance provenance{any_text(from.at("data_file")),
                              static_cast<Index>(from.at("rows").integer(0, INT32_MAX)),
                              any_text(from.at("date")),
                              one_of("joints", detail::joint_readings),
                              one_of("measured", detail::measured_names),
                              from.at("position_sigma_m").number()};
  const auto chain = DhChain<N>::from_rows(nominal);
  using Model = typename CalibratedRobot<N>::Model;
  auto arm = detail::arm_from_json(chain, root.at("arm"));
  if (root.has("coverage") && !root.has("outside_arm")) root.fail("key 'outside_arm' is missing");
  const Model model = root.has("outside_arm")
                          ? Model(chain, std::move(arm), detail::arm_from_json(chain, root.at("outside_arm")),
                                  detail::coverage_from_json<N>(root.at("coverage")))
                          : Model(chain, std::move(arm));
  const CalibratedRobot<N> robot(root.at("name").text(), model, limits, provenance);
  return root.has("learned") ? detail::with_learned_from_json(robot, root.at("learned")) : robot;
}

}  // namespace vernier
