// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>

#include "vernier/core/detail/dense.hpp"
#include "vernier/io/detail/estimate_json.hpp"

namespace vernier::detail {

inline constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

VERNIER_IMPL std::string base64_of(const std::vector<float>& values) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * values.size() + 2);
  for (const float value : values)
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(value) >> shift));
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  bytes.resize(bytes.size() + padding, 0);
  std::string out;
  out.reserve(bytes.size() / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::uint32_t three = std::uint32_t{bytes[k]} << 16 | std::uint32_t{bytes[k + 1]} << 8 | bytes[k + 2];
    for (int shift = 18; shift >= 0; shift -= 6) out += base64_digits[three >> shift & 63];
  }
  std::fill(out.end() - static_cast<std::ptrdiff_t>(padding), out.end(), '=');
  return out;
}

VERNIER_IMPL std::vector<float> floats_of(const std::string& base64) {
  std::vector<std::uint8_t> bytes;
  const std::size_t end = (std::min)(base64.find('='), base64.size());
  if (base64.size() % 4 != 0 || base64.size() - end > 2) return {};
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t k = 0; k < end; ++k) {
    const std::size_t digit = base64_digits.find(base64[k]);
    if (digit == std::string_view::npos) return {};
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  if (bytes.size() % 4 != 0) return {};
  std::vector<float> out(bytes.size() / 4);
  for (std::size_t k = 0; k < out.size(); ++k) {
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < 4; ++b) value |= std::uint32_t{bytes[4 * k + b]} << 8 * b;
    out[k] = std::bit_cast<float>(value);
  }
  return out;
}

/// Unknowns by their order, those of geometry and few terms first.
VERNIER_LOCAL std::vector<Index> unknowns_by_order(const ArmParameterisation& arm) {
  const auto geometric = static_cast<Index>(arm.geometric().size());
  std::vector<int> orders(static_cast<std::size_t>(arm.size()), 0);
  for (const JointTermBlock& block : arm.terms().blocks())
    for (Index k = 0; block.joint >= 0 && k < block.count; ++k)
      orders[static_cast<std::size_t>(geometric + block.begin + k)] =
          arm.terms().transmission[static_cast<std::size_t>(block.joint)].order(k);
  std::vector<Index> out(orders.size());
  std::iota(out.begin(), out.end(), Index{0});
  std::sort(out.begin(), out.end(), [&](Index a, Index b) {
    return std::pair(orders[static_cast<std::size_t>(a)], a) < std::pair(orders[static_cast<std::size_t>(b)], b);
  });
  return out;
}

VERNIER_IMPL nlohmann::ordered_json estimate_to_json(const ErrorModelEstimate& estimate) {
  using Json = nlohmann::ordered_json;
  constexpr Index most = 1700;
  const auto list = [](const VectorX& values) {
    demand(all_finite(values), "save: a value of the estimate is not finite");
    return Json(std::vector<double>(values.begin(), values.end()));
  };
  const ArmParameterisation& arm = estimate.arm;
  const std::vector<std::string> names = arm.geometry(0).parameter_names();
  Json geometric = Json::array();
  for (const GeometricUnknown& u : arm.geometric()) {
    Json one{{"parameter", names[static_cast<std::size_t>(u.parameter)]},
             {"scale", u.scale},
             {"prior_std", u.precision > 0 ? 1 / std::sqrt(u.precision) : 0}};
    if (u.thermal) one["per_kelvin"] = true;
    geometric.push_back(std::move(one));
  }
  VectorX stds = diagonal_of(estimate.covariance);
  for (double& std : stds) std = std::sqrt((std::max)(0.0, std));
  const std::vector<Index> order = unknowns_by_order(arm);
  const Index kept = (std::min)(most, arm.size());
  MatrixX correlation = MatrixX::Zero(kept, kept);
  for (Index j = 0; j < kept; ++j)
    for (Index i = j; i < kept; ++i) {
      const Index a = order[static_cast<std::size_t>(i)], b = order[static_cast<std::size_t>(j)];
      if (stds(a) > 0 && stds(b) > 0) correlation(i, j) = estimate.covariance(a, b) / (stds(a) * stds(b));
    }
  correlation.diagonal().setConstant(1 + 1e-9);  // what single precision would round away
  demand(cholesky(correlation), "save: the covariance of the estimate is not positive definite");
  std::vector<float> factor;
  factor.reserve(static_cast<std::size_t>(kept * (kept + 1) / 2));
  for (Index i = 0; i < kept; ++i)
    for (Index j = 0; j <= i; ++j) factor.push_back(static_cast<float>(correlation(i, j)));
  const VectorX scales = arm.scales(), precisions = arm.precisions();
  const Index terms = arm.terms().size();
  VectorX prior_stds = VectorX::Zero(terms);  // in scales; 0 for none
  for (Index k = 0; k < terms; ++k)
    if (const double precision = precisions(precisions.size() - terms + k); precision > 0)
      prior_stds(k) = 1 / std::sqrt(precision);
  return {{"position_sigma_m", estimate.position_sigma},
          {"joint_sigma_rad", estimate.joint_sigma},
          {"orientation_sigma_rad", estimate.orientation_sigma},
          {"fallback_error_m", estimate.fallback_error},
          {"mean_temperature_c", estimate.mean_temperature},
          {"temperature_std_k", estimate.temperature_std},
          {"variance_factor", estimate.variance_factor},
          {"residual_variance", estimate.residual_variance},
          {"geometric", std::move(geometric)},
          {"coefficient_scales", list(scales.tail(terms))},
          {"coefficient_prior_stds", list(prior_stds)},
          {"stds_in_scales", list(stds)},
          {"correlated", kept},
          {"correlation_factor", base64_of(factor)}};
}

VERNIER_IMPL ErrorModelEstimate estimate_from_json(const JsonNode& node, const FittedArm& arm,
                                                   const ThermalRates* thermal) {
  const auto not_negative = [&](const char* key) {
    const double value = node.at(key).number();
    if (value < 0) node.at(key).fail("must not be negative");
    return value;
  };
  const auto positive = [](const JsonNode& value) {
    if (!(value.number() > 0)) value.fail("must be positive");
    return value.number();
  };
  const auto precision_of = [](const JsonNode& prior_std) {
    const double std = prior_std.number();
    if (std < 0) prior_std.fail("must not be negative");
    return std > 0 ? 1 / (std * std) : 0;
  };
  const std::vector<std::string> names = arm.geometry.parameter_names();
  std::vector<GeometricUnknown> unknowns;
  const JsonNode geometric = node.at("geometric");
  if (geometric.size() > 2 * names.size())  // itself and its rate a kelvin
    geometric.fail(message("has ", geometric.size(), " entries, the arm has ", names.size(), " parameters"));
  for (std::size_t k = 0; k < geometric.size(); ++k) {
    const JsonNode one = geometric.at(k);
    const auto name = std::find(names.begin(), names.end(), one.at("parameter").text());
    if (name == names.end()) one.at("parameter").fail("is no parameter of the arm");
    unknowns.push_back({static_cast<Index>(name - names.begin()), -1, positive(one.at("scale")),
                        precision_of(one.at("prior_std")), one.has("per_kelvin")});
  }
  const Index terms = arm.errors.terms().size(), size = static_cast<Index>(unknowns.size()) + terms;
  constexpr Index most = 10000;  // whose covariance takes 800 MB; nine joints up to order 500 have fewer
  if (size > most) node.fail(message("has ", size, " unknowns, more than ", most));
  const VectorX scales = node.at("coefficient_scales").numbers(static_cast<std::size_t>(terms));
  const JsonNode prior_stds = node.at("coefficient_prior_stds");
  prior_stds.require_size(static_cast<std::size_t>(terms));
  VectorX precisions(terms);
  for (Index k = 0; k < terms; ++k) precisions(k) = precision_of(prior_stds.at(static_cast<std::size_t>(k)));
  const VectorX stds = node.at("stds_in_scales").numbers(static_cast<std::size_t>(size));
  if (terms > 0 && scales.minCoeff() <= 0) node.at("coefficient_scales").fail("must be positive");
  if (size > 0 && stds.minCoeff() < 0) node.at("stds_in_scales").fail("must not be negative");
  const Index kept = static_cast<Index>(node.at("correlated").integer(0, size));
  const JsonNode base64 = node.at("correlation_factor");
  const bool none = kept == 0 && base64.is_empty_text();
  const std::vector<float> factor = none ? std::vector<float>() : floats_of(base64.text(16'000'000));
  if (static_cast<Index>(factor.size()) != kept * (kept + 1) / 2 ||
      !std::all_of(factor.begin(), factor.end(), [](float value) { return std::isfinite(value); }))
    node.at("correlation_factor").fail(message("is not the base64 of ", kept * (kept + 1) / 2, " finite numbers"));

  ErrorModelEstimate out{.arm = parameterised(arm, std::move(unknowns), scales, precisions,
                                              thermal != nullptr ? thermal->parameters : VectorX())};
  MatrixX upper = MatrixX::Zero(kept, kept);
  std::size_t at = 0;
  for (Index i = 0; i < kept; ++i)
    for (Index j = 0; j <= i; ++j) upper(j, i) = static_cast<double>(factor[at++]);
  const MatrixX correlation = transposed_matrix_product(upper, upper);
  const std::vector<Index> order = unknowns_by_order(out.arm);
  out.covariance.setZero(size, size);
  for (Index k = 0; k < size; ++k) out.covariance(k, k) = stds(k) * stds(k);
  for (Index j = 0; j < kept; ++j)
    for (Index i = 0; i < kept; ++i) {
      const Index a = order[static_cast<std::size_t>(i)], b = order[static_cast<std::size_t>(j)];
      if (a != b) out.covariance(a, b) = correlation(i, j) * stds(a) * stds(b);
    }
  out.converged = true;
  out.position_sigma = not_negative("position_sigma_m");
  out.joint_sigma = not_negative("joint_sigma_rad");
  out.orientation_sigma = not_negative("orientation_sigma_rad");
  out.fallback_error = not_negative("fallback_error_m");
  out.mean_temperature = node.at("mean_temperature_c").number();
  out.temperature_std = not_negative("temperature_std_k");
  out.variance_factor = positive(node.at("variance_factor"));
  out.residual_variance = positive(node.at("residual_variance"));
  return out;
}

}  // namespace vernier::detail
