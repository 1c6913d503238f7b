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
#include "vernier/core/version.hpp"
#include "vernier/io/detail/estimate_json.hpp"
#include "vernier/io/model_file.hpp"

namespace vernier {

namespace detail {

/// The version of the files that are written. Version 4 is read, too, without an estimate, and versions 2 (standard
/// chains) and 3 (modified ones): they have the orders 1 .. `harmonics` at each joint, and no hysteresis.
inline constexpr int model_schema_version = 5, oldest_schema_version = 2;
inline constexpr std::array<std::string_view, 2> joint_type_names{"revolute", "prismatic"};
inline constexpr std::array<std::string_view, 4> activation_names{"sigmoid", "tanh", "sine", "radial_basis"};
inline constexpr std::array<std::string_view, 3> input_map_names{"raw", "sines_and_cosines", "sine_cosine_products"};
inline constexpr std::array<std::string_view, 2> kernel_names{"squared_exponential", "matern_5_2"};
inline constexpr std::array<std::string_view, 2> joint_readings{"commanded", "encoder"};
inline constexpr std::array<std::string_view, 3> measured_names{"poses", "positions", "contacts"};
inline constexpr std::array<std::string_view, 3> scaling_names{"none", "min_max", "standard"};
inline constexpr std::array<std::string_view, 6> frame_keys{"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"};

using OrderedJson = nlohmann::ordered_json;

/// The position of a name in a list, for the enums that are stored by name.
template <std::size_t K>
int named(const JsonNode& node, const std::array<std::string_view, K>& names) {
  const std::string name = node.text();
  for (std::size_t i = 0; i < K; ++i)
    if (names[i] == name) return static_cast<int>(i);
  node.fail("'" + quotable(name) + "' is unknown");
}

VERNIER_API OrderedJson list_of(const ConstVectorRef& values) {
  require(all_finite(values), "save: a value is not finite");
  OrderedJson out = OrderedJson::array();
  for (Index i = 0; i < values.size(); ++i) out.push_back(values(i));
  return out;
}

VERNIER_API OrderedJson row_to_json(const DhRow& row) {
  for (const double value : {row.a, row.alpha, row.d, row.theta, row.beta})
    require(std::isfinite(value), "save: a parameter of the chain is not finite");
  return {{"a_m", row.a}, {"alpha_rad", row.alpha}, {"d_m", row.d}, {"theta_rad", row.theta}, {"beta_rad", row.beta}};
}

VERNIER_API DhRow row_from_json(const JsonNode& node, JointType type) {
  return {node.at("a_m").number(),       node.at("alpha_rad").number(), node.at("d_m").number(),
          node.at("theta_rad").number(), node.at("beta_rad").number(),  type};
}

VERNIER_API OrderedJson frame_to_json(const FrameParameters& frame) {
  require(all_finite(frame.values()), "save: a frame is not finite");
  OrderedJson out;
  for (std::size_t k = 0; k < 6; ++k) out[std::string(frame_keys[k])] = frame.values()(static_cast<Index>(k));
  return out;
}

VERNIER_API FrameParameters frame_from_json(const JsonNode& node) {
  Vector6 values;
  for (std::size_t k = 0; k < 6; ++k) values(static_cast<Index>(k)) = node.at(std::string(frame_keys[k])).number();
  return FrameParameters(values);
}

VERNIER_API OrderedJson coverage_to_json(const CoverageData& coverage) {
  OrderedJson out = OrderedJson::array();
  for (std::size_t i = 0; i < coverage.ranges.size(); ++i) {
    OrderedJson ranges = OrderedJson::array();
    for (const JointRange& range : coverage.ranges[i]) ranges.push_back({range.lower, range.upper});
    out.push_back({{"margin", coverage.margins(static_cast<Index>(i))},
                   {"periodic", static_cast<bool>(coverage.periodic[i])},
                   {"ranges", std::move(ranges)}});
  }
  return out;
}

VERNIER_API CoverageData coverage_from_json(const JsonNode& node, int joints) {
  node.require_size(static_cast<std::size_t>(joints));
  CoverageData out;
  out.margins.resize(joints);
  for (std::size_t i = 0; i < static_cast<std::size_t>(joints); ++i) {
    const JsonNode joint = node.at(i), ranges = joint.at("ranges");
    const double margin = joint.at("margin").number();
    if (!(margin > 0)) joint.at("margin").fail("must be positive");
    out.margins(static_cast<Index>(i)) = margin;
    if (ranges.size() == 0) ranges.fail("is empty");
    std::vector<JointRange> of_joint;
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const VectorX ends = ranges.at(k).numbers(2);
      if (!(ends(0) <= ends(1))) ranges.at(k).fail("its lower end is above its upper one");
      of_joint.push_back({ends(0), ends(1)});
    }
    out.ranges.push_back(std::move(of_joint));
    out.periodic.push_back(joint.has("periodic") && joint.at("periodic").boolean());
  }
  return out;
}

VERNIER_API OrderedJson joint_errors_to_json(const JointErrors& errors) {
  using Kind = JointTermBlock::Kind;
  const JointTerms& terms = errors.terms();
  OrderedJson out{{"coefficients", terms.size()}};  // so that a block that got lost is missed
  const bool transmissions = terms.size() > terms.num_dense_terms();
  OrderedJson joints = OrderedJson::array();
  for (const Fourier& fourier : terms.transmission)
    joints.push_back({{"orders", fourier.orders}, {"coefficients_rad", OrderedJson::array()}});
  for (const JointTermBlock& block : terms.blocks()) {
    OrderedJson values = list_of(errors.coefficients().segment(block.begin, block.count));
    switch (block.kind) {
      case Kind::gear_ratio: out["gear_ratio"] = std::move(values); break;
      case Kind::coupling: out["coupling"] = std::move(values); break;
      case Kind::gravity:
        out["gravity"] = {{"down", list_of(terms.gravity->down())}, {"products_rad_per_m", std::move(values)}};
        break;
      case Kind::hysteresis:
        out["hysteresis"] = {{"widths_rad", terms.hysteresis}, {"coefficients_rad", std::move(values)}};
        break;
      case Kind::tilt:
        out["tilt"] = {{"down", list_of(terms.tilt->down())}, {"coefficients_rad", std::move(values)}};
        break;
      case Kind::transmission: joints[static_cast<std::size_t>(block.joint)]["coefficients_rad"] = std::move(values);
    }
  }
  if (transmissions) out["transmission"] = std::move(joints);
  if (!terms.linear_ranges.empty()) {
    OrderedJson ranges = OrderedJson::array();
    for (const JointRange& range : terms.linear_ranges) ranges.push_back({range.lower, range.upper});
    out["linear_ranges"] = std::move(ranges);
  }
  return out;
}

VERNIER_API Vector3 direction_from_json(const JsonNode& node) {
  const Vector3 out = node.numbers(3);
  if (!(std::abs(out.norm() - 1) < 1e-6)) node.fail("must have length 1");
  return out;
}

/// A matrix, column by column.
VERNIER_API MatrixX matrix_from_json(const JsonNode& node, Index rows, Index columns) {
  const VectorX values = node.numbers(static_cast<std::size_t>(rows * columns));
  return Eigen::Map<const MatrixX>(values.data(), rows, columns);
}

/// @param nominal the chain whose torques gravity compliance needs, and whose frames tilt
VERNIER_API JointErrors joint_errors_from_json(const ChainTable& nominal, const JsonNode& node) {
  node.allow_only(
      {"coefficients", "gear_ratio", "coupling", "linear_ranges", "gravity", "hysteresis", "tilt", "transmission"});
  const auto joints = static_cast<std::size_t>(nominal.joints());
  JointTerms terms(nominal.joints());
  std::vector<VectorX> blocks;
  if ((terms.gear_ratio = node.has("gear_ratio"))) blocks.push_back(node.at("gear_ratio").numbers(joints));
  if ((terms.coupling = node.has("coupling"))) blocks.push_back(node.at("coupling").numbers(joints - 1));
  if (node.has("linear_ranges")) {
    node.at("linear_ranges").require_size(joints);
    for (std::size_t i = 0; i < joints; ++i) {
      const JsonNode range = node.at("linear_ranges").at(i);
      const VectorX ends = range.numbers(2);
      if (!(ends(0) <= ends(1))) range.fail("its lower end is above its upper one");
      terms.linear_ranges.push_back({ends(0), ends(1)});
    }
  }
  if (node.has("gravity")) {
    const JsonNode gravity = node.at("gravity");
    terms.gravity.emplace(nominal, direction_from_json(gravity.at("down")));
    blocks.push_back(gravity.at("products_rad_per_m").numbers(static_cast<std::size_t>(terms.gravity->size())));
  }
  if (node.has("hysteresis")) {
    const JsonNode hysteresis = node.at("hysteresis"), widths = hysteresis.at("widths_rad");
    for (std::size_t k = 0; k < widths.size(); ++k) {
      terms.hysteresis.push_back(widths.at(k).number());
      if (!(terms.hysteresis.back() > 0)) widths.at(k).fail("must be positive");
    }
    blocks.push_back(hysteresis.at("coefficients_rad").numbers(joints * terms.hysteresis.size()));
  }
  if (node.has("tilt")) {
    const JsonNode tilt = node.at("tilt");
    terms.tilt.emplace(nominal, direction_from_json(tilt.at("down")));
    blocks.push_back(tilt.at("coefficients_rad").numbers(static_cast<std::size_t>(terms.tilt->size())));
  }
  if (node.has("transmission")) {
    const JsonNode transmission = node.at("transmission");
    transmission.require_size(joints);
    for (std::size_t i = 0; i < joints; ++i) {
      const JsonNode joint = transmission.at(i);
      if (joint.has("centre_rad"))
        joint.fail("hidden nodes of a joint are no longer supported; calibrate again, with harmonics");
      if (joint.has("harmonics")) {
        terms.transmission[i] = Fourier::up_to(static_cast<int>(joint.at("harmonics").integer(0, 500)));
      } else {
        const JsonNode orders = joint.at("orders");
        for (std::size_t k = 0; k < orders.size(); ++k) {
          const int before = k == 0 ? 0 : terms.transmission[i].orders.back();
          terms.transmission[i].orders.push_back(static_cast<int>(orders.at(k).integer(before + 1, 5000)));
        }
      }
      blocks.push_back(joint.at("coefficients_rad").numbers(static_cast<std::size_t>(terms.transmission[i].size())));
    }
  }
  if (node.at("coefficients").integer(0, INT32_MAX) != terms.size())
    node.at("coefficients").fail(message("there are ", terms.size()));
  VectorX coefficients(terms.size());
  Index at = 0;
  for (const VectorX& block : blocks) {
    coefficients.segment(at, block.size()) = block;
    at += block.size();
  }
  return {std::move(terms), std::move(coefficients)};
}

VERNIER_API OrderedJson arm_to_json(const FittedArm& arm) {
  OrderedJson rows = OrderedJson::array();
  for (const DhRow& row : arm.geometry.chain().rows()) rows.push_back(row_to_json(row));
  return {{"rows", std::move(rows)},
          {"base", frame_to_json(arm.geometry.base())},
          {"tool", frame_to_json(arm.geometry.tool())},
          {"joint_errors", joint_errors_to_json(arm.errors)}};
}

VERNIER_API FittedArm arm_from_json(const ChainTable& nominal, const JsonNode& node) {
  std::vector<DhRow> rows = nominal.rows();
  node.at("rows").require_size(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = row_from_json(node.at("rows").at(i), rows[i].joint);
  return {ArmGeometry(ChainTable(std::move(rows), nominal.modified()), frame_from_json(node.at("base")),
                      frame_from_json(node.at("tool"))),
          joint_errors_from_json(nominal, node.at("joint_errors"))};
}

VERNIER_API OrderedJson learned_to_json(const LearnedData& learned) {
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

VERNIER_API FittedNetwork network_from_json(const JsonNode& node, int joints) {
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

VERNIER_API FittedKernels kernels_from_json(const JsonNode& node, int joints) {
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

VERNIER_API LearnedData learned_from_json(const JsonNode& node, int joints) {
  constexpr std::array<std::string_view, 2> kinds{"elm", "kernels"};
  const CoverageData coverage = coverage_from_json(node.at("coverage"), joints);
  if (named(node.at("kind"), kinds) == 0) return {network_from_json(node, joints), coverage};
  return {kernels_from_json(node, joints), coverage};
}

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
  require(std::isfinite(from.position_sigma), "save: position_sigma is not finite");
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
    require(std::isfinite(error), "save: ", key, " is not finite");
    if (error > 0) out["provenance"][key] = error;
  };
  add_known("left_out_error_m", from.left_out_error);
  add_known("held_out_error_m", from.held_out_error);
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

VERNIER_IMPL void write_model(const std::string& path, const ModelData& model) {
  std::string text;
  try {
    text = model_to_json(model).dump(1);
  } catch (const nlohmann::json::exception&) {  // a name that is not UTF-8
    throw std::invalid_argument("save: a name is not valid text");
  }
  write_file(path, text + "\n");
}

/// Checks version and convention, which every model file starts with.
/// @return whether it is a modified chain
VERNIER_API bool check_schema(const JsonNode& root) {
  if (!root.has("schema_version")) root.fail("key 'schema_version' is missing; is this a model that calibrate saved?");
  const auto version = root.at("schema_version").integer(0, INT32_MAX);
  if (version < oldest_schema_version || version > model_schema_version)
    root.at("schema_version")
        .fail(message("version ", version, " is unknown; this program reads versions ", oldest_schema_version, " to ",
                      model_schema_version));
  constexpr std::array<std::string_view, 2> conventions{"standard", "modified"};
  return root.has("convention") && named(root.at("convention"), conventions) == 1;
}

VERNIER_IMPL ModelData read_model(const std::string& path, int joints, bool modified) {
  const nlohmann::json document = read_json(path);
  const JsonNode root(document, path);
  if (check_schema(root) != modified)
    root.fail(modified ? "the chain is in the standard convention, a modified one was expected"
                       : "the chain is in the modified convention, a standard one was expected");
  const JsonNode list = root.at("joints");
  list.require_size(static_cast<std::size_t>(joints));
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
  Provenance provenance{any_text(from.at("data_file")),     static_cast<Index>(from.at("rows").integer(0, INT32_MAX)),
                        any_text(from.at("date")),          one_of("joints", joint_readings),
                        one_of("measured", measured_names), from.at("position_sigma_m").number(),
                        known("left_out_error_m"),          known("held_out_error_m")};
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

}  // namespace detail

VERNIER_IMPL SavedArm saved_arm(const std::string& path) {
  const nlohmann::json document = read_json(path);
  const JsonNode root(document, path);
  const bool modified = detail::check_schema(root);
  const JsonNode joints = root.at("joints");
  if (joints.size() < 1 || joints.size() > max_joints) joints.fail(message("has ", joints.size(), " joints"));
  return {static_cast<int>(joints.size()), modified};
}

}  // namespace vernier
