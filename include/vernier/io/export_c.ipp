// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/version.hpp"
#include "vernier/io/detail/c_code.hpp"
#include "vernier/io/detail/c_tables.hpp"
#include "vernier/io/export_c.hpp"

namespace vernier {

namespace detail {

/// @throws std::invalid_argument on a name that cannot begin names in C
VERNIER_LOCAL void require_identifier(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  bool valid = !name.empty() && letter(name.front());
  for (const char c : name) valid = valid && (letter(c) || (c >= '0' && c <= '9') || c == '_');
  demand(valid, "c_source: the name '", c_text(name),
         "' is no C identifier: letters, digits and underscores, a letter first");
}

/// What an arm has, in the words of the C text.
VERNIER_LOCAL std::set<std::string> c_features(const ModelData& model) {
  std::set<std::string> out;
  const auto add = [&](const char* feature, bool present) {
    if (present) out.insert(feature);
  };
  const auto add_terms = [&](const FittedArm& arm) {
    for (const JointTermBlock& block : arm.errors.terms().blocks()) {
      const JointTermTraits& row = traits_of(block.kind);
      out.insert(c_capitals(row.key));
      add("LINKS", row.links);
    }
  };
  add_terms(model.identified);
  if (model.fallback) add_terms(*model.fallback);
  for (const DhRow& row : model.nominal.rows()) add("PRISMATIC", row.joint == JointType::prismatic);
  add("MODIFIED", model.nominal.modified());
  const int joints = model.nominal.joints(), equations = joints >= 6 ? 6 : 3;  // as CorrectionTarget::automatic
  add("ORIENTED", equations == 6);
  add("CONTROLLER", !model.controller.same());
  add("MOTORS", !model.identified.errors.empty() && !model.identified.errors.terms().motors.none());
  add("REDUNDANT", equations < model.controller.joints(joints));
  add("FALLBACK", model.fallback.has_value());
  add("LEARNED", model.learned.has_value());
  add("GATES", model.fallback || model.learned);
  add("LINEAR", out.contains("GEAR_RATIO") || out.contains("COUPLING"));
  add("MOTION", out.contains("TILT") || out.contains("PAYLOAD_BEND") || out.contains("STRAIGHTNESS"));
  add("LOG", out.contains("ORIENTED") || out.contains("FALLBACK"));
  add("TORQUES", out.contains("GRAVITY") || out.contains("PAYLOAD"));
  add("EXP", out.contains("MOTION") || out.contains("FALLBACK"));
  if (!model.learned) return out;
  const HiddenLayer& layer = std::get_if<FittedNetwork>(&model.learned->function)->layer;
  constexpr const char* maps[] = {"MAP_RAW", "MAP_SINES_AND_COSINES", "MAP_PRODUCTS"};
  constexpr const char* activations[] = {"SIGMOID", "TANH", "SINE", "RADIAL_BASIS"};
  out.insert(maps[static_cast<int>(layer.input_map)]);
  out.insert(activations[static_cast<int>(layer.activation)]);
  add("SINES", layer.input_map != InputMap::raw);
  return out;
}

/// What the file says about itself, and its macros.
VERNIER_LOCAL std::string c_preamble(const ModelData& model, const CExport& options) {
  const Provenance& from = model.provenance;
  const CorrectionOptions correction;
  const double held_out_error = options.held_out_error.value_or(from.held_out_error);
  const bool stated = options.held_out_error || held_out_error > 0;
  const std::string version = message(VERNIER_VERSION_MAJOR, ".", VERNIER_VERSION_MINOR, ".", VERNIER_VERSION_PATCH);
  const std::string hash = options.hash.empty() ? sha256(model_to_json(model).dump(1) + "\n") : options.hash;
  const auto row = [](const char* what, const std::string& value) { return message(" * ", what, c_text(value), "\n"); };
  std::string out = message("/* ", c_text(model.name), ": a calibrated arm, written by Vernier ", version, "\n *\n");
  out += row("model, SHA-256:  ", hash);
  out += row("calibrated:      ", from.date);
  out += row("from:            ", message(from.rows, " ", from.measured, " of ", from.data_file));
  out += row("joint values:    ", from.joints);
  out +=
      row("held-out error:  ", stated ? message(held_out_error * 1e3, " mm in the mean") : std::string("not stated"));
  if (model.thermal)
    out +=
        row("temperature:     ", message(model.thermal->reference, " deg C; how the arm changes with it is left out"));
  if (const auto& payload = model.identified.errors.terms().payload) {
    const double more = model.identified.errors.load().weight / standard_gravity;
    out += row("payload:         ", message(payload->reference().mass + more, " kg"));
  }
  const std::string capitals = c_capitals(options.name);
  out += message(" *\n * C99 and C++11. All functions are static inline; to compile a library of them, define ",
                 capitals, "_API as empty:\n *   cc -O2 -shared -fPIC -D", capitals, "_API= -x c THIS_FILE -o ",
                 options.name, ".so -lm\n * Do not correct commands that a controller corrects already. */\n");
  out += with_name(R"(#ifndef ARM_H
#define ARM_H

#include <math.h>

#ifndef ARM_API
#define ARM_API static inline
#endif

)",
                   options.name);
  const auto define = [&](const char* what, const std::string& value) {
    out += message("#define ", capitals, "_", what, " ", value, "\n");
  };
  const auto quoted = [](const std::string& text) { return '"' + c_text(text) + '"'; };
  define("JOINTS", message(model.controller.joints(model.nominal.joints())));
  define("MODEL_NAME", quoted(model.name));
  define("MODEL_HASH", quoted(hash));
  define("MODEL_DATE", quoted(from.date));
  define("VERNIER_VERSION", quoted(version));
  if (stated) define("HELD_OUT_ERROR", c_number(held_out_error) + " /* mean [m] */");
  if (model.thermal) define("TEMPERATURE", c_number(model.thermal->reference) + " /* [deg C] */");
  define("POSITION_TOLERANCE", c_number(correction.position_tolerance) + " /* of a correction [m] */");
  define("ROTATION_TOLERANCE", c_number(correction.rotation_tolerance) + " /* [rad] */");
  out += message("\n/* What ", options.name, "_correct returns. */\n");
  define("MET", "0");
  define("STALLED", "1");
  define("LIMITS", "2");
  return out + "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
}

VERNIER_IMPL std::string c_source(const ModelData& model, const CExport& options) {
  require_identifier(options.name);
  if (const auto* kernels = model.learned ? std::get_if<FittedKernels>(&model.learned->function) : nullptr)
    demand(false, "c_source: the position error that was learned is a sum of ", kernels->centres.rows(),
           " kernels (kernel ELM, Gaussian process), which is not written as C source; networks are");
  const int joints = model.nominal.joints(), moving = model.controller.joints(joints);
  const int lanes = (joints + 1) / 2 * 2;  // vectors hold an even number
  const bool oriented = joints >= 6;

  const std::set<std::string> features = c_features(model);
  const auto text = [&](std::string_view of_all) { return fill_in(of_all, options.name, features); };
  const std::string prefix = options.name + "_", capitals = c_capitals(options.name);
  std::string out = c_preamble(model, options) + text(c_declarations);
  out += "\n/* ---- private from here on ---- */\n\n";
  const auto define = [&](const char* what, const std::string& value) {
    out += message("#define ", capitals, "_", what, "_ ", value, "\n");
  };
  define("CHAIN", message(joints));
  define("LANES", message(lanes));
  define("SIZE", message((std::min)(moving, oriented ? 6 : 3)));
  define("EVALUATIONS", message(CorrectionOptions{}.max_iterations));
  define("ROTATION_LENGTH", c_number(oriented ? IkOptions<6>{}.rotation_length : 0));
  const FittedNetwork* network = model.learned ? std::get_if<FittedNetwork>(&model.learned->function) : nullptr;
  if (network != nullptr) {
    define("FEATURES", message(network->layer.features(joints)));
    define("NODES", message(network->layer.nodes));
  }
  out += c_kinds(capitals) + text(c_types);
  out += "\n/* ---- tables ---- */\n\n";
  std::vector<int> prismatic;
  std::string limits = message("static const double ", prefix, "limits_[2 * ", capitals, "_JOINTS] = {\n");
  for (int i = 0; i < joints; ++i) prismatic.push_back(model.nominal.revolute(i) ? 0 : 1);
  for (int i = 0; i < moving; ++i) {
    const auto limit = [](double value, const char* infinite) {
      return std::isinf(value) ? std::string(infinite) : c_number(value);
    };
    limits += message("    ", limit(model.lower(i), "-HUGE_VAL"), ", ", limit(model.upper(i), "HUGE_VAL"), ",\n");
  }
  out += limits + "};\n";
  if (features.contains("CONTROLLER")) {
    std::vector<double> factors;
    for (int i = 0; i < joints; ++i)
      for (int j = 0; j < moving; ++j) factors.push_back(model.controller.square()(i, j));
    const VectorX& zeros = model.controller.zeros();
    out += c_table(prefix + "factors_", factors, static_cast<std::size_t>(moving));
    out += c_table(prefix + "zeros_", std::vector<double>(zeros.data(), zeros.data() + zeros.size()), 3);
  }
  if (features.contains("MOTORS")) {
    const MotorAngles& motors = model.identified.errors.terms().motors;
    const VectorX& zeros = motors.zeros();
    std::vector<double> effects, angles;
    for (int i = 0; i < joints; ++i)
      for (int j = 0; j < joints; ++j) {
        effects.push_back(motors.moved(i, j));
        angles.push_back(motors.depends(i, j));
      }
    out += c_table(prefix + "motor_effects_", effects, static_cast<std::size_t>(joints));
    out += c_table(prefix + "motor_angles_", angles, static_cast<std::size_t>(joints));
    out += c_table(prefix + "motor_zeros_", std::vector<double>(zeros.data(), zeros.data() + zeros.size()), 3);
  }
  if (features.contains("PRISMATIC")) out += c_table(prefix + "prismatic_", prismatic);
  out += c_chain_table(prefix + "nominal_rows_", model.nominal);
  out += c_arm_tables(prefix + "arm_", prefix + "identified_", model.identified, lanes);
  if (model.fallback) {
    out += c_arm_tables(prefix + "arm_", prefix + "outside_", *model.fallback, lanes);
    out += c_coverage_tables(prefix + "coverage_", prefix + "coverage_of_model_", model.coverage);
  }
  if (network != nullptr) {
    out += c_network_tables(prefix, *network);
    out += c_coverage_tables(prefix + "coverage_", prefix + "coverage_of_learned_", model.learned->coverage);
  }
  for (const std::string_view functions : c_functions) out += text(functions);
  return out + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
}

}  // namespace detail

VERNIER_IMPL std::string c_source(const SavedModel& model, CExport options) {
  options.hash = model.hash();
  return detail::c_source(detail::SavedModelParts::data(model), options);
}

VERNIER_IMPL std::string c_source(const std::string& model_file, CExport options) {
  return c_source(read_model(model_file), std::move(options));
}

}  // namespace vernier
