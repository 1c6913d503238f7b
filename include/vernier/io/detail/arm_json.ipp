// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/io/detail/arm_json.hpp"

namespace vernier::detail {

inline constexpr std::array<std::string_view, 6> frame_keys{"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"};

VERNIER_IMPL OrderedJson list_of(const ConstVectorRef& values) {
  demand(all_finite(values), "save: a value is not finite");
  OrderedJson out = OrderedJson::array();
  for (Index i = 0; i < values.size(); ++i) out.push_back(values(i));
  return out;
}

VERNIER_IMPL OrderedJson row_to_json(const DhRow& row) {
  for (const double value : {row.a, row.alpha, row.d, row.theta, row.beta})
    demand(std::isfinite(value), "save: a parameter of the chain is not finite");
  return {{"a_m", row.a}, {"alpha_rad", row.alpha}, {"d_m", row.d}, {"theta_rad", row.theta}, {"beta_rad", row.beta}};
}

VERNIER_IMPL DhRow row_from_json(const JsonNode& node, JointType type) {
  return {node.at("a_m").number(),       node.at("alpha_rad").number(), node.at("d_m").number(),
          node.at("theta_rad").number(), node.at("beta_rad").number(),  type};
}

VERNIER_LOCAL OrderedJson frame_to_json(const FrameParameters& frame) {
  demand(all_finite(frame.values()), "save: a frame is not finite");
  OrderedJson out;
  for (std::size_t k = 0; k < 6; ++k) out[std::string(frame_keys[k])] = frame.values()(static_cast<Index>(k));
  return out;
}

VERNIER_LOCAL FrameParameters frame_from_json(const JsonNode& node) {
  Vector6 values;
  for (std::size_t k = 0; k < 6; ++k) values(static_cast<Index>(k)) = node.at(std::string(frame_keys[k])).number();
  return FrameParameters(values);
}

VERNIER_IMPL OrderedJson coverage_to_json(const CoverageData& coverage) {
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

VERNIER_IMPL CoverageData coverage_from_json(const JsonNode& node, int joints) {
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

/// A block of joint errors, with the keys of its row.
VERNIER_LOCAL OrderedJson block_to_json(const JointErrors& errors, const JointTermBlock& block) {
  const JointTermTraits& row = traits_of(block.kind);
  OrderedJson coefficients = list_of(errors.coefficients().segment(block.begin, block.count));
  if (!row.has_parameters()) return coefficients;
  const std::vector<double> values = errors.terms().parameters(block.kind);
  OrderedJson out;
  std::size_t at = 0;
  for (const JointTermTraits::Parameter& parameter : row.parameters) {
    if (parameter.key == nullptr) break;
    const std::size_t end = parameter.count > 0 ? at + static_cast<std::size_t>(parameter.count) : values.size();
    if (parameter.count == 1)
      out[parameter.key] = values[at];
    else
      out[parameter.key] = std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(at),
                                               values.begin() + static_cast<std::ptrdiff_t>(end));
    at = end;
  }
  out[row.coefficients] = std::move(coefficients);
  const PayloadLoad& load = errors.load();
  if (block.kind == JointTermBlock::Kind::payload && (!same_value(load.weight, 0) || load.moment.norm() > 0)) {
    out["weight_n"] = load.weight;  // beyond the reference
    out["moment_nm"] = list_of(load.moment);
  }
  return out;
}

/// The parameters of a block by the keys of its row.
VERNIER_LOCAL std::vector<double> parameters_from_json(const JointTermTraits& row, const JsonNode& block) {
  std::vector<double> out;
  for (const JointTermTraits::Parameter& parameter : row.parameters) {
    if (parameter.key == nullptr) break;
    const JsonNode node = block.at(parameter.key);
    if (parameter.count == 1) {
      out.push_back(node.number());
      continue;
    }
    if (parameter.count > 0) node.require_size(static_cast<std::size_t>(parameter.count));
    for (std::size_t k = 0; k < node.size(); ++k) out.push_back(node.at(k).number());
  }
  return out;
}

VERNIER_LOCAL OrderedJson joint_errors_to_json(const JointErrors& errors) {
  const JointTerms& terms = errors.terms();
  OrderedJson out{{"coefficients", terms.size()}};  // so that a block that got lost is missed
  const bool transmissions = terms.size() > terms.num_dense_terms();
  OrderedJson joints = OrderedJson::array();
  for (const Fourier& fourier : terms.transmission)
    joints.push_back({{"orders", fourier.orders}, {"coefficients_rad", OrderedJson::array()}});
  for (const JointTermBlock& block : terms.blocks()) {
    const JointTermTraits& row = traits_of(block.kind);
    if (block.joint >= 0)
      joints[static_cast<std::size_t>(block.joint)][row.coefficients] =
          list_of(errors.coefficients().segment(block.begin, block.count));
    else
      out[row.key] = block_to_json(errors, block);
  }
  if (transmissions) out["transmission"] = std::move(joints);
  if (!terms.linear_ranges.empty()) {
    OrderedJson ranges = OrderedJson::array();
    for (const JointRange& range : terms.linear_ranges) ranges.push_back({range.lower, range.upper});
    out["linear_ranges"] = std::move(ranges);
  }
  return out;
}

/// @param nominal the chain whose torques gravity compliance needs, and whose frames tilt
VERNIER_LOCAL JointErrors joint_errors_from_json(const ChainTable& nominal, const JsonNode& node) {
  std::vector<std::string_view> keys{"coefficients", "linear_ranges"};
  for (const JointTermTraits& row : joint_term_rows) keys.emplace_back(row.key);
  node.allow_only(keys);
  const auto joints = static_cast<std::size_t>(nominal.joints());
  JointTerms terms(nominal.joints());
  std::vector<VectorX> blocks;
  for (const JointTermTraits& row : joint_term_rows) {
    if (row.kind == JointTermBlock::Kind::transmission || !node.has(row.key)) continue;
    const JsonNode block = node.at(row.key);
    const Index before = terms.size();
    const std::vector<double> parameters = parameters_from_json(row, block);
    try {
      terms.add(row.kind, nominal, parameters);
    } catch (const std::invalid_argument& fault) {
      block.at(row.parameters[0].key).fail(fault.what());
    }
    const JsonNode coefficients = row.has_parameters() ? block.at(row.coefficients) : block;
    blocks.push_back(coefficients.numbers(static_cast<std::size_t>(terms.size() - before)));
  }
  PayloadLoad load;
  if (node.has("payload") && node.at("payload").has("weight_n"))
    load = {node.at("payload").at("weight_n").number(), Vector3(node.at("payload").at("moment_nm").numbers(3))};
  if (node.has("linear_ranges")) {
    node.at("linear_ranges").require_size(joints);
    for (std::size_t i = 0; i < joints; ++i) {
      const JsonNode range = node.at("linear_ranges").at(i);
      const VectorX ends = range.numbers(2);
      if (!(ends(0) <= ends(1))) range.fail("its lower end is above its upper one");
      terms.linear_ranges.push_back({ends(0), ends(1)});
    }
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
  return JointErrors(std::move(terms), std::move(coefficients)).under(load);
}

VERNIER_IMPL OrderedJson arm_to_json(const FittedArm& arm) {
  OrderedJson rows = OrderedJson::array();
  for (const DhRow& row : arm.geometry.chain().rows()) rows.push_back(row_to_json(row));
  return {{"rows", std::move(rows)},
          {"base", frame_to_json(arm.geometry.base())},
          {"tool", frame_to_json(arm.geometry.tool())},
          {"joint_errors", joint_errors_to_json(arm.errors)}};
}

VERNIER_IMPL FittedArm arm_from_json(const ChainTable& nominal, const JsonNode& node) {
  std::vector<DhRow> rows = nominal.rows();
  node.at("rows").require_size(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = row_from_json(node.at("rows").at(i), rows[i].joint);
  return {ArmGeometry(ChainTable(std::move(rows), nominal.modified()), frame_from_json(node.at("base")),
                      frame_from_json(node.at("tool"))),
          joint_errors_from_json(nominal, node.at("joint_errors"))};
}

}  // namespace vernier::detail
