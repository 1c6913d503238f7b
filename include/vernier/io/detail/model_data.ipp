#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/version.hpp"
#include "vernier/io/detail/estimate_json.hpp"
#include "vernier/io/detail/learned_json.hpp"
#include "vernier/io/detail/model_data.hpp"

namespace vernier::detail {

/// The version of the files that are written. Version 4 is read, too, without an estimate, and versions 2 (standard
/// chains) and 3 (modified ones): they have the orders 1 .. `harmonics` at each joint, and no hysteresis.
inline constexpr int model_schema_version = 5, oldest_schema_version = 2;
inline constexpr std::array<std::string_view, 2> joint_type_names{"revolute", "prismatic"};
inline constexpr std::array<std::string_view, 2> joint_readings{"commanded", "encoder"};
inline constexpr std::array<std::string_view, 3> measured_names{"poses", "positions", "contacts"};

VERNIER_IMPL OrderedJson model_to_json(const ModelData& model) {
  OrderedJson joints = OrderedJson::array();
  for (int i = 0; i < model.nominal.joints(); ++i) {
    const bool revolute = model.nominal.revolute(i);
    OrderedJson joint{{"type", joint_type_names[revolute ? 0 : 1]},
                      {"nominal", row_to_json(model.nominal.rows()[static_cast<std::size_t>(i)])}};
    if (std::isfinite(model.lower(i))) joint[revolute ? "lower_rad" : "lower_m"] = model.lower(i);
    if (std::isfinite(model.upper(i))) joint[revolute ? "upper_rad" : "upper_m"] = model.upper(i);
    joints.push_back(std::move(joint));
  }
  const Provenance& from = model.provenance;
  demand(std::isfinite(from.position_sigma), "save: position_sigma is not finite");
  const bool modified = model.nominal.modified();
  OrderedJson out{{"schema_version", model_schema_version},
                  {"written_by",
                   message("vernier ", VERNIER_VERSION_MAJOR, ".", VERNIER_VERSION_MINOR, ".", VERNIER_VERSION_PATCH)},
                  {"name", model.name}};
  if (modified) out["convention"] = "modified";
  out["provenance"] = {{"data_file", from.data_file}, {"rows", from.rows},
                       {"date", from.date},           {"joints", from.joints},
                       {"measured", from.measured},   {"position_sigma_m", from.position_sigma}};
  const auto add_known = [&](const char* key, double error) {
    demand(std::isfinite(error), "save: ", key, " is not finite");
    if (error > 0) out["provenance"][key] = error;
  };
  add_known("left_out_error_m", from.left_out_error);
  add_known("held_out_error_m", from.held_out_error);
  if (!from.data_sha256.empty()) out["provenance"]["data_sha256"] = from.data_sha256;
  out["joints"] = std::move(joints);
  out["arm"] = arm_to_json(model.identified);
  if (model.fallback) {
    out["outside_arm"] = arm_to_json(*model.fallback);
    out["coverage"] = coverage_to_json(model.coverage);
  }
  if (model.thermal)
    out["thermal"] = {{"reference_c", model.thermal->reference},
                      {"measured_c", {model.thermal->lower, model.thermal->upper}},
                      {"rates_per_k", list_of(model.thermal->parameters)}};
  if (model.learned) out["learned"] = learned_to_json(*model.learned);
  if (model.estimate) out["estimate"] = estimate_to_json(*model.estimate);
  return out;
}

VERNIER_IMPL std::string write_model(const std::string& path, const ModelData& model) {
  std::string text;
  try {
    text = model_to_json(model).dump(1) + "\n";
  } catch (const nlohmann::json::exception&) {  // a name that is not UTF-8
    throw std::invalid_argument("save: a name is not valid text");
  }
  write_file(path, text);
  return sha256(text);
}

/// Checks version and convention, which every model file starts with.
/// @return whether it is a modified chain
VERNIER_LOCAL bool check_schema(const JsonNode& root) {
  if (!root.has("schema_version")) root.fail("key 'schema_version' is missing; is this a model that calibrate saved?");
  const auto version = root.at("schema_version").integer(0, INT32_MAX);
  if (version < oldest_schema_version || version > model_schema_version)
    root.at("schema_version")
        .fail(message("version ", version, " is unknown; this program reads versions ", oldest_schema_version, " to ",
                      model_schema_version));
  constexpr std::array<std::string_view, 2> conventions{"standard", "modified"};
  return root.has("convention") && named(root.at("convention"), conventions) == 1;
}

VERNIER_IMPL void require_chain(const ModelData& model, const std::string& file, int joints, bool modified) {
  if (model.nominal.modified() != modified)
    throw DataError(file + (modified ? ": the chain is in the standard convention, a modified one was expected"
                                     : ": the chain is in the modified convention, a standard one was expected"));
  if (model.nominal.joints() != joints)
    throw DataError(message(file, ": joints: has ", model.nominal.joints(), " entries, must have ", joints));
}

VERNIER_IMPL ModelData parse_model(const std::string& content, const std::string& file) {
  const nlohmann::json document = parse_json(content, file);
  const JsonNode root(document, file);
  const bool modified = check_schema(root);
  const JsonNode list = root.at("joints");
  if (list.size() < 1 || list.size() > max_joints) list.fail(message("has ", list.size(), " joints"));
  const auto joints = static_cast<int>(list.size());
  std::vector<DhRow> rows;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  VectorX lower = VectorX::Constant(joints, -infinity), upper = VectorX::Constant(joints, infinity);
  for (int i = 0; i < joints; ++i) {
    const JsonNode joint = list.at(static_cast<std::size_t>(i));
    const auto type = static_cast<JointType>(named(joint.at("type"), joint_type_names));
    rows.push_back(row_from_json(joint.at("nominal"), type));
    const bool revolute = type == JointType::revolute;
    if (joint.has_quantity("lower")) lower(i) = joint.at(revolute ? "lower_rad" : "lower_m").number();
    if (joint.has_quantity("upper")) upper(i) = joint.at(revolute ? "upper_rad" : "upper_m").number();
    if (!(lower(i) < upper(i))) joint.fail("the lower limit is not below the upper one");
  }
  const JsonNode from = root.at("provenance");
  const auto any_text = [](const JsonNode& node) { return node.is_empty_text() ? std::string() : node.text(); };
  const auto one_of = [&](const char* key, const auto& names) {
    return std::string(names[static_cast<std::size_t>(named(from.at(key), names))]);
  };
  const auto known = [&](const char* key) { return from.has(key) ? from.at(key).number() : 0; };
  Provenance provenance{any_text(from.at("data_file")),
                        static_cast<Index>(from.at("rows").integer(0, INT32_MAX)),
                        any_text(from.at("date")),
                        one_of("joints", joint_readings),
                        one_of("measured", measured_names),
                        from.at("position_sigma_m").number(),
                        known("left_out_error_m"),
                        known("held_out_error_m"),
                        from.has("data_sha256") ? any_text(from.at("data_sha256")) : std::string()};
  const ChainTable nominal(std::move(rows), modified);
  ModelData out{root.at("name").text(),
                nominal,
                std::move(lower),
                std::move(upper),
                std::move(provenance),
                arm_from_json(nominal, root.at("arm")),
                {},
                {},
                {},
                {},
                {}};
  if (root.has("coverage") && !root.has("outside_arm")) root.fail("key 'outside_arm' is missing");
  if (root.has("outside_arm")) {
    out.fallback = arm_from_json(nominal, root.at("outside_arm"));
    out.coverage = coverage_from_json(root.at("coverage"), joints);
  }
  if (root.has("thermal")) {
    const JsonNode node = root.at("thermal");
    const VectorX range = node.at("measured_c").numbers(2);
    if (!(range(0) <= range(1))) node.at("measured_c").fail("its lower end is above its upper one");
    out.thermal = ThermalRates{node.at("reference_c").number(), range(0), range(1),
                               node.at("rates_per_k").numbers(static_cast<std::size_t>(12 + 5 * joints))};
  }
  if (root.has("learned")) out.learned = learned_from_json(root.at("learned"), joints);
  if (root.has("estimate"))
    out.estimate = estimate_from_json(root.at("estimate"), out.identified, out.thermal ? &*out.thermal : nullptr);
  return out;
}

}  // namespace vernier::detail
