// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

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

VERNIER_LOCAL OrderedJson payload_to_json(const JointErrors& errors, OrderedJson compliances) {
  const PayloadCompliance& payload = *errors.terms().payload;
  OrderedJson out{{"down", list_of(payload.down())},
                  {"reference_kg", payload.reference().mass},
                  {"reference_centre_m", list_of(payload.reference().centre)},
                  {"compliances_rad_per_nm", std::move(compliances)}};
  if (const PayloadLoad& load = errors.load(); !same_value(load.weight, 0) || load.moment.norm() > 0) {
    out["weight_n"] = load.weight;  // beyond the reference
    out["moment_nm"] = list_of(load.moment);
  }
  return out;
}

VERNIER_LOCAL OrderedJson joint_errors_to_json(const JointErrors& errors) {
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
      case Kind::payload: out["payload"] = payload_to_json(errors, std::move(values)); break;
      case Kind::hysteresis:
        out["hysteresis"] = {{"widths_rad", terms.hysteresis}, {"coefficients_rad", std::move(values)}};
        break;
      case Kind::tilt:
        out["tilt"] = {{"down", list_of(terms.tilt->down())}, {"coefficients_rad", std::move(values)}};
        break;
      case Kind::straightness: {
        OrderedJson ranges = OrderedJson::array();
        for (const int p : terms.straightness->guides()) {
          const JointRange& range = terms.straightness->ranges()[static_cast<std::size_t>(p)];
          ranges.push_back({range.lower, range.upper});
        }
        out["straightness"] = {{"ranges_m", std::move(ranges)},
                               {"orders", terms.straightness->orders()},
                               {"coefficients", std::move(values)}};
        break;
      }
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

VERNIER_LOCAL Vector3 direction_from_json(const JsonNode& node) {
  const Vector3 out = node.numbers(3);
  if (!(std::abs(out.norm() - 1) < 1e-6)) node.fail("must have length 1");
  return out;
}

/// @param nominal the chain whose torques gravity compliance needs, and whose frames tilt
VERNIER_LOCAL JointErrors joint_errors_from_json(const ChainTable& nominal, const JsonNode& node) {
  node.allow_only({"coefficients", "gear_ratio", "coupling", "linear_ranges", "gravity", "payload", "hysteresis",
                   "tilt", "straightness", "transmission"});
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
  PayloadLoad load;
  if (node.has("payload")) {
    const JsonNode payload = node.at("payload");
    const double mass = payload.at("reference_kg").number();
    if (!(mass >= 0)) payload.at("reference_kg").fail("must be 0 or more");
    terms.payload.emplace(nominal, direction_from_json(payload.at("down")),
                          Payload{mass, Vector3(payload.at("reference_centre_m").numbers(3))});
    blocks.push_back(payload.at("compliances_rad_per_nm").numbers(joints));
    if (payload.has("weight_n")) load = {payload.at("weight_n").number(), Vector3(payload.at("moment_nm").numbers(3))};
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
  if (node.has("straightness")) {
    const JsonNode straight = node.at("straightness"), ranges = straight.at("ranges_m");
    std::vector<JointRange> of_joints(joints);
    std::size_t guides = 0;
    for (std::size_t j = 0; j < joints; ++j) {
      if (nominal.revolute(static_cast<int>(j))) continue;
      const VectorX ends = ranges.at(guides++).numbers(2);
      if (!(ends(0) < ends(1))) ranges.fail("a range is empty");
      of_joints[j] = {ends(0), ends(1)};
    }
    ranges.require_size(guides);
    terms.straightness.emplace(nominal, std::move(of_joints), static_cast<int>(straight.at("orders").integer(1, 100)));
    blocks.push_back(straight.at("coefficients").numbers(static_cast<std::size_t>(terms.straightness->size())));
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
