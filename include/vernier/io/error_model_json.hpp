#pragma once

/// @file
/// Arms with joint errors, and measured joint ranges, as JSON; lengths in m, angles in rad, as the keys say.

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vernier/identification/error_model.hpp"
#include "vernier/io/json.hpp"

namespace vernier::detail {

inline constexpr std::array<std::string_view, 6> frame_keys{"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"};

template <class Derived>
nlohmann::ordered_json list_of(const Eigen::MatrixBase<Derived>& values) {
  require(values.allFinite(), "save_calibrated_robot: a value is not finite");
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (Index i = 0; i < values.size(); ++i) out.push_back(values(i));
  return out;
}

inline nlohmann::ordered_json row_to_json(const DhRow& row) {
  for (const double value : {row.a, row.alpha, row.d, row.theta, row.beta})
    require(std::isfinite(value), "save_calibrated_robot: a parameter of the chain is not finite");
  return {{"a_m", row.a}, {"alpha_rad", row.alpha}, {"d_m", row.d}, {"theta_rad", row.theta}, {"beta_rad", row.beta}};
}

inline DhRow row_from_json(const JsonNode& node, JointType type) {
  return {node.at("a_m").number(),       node.at("alpha_rad").number(), node.at("d_m").number(),
          node.at("theta_rad").number(), node.at("beta_rad").number(),  type};
}

inline nlohmann::ordered_json frame_to_json(const Vector6& values) {
  require(values.allFinite(), "save_calibrated_robot: a frame is not finite");
  nlohmann::ordered_json out;
  for (std::size_t k = 0; k < 6; ++k) out[std::string(frame_keys[k])] = values(static_cast<Index>(k));
  return out;
}

inline FrameParameters frame_from_json(const JsonNode& node) {
  Vector6 values;
  for (std::size_t k = 0; k < 6; ++k) values(static_cast<Index>(k)) = node.at(std::string(frame_keys[k])).number();
  return FrameParameters(values);
}

template <int N>
nlohmann::ordered_json coverage_to_json(const JointCoverage<N>& coverage) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (int i = 0; i < N; ++i) {
    nlohmann::ordered_json ranges = nlohmann::ordered_json::array();
    for (const auto& range : coverage.ranges[static_cast<std::size_t>(i)]) ranges.push_back({range.lower, range.upper});
    out.push_back({{"margin", coverage.margin(i)}, {"ranges", std::move(ranges)}});
  }
  return out;
}

template <int N>
JointCoverage<N> coverage_from_json(const JsonNode& node) {
  node.require_size(N);
  JointCoverage<N> out;
  for (std::size_t i = 0; i < N; ++i) {
    const JsonNode joint = node.at(i), ranges = joint.at("ranges");
    const double margin = joint.at("margin").number();
    if (!(margin > 0)) joint.at("margin").fail("must be positive");
    out.margin(static_cast<Index>(i)) = margin;
    if (ranges.size() == 0) ranges.fail("is empty");
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const VectorX ends = ranges.at(k).numbers(2);
      if (!(ends(0) <= ends(1))) ranges.at(k).fail("its ends are upside down");
      out.ranges[i].push_back({ends(0), ends(1)});
    }
  }
  return out;
}

template <class Chain>
nlohmann::ordered_json joint_errors_to_json(const JointErrors<Chain>& errors) {
  constexpr int N = Chain::dof;
  const JointTerms<Chain>& terms = errors.terms();
  Index at = 0;
  const auto take = [&](Index count) {
    return list_of(errors.coefficients().segment(std::exchange(at, at + count), count));
  };
  nlohmann::ordered_json out{{"coefficients", terms.size()}};  // so that a block that got lost is missed
  if (terms.gear_ratio) out["gear_ratio"] = take(N);
  if (terms.coupling) out["coupling"] = take(N - 1);
  if (terms.gravity)
    out["gravity"] = {{"down", list_of(terms.gravity->down())},
                      {"products_rad_per_m", take(GravityCompliance<Chain>::size)}};
  if (terms.size() == terms.few()) return out;
  nlohmann::ordered_json& transmission = out["transmission"] = nlohmann::ordered_json::array();
  for (const AngleBasis& basis : terms.transmission) {
    nlohmann::ordered_json joint = nlohmann::ordered_json::object();
    if (const auto* nodes = std::get_if<JointNodes>(&basis)) {
      joint["centre_rad"] = list_of(nodes->centre);
      joint["slope_per_rad"] = list_of(nodes->slope);
    } else {
      joint["harmonics"] = std::get<Fourier>(basis).harmonics;
    }
    joint["coefficients_rad"] = take(size_of(basis));
    transmission.push_back(std::move(joint));
  }
  return out;
}

/// @param nominal the chain whose torques gravity compliance needs
template <class Chain>
JointErrors<Chain> joint_errors_from_json(const Chain& nominal, const JsonNode& node) {
  constexpr std::size_t N = Chain::dof;
  node.allow_only({"coefficients", "gear_ratio", "coupling", "gravity", "transmission"});
  JointTerms<Chain> terms;
  std::vector<VectorX> blocks;
  if ((terms.gear_ratio = node.has("gear_ratio"))) blocks.push_back(node.at("gear_ratio").numbers(N));
  if ((terms.coupling = node.has("coupling"))) blocks.push_back(node.at("coupling").numbers(N - 1));
  if (node.has("gravity")) {
    const JsonNode gravity = node.at("gravity");
    const Vector3 down = gravity.at("down").numbers(3);
    if (!(std::abs(down.norm() - 1) < 1e-6)) gravity.at("down").fail("must have length 1");
    terms.gravity.emplace(nominal, down);
    blocks.push_back(gravity.at("products_rad_per_m").numbers(GravityCompliance<Chain>::size));
  }
  if (node.has("transmission")) {
    const JsonNode transmission = node.at("transmission");
    transmission.require_size(N);
    for (std::size_t i = 0; i < N; ++i) {
      const JsonNode joint = transmission.at(i);
      if (joint.has("harmonics")) {
        terms.transmission[i] = Fourier{static_cast<int>(joint.at("harmonics").integer(0, 500))};
      } else {
        const std::size_t count = joint.at("centre_rad").size();
        terms.transmission[i] =
            JointNodes{joint.at("centre_rad").numbers(count), joint.at("slope_per_rad").numbers(count)};
      }
      blocks.push_back(joint.at("coefficients_rad").numbers(static_cast<std::size_t>(size_of(terms.transmission[i]))));
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

/// Chain, frames and joint errors of an arm; the chain's rows are of the given types.
template <class Chain>
nlohmann::ordered_json arm_to_json(const Framed<WithJointErrors<Chain>>& arm) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const DhRow& row : arm.model().chain().rows()) rows.push_back(row_to_json(row));
  return {{"rows", std::move(rows)},
          {"base", frame_to_json(arm.base_values())},
          {"tool", frame_to_json(arm.tool_values())},
          {"joint_errors", joint_errors_to_json(arm.model().joint_errors())}};
}

template <class Chain>
Framed<WithJointErrors<Chain>> arm_from_json(const Chain& nominal, const JsonNode& node) {
  auto rows = nominal.rows();
  node.at("rows").require_size(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = row_from_json(node.at("rows").at(i), rows[i].joint);
  return Framed<WithJointErrors<Chain>>(
      WithJointErrors<Chain>(Chain::from_rows(rows), joint_errors_from_json(nominal, node.at("joint_errors"))),
      frame_from_json(node.at("base")), frame_from_json(node.at("tool")));
}

}  // namespace vernier::detail
