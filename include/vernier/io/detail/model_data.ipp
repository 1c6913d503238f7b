// SPDX-License-Identifier: BSD-3-Clause
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
#include "vernier/io/camera_files.hpp"
#include "vernier/io/detail/estimate_json.hpp"
#include "vernier/io/detail/learned_json.hpp"
#include "vernier/io/detail/model_data.hpp"

namespace vernier::detail {

/// The version of files of arms whose motors err; other files are written as version 5. Version 4 is read, too, without
/// an estimate, and versions 2 (standard chains) and 3 (modified ones): they have the orders 1 .. `harmonics` at each
/// joint, and no hysteresis.
inline constexpr int model_schema_version = 6, oldest_schema_version = 2;
inline constexpr std::array<std::string_view, 2> joint_type_names{"revolute", "prismatic"};
inline constexpr std::array<std::string_view, 2> places_of_errors{"chain", "motors"};
inline constexpr std::array<std::string_view, 2> joint_readings{"commanded", "encoder"};
inline constexpr std::array<std::string_view, 5> measured_names{"poses", "positions", "contacts", "images",
                                                                "distances"};

/// The key of a joint's limit, or of its zero.
VERNIER_LOCAL const char* key_of(JointType type, const char* angle, const char* length) {
  return type == JointType::revolute ? angle : length;
}

VERNIER_LOCAL std::vector<JointType> types_of(const ChainTable& chain) {
  std::vector<JointType> out;
  for (const DhRow& row : chain.rows()) out.push_back(row.joint);
  return out;
}

VERNIER_LOCAL void add_limits(OrderedJson& joint, JointType type, double lower, double upper) {
  if (std::isfinite(lower)) joint[key_of(type, "lower_rad", "lower_m")] = lower;
  if (std::isfinite(upper)) joint[key_of(type, "upper_rad", "upper_m")] = upper;
}

VERNIER_LOCAL void read_limits_of(const JsonNode& joint, JointType type, double& lower, double& upper) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  lower = joint.has_quantity("lower") ? joint.at(key_of(type, "lower_rad", "lower_m")).number() : -infinity;
  upper = joint.has_quantity("upper") ? joint.at(key_of(type, "upper_rad", "upper_m")).number() : infinity;
  if (!(lower < upper)) joint.fail("the lower limit is not below the upper one");
}

/// A controller that counts its joints differently: for each joint of the chain factors and a zero, and limits.
VERNIER_LOCAL OrderedJson controller_to_json(const ModelData& model) {
  const ControllerMap& map = model.controller;
  const std::vector<JointType> chain_types = types_of(model.nominal), types = map.types(chain_types);
  OrderedJson chain = OrderedJson::array(), joints = OrderedJson::array();
  for (int i = 0; i < map.chain_joints(); ++i) {
    OrderedJson factors = OrderedJson::array();
    for (int j = 0; j < map.joints(); ++j) factors.push_back(static_cast<int>(map.square()(i, j)));
    chain.push_back({{"factors", std::move(factors)},
                     {key_of(chain_types[static_cast<std::size_t>(i)], "zero_rad", "zero_m"), map.zeros()(i)}});
  }
  for (int j = 0; j < map.joints(); ++j) {
    OrderedJson joint = OrderedJson::object();
    add_limits(joint, types[static_cast<std::size_t>(j)], model.lower(j), model.upper(j));
    joints.push_back(std::move(joint));
  }
  OrderedJson out{{"chain", std::move(chain)}, {"joints", std::move(joints)}};
  if (map.motor_errors()) out["errors"] = "motors";
  return out;
}

/// Reads what `controller_to_json` writes.
VERNIER_LOCAL void controller_from_json(const JsonNode& node, ModelData& model) {
  const std::vector<JointType> chain_types = types_of(model.nominal);
  const auto n = static_cast<Index>(chain_types.size());
  const JsonNode chain = node.at("chain"), joints = node.at("joints");
  chain.require_size(chain_types.size());
  const auto m = static_cast<Index>(joints.size());
  MatrixX factors(n, m);
  VectorX zeros(n);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const VectorX row = chain.at(k).at("factors").numbers(joints.size());
    for (Index j = 0; j < m; ++j) factors(i, j) = row(j);
    zeros(i) = chain.at(k).at(key_of(chain_types[k], "zero_rad", "zero_m")).number();
  }
  std::vector<JointType> types;
  try {
    const bool of_motors = node.has("errors") && named(node.at("errors"), places_of_errors) == 1;
    model.controller = ControllerMap(factors, zeros).with_motor_errors(of_motors);
    types = model.controller.types(chain_types);
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
  model.lower.setZero();
  model.upper.setZero();
  for (Index j = 0; j < m; ++j) {
    const auto k = static_cast<std::size_t>(j);
    read_limits_of(joints.at(k), types[k], model.lower(j), model.upper(j));
  }
}

/// An arm whose gears err where those of its controller do: what a file does not say of each arm.
VERNIER_LOCAL void place_errors(FittedArm& arm, const ControllerMap& controller) {
  JointTerms terms = arm.errors.terms();
  terms.motors = MotorAngles(controller);
  arm.errors = JointErrors(std::move(terms), arm.errors.coefficients()).under(arm.errors.load());
}

VERNIER_LOCAL void require_placed_errors(const FittedArm& arm, const ControllerMap& controller) {
  demand(arm.errors.empty() || arm.errors.terms().motors == MotorAngles(controller),
         "save: gears of the model err at other joints than its controller says: give the fit the same controller");
}

VERNIER_IMPL OrderedJson model_to_json(const ModelData& model) {
  OrderedJson joints = OrderedJson::array();
  for (int i = 0; i < model.nominal.joints(); ++i) {
    const bool revolute = model.nominal.revolute(i);
    OrderedJson joint{{"type", joint_type_names[revolute ? 0 : 1]},
                      {"nominal", row_to_json(model.nominal.rows()[static_cast<std::size_t>(i)])}};
    if (model.controller.same())
      add_limits(joint, model.nominal.rows()[static_cast<std::size_t>(i)].joint, model.lower(i), model.upper(i));
    joints.push_back(std::move(joint));
  }
  const Provenance& from = model.provenance;
  demand(std::isfinite(from.position_sigma), "save: position_sigma is not finite");
  const bool modified = model.nominal.modified();
  require_placed_errors(model.identified, model.controller);
  if (model.fallback) require_placed_errors(*model.fallback, model.controller);
  const bool of_motors = !MotorAngles(model.controller).none();
  OrderedJson out{{"schema_version", of_motors ? model_schema_version : 5},
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
  if (!from.fitted_rows.empty()) out["provenance"]["fitted_rows"] = from.fitted_rows.values();
  if (from.camera) out["provenance"]["camera"] = setup_to_json(*from.camera);
  out["joints"] = std::move(joints);
  if (!model.controller.same()) out["controller"] = controller_to_json(model);
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
  VectorX lower(joints), upper(joints);
  for (int i = 0; i < joints; ++i) {
    const JsonNode joint = list.at(static_cast<std::size_t>(i));
    const auto type = static_cast<JointType>(named(joint.at("type"), joint_type_names));
    rows.push_back(row_from_json(joint.at("nominal"), type));
    read_limits_of(joint, type, lower(i), upper(i));
  }
  const JsonNode from = root.at("provenance");
  constexpr std::size_t longest = 100000;  // names and hashes of many files
  const auto any_text = [](const JsonNode& node) { return node.is_empty_text() ? std::string() : node.text(longest); };
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
  if (from.has("fitted_rows")) {
    const JsonNode node = from.at("fitted_rows");
    std::vector<std::uint32_t> values;
    for (std::size_t i = 0; i < node.size(); ++i)
      values.push_back(static_cast<std::uint32_t>(node.at(i).integer(0, UINT32_MAX)));
    provenance.fitted_rows = RowFingerprints(std::move(values));
  }
  if (from.has("camera")) provenance.camera = setup_from_json(from.at("camera"));
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
  if (root.has("controller")) controller_from_json(root.at("controller"), out);
  const bool of_motors = !MotorAngles(out.controller).none();
  if (of_motors) place_errors(out.identified, out.controller);
  if (root.has("coverage") && !root.has("outside_arm")) root.fail("key 'outside_arm' is missing");
  if (root.has("outside_arm")) {
    out.fallback = arm_from_json(nominal, root.at("outside_arm"));
    out.coverage = coverage_from_json(root.at("coverage"), joints);
    if (of_motors) {
      place_errors(*out.fallback, out.controller);
      out.coverage.motors = MotorAngles(out.controller);
    }
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
