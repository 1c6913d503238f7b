// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/io/detail/c_code.hpp"
#include "vernier/io/detail/c_tables.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string c_number(double value) {
  demand(std::isfinite(value), "c_source: a value of the model is ", value);
  return significant_digits(value, 17);
}

VERNIER_IMPL std::string c_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool printable = c >= ' ' && c <= '~';
    const bool harmless = printable && c != '"' && c != '\\' && c != '*' && c != '$' &&
                          c != '?';  // ? begins trigraphs, $ is no character of C99
    out += harmless ? c : '_';
  }
  return out;
}

template <class T, class Write>
std::string written_table(const char* type, const std::string& name, std::span<const T> values, std::size_t per_line,
                          const Write& write) {
  std::string out = message("static const ", type, " ", name, "[", values.size(), "] = {\n    ");
  for (std::size_t i = 0; i < values.size(); ++i) {
    out += write(values[i]);
    if (i + 1 < values.size()) out += (i + 1) % per_line == 0 ? ",\n    " : ", ";
  }
  return out + "};\n";
}

VERNIER_IMPL std::string c_table(const std::string& name, std::span<const double> values, std::size_t per_line) {
  return written_table("double", name, values, per_line, [](double value) { return c_number(value); });
}

VERNIER_IMPL std::string c_table(const std::string& name, std::span<const int> values) {
  return written_table("int", name, values, 20, [](int value) { return std::to_string(value); });
}

VERNIER_IMPL std::string c_chain_table(const std::string& name, const ChainTable& chain) {
  const ChainView view = chain.view();
  std::vector<double> values;
  for (int i = 0; i < view.joints; ++i) {
    const DhRow& row = view.rows[i];
    values.insert(values.end(), {row.theta, row.d, row.a, view.twist[i].sin, view.twist[i].cos, view.hayati[i].sin,
                                 view.hayati[i].cos});
  }
  return c_table(name, values, 7);
}

VERNIER_IMPL std::string c_kinds(const std::string& capitals) {
  std::string out = "/* Kinds of joint errors. */\nenum { ";
  for (const JointTermTraits& row : joint_term_rows)
    if (row.kind != JointTermBlock::Kind::transmission) out += message(capitals, "_", c_capitals(row.key), "_, ");
  return out + capitals + "_KINDS_ };\n";
}

VERNIER_IMPL std::string c_arm_tables(const std::string& type, const std::string& name, const FittedArm& arm,
                                      int lanes) {
  const int joints = arm.geometry.joints();
  std::string out;
  const auto table = [&](const char* what, const std::vector<double>& values, std::size_t per_line) {
    if (values.empty()) return std::string("0");
    const std::string full = name + what;
    out += c_table(full, values, per_line);
    return full;
  };
  const auto frame = [&](const char* what, const FrameParameters& of) {
    const Isometry3& isometry = of.isometry();
    std::vector<double> values;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) values.push_back(isometry.matrix()(i, k));
    return table(what, values, 3);
  };
  out += c_chain_table(name + "rows_", arm.geometry.chain());
  const std::string rows = name + "rows_", base = frame("base_", arm.geometry.base()),
                    tool = frame("tool_", arm.geometry.tool());

  const JointTerms& terms = arm.errors.terms();
  std::vector<int> orders;
  for (const Fourier& of_joint : terms.transmission)
    orders.insert(orders.end(), of_joint.orders.begin(), of_joint.orders.end());
  std::sort(orders.begin(), orders.end());
  orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
  std::vector<double> harmonics(orders.size() * 2 * static_cast<std::size_t>(lanes)), ranges;
  const auto n = static_cast<std::size_t>(joints);
  std::array<std::string, joint_term_rows.size()> of_kinds;
  of_kinds.fill("{0, 0, 0}");
  for (const JointTermBlock& block : terms.blocks()) {
    const double* first = arm.errors.coefficients().data() + block.begin;
    const std::vector<double> values(first, first + block.count);
    if (block.joint < 0) {
      const std::string key = traits_of(block.kind).key;
      std::vector<double> parameters = terms.parameters(block.kind);
      if (block.kind == JointTermBlock::Kind::payload || block.kind == JointTermBlock::Kind::bend) {
        const PayloadLoad& load = arm.errors.load();
        parameters.insert(parameters.end(), {load.weight, load.moment(0), load.moment(1), load.moment(2)});
      }
      const std::string coefficients = table((key + "_").c_str(), values, n);
      of_kinds[static_cast<std::size_t>(block.kind)] = message(
          "{", coefficients, ", ", table((key + "_parameters_").c_str(), parameters, 3), ", ", parameters.size(), "}");
      continue;
    }
    const std::vector<int>& of_joint = terms.transmission[static_cast<std::size_t>(block.joint)].orders;
    for (std::size_t k = 0; k < of_joint.size(); ++k) {
      const auto row = std::lower_bound(orders.begin(), orders.end(), of_joint[k]) - orders.begin();
      double* to = harmonics.data() + 2 * lanes * row + block.joint;
      to[0] = values[2 * k];
      to[lanes] = values[2 * k + 1];
    }
  }
  if (terms.gear_ratio || terms.coupling)
    for (const JointRange& range : terms.linear_ranges) ranges.insert(ranges.end(), {range.lower, range.upper});

  std::string fields = message("{", rows, ", ", base, ", ", tool, ", {");
  for (const JointTermTraits& row : joint_term_rows)
    if (row.kind != JointTermBlock::Kind::transmission)
      fields += (fields.back() == '{' ? "" : ", ") + of_kinds[static_cast<std::size_t>(row.kind)];
  fields += "}, " + table("linear_ranges_", ranges, 2);
  fields += ", " + table("harmonics_", harmonics, static_cast<std::size_t>(lanes));
  if (orders.empty()) {
    fields += ", 0, 0}";
  } else {
    out += c_table(name + "order_", orders);
    fields += message(", ", name, "order_, ", orders.size(), "}");
  }
  return out + message("static const ", type, " ", name, " = ", fields, ";\n");
}

VERNIER_IMPL std::string c_coverage_tables(const std::string& type, const std::string& name,
                                           const CoverageData& coverage) {
  std::vector<int> periodic, count;
  std::vector<double> ranges;
  for (std::size_t i = 0; i < coverage.ranges.size(); ++i) {
    periodic.push_back(coverage.periodic[i] ? 1 : 0);
    count.push_back(static_cast<int>(coverage.ranges[i].size()));
    for (const JointRange& range : coverage.ranges[i]) ranges.insert(ranges.end(), {range.lower, range.upper});
  }
  if (ranges.empty()) ranges = {0, 0};  // never read; C has no empty arrays
  const std::vector<double> margins(coverage.margins.begin(), coverage.margins.end());
  return c_table(name + "margin_", margins, margins.size()) + c_table(name + "periodic_", periodic) +
         c_table(name + "count_", count) + c_table(name + "ranges_", ranges, 2) +
         message("static const ", type, " ", name, " = {", name, "margin_, ", name, "periodic_, ", name, "count_, ",
                 name, "ranges_};\n");
}

VERNIER_IMPL std::string c_network_tables(const std::string& prefix, const FittedNetwork& network) {
  const auto list = [](const auto& values) { return std::vector<double>(values.begin(), values.end()); };
  const Index nodes = network.layer.nodes, features = network.scaling.offset.size();
  std::vector<double> all;
  for (Index k = 0; k < nodes; ++k) {
    for (Index j = 0; j <= features; ++j) all.push_back(network.theta(k * (features + 1) + j));
    for (Index o = 0; o < 3; ++o) all.push_back(network.beta(k, o));
  }
  return c_table(prefix + "feature_offset_", list(network.scaling.offset), 6) +
         c_table(prefix + "feature_factor_", list(network.scaling.factor), 6) +
         c_table(prefix + "output_offset_", list(network.offset), 3) +
         c_table(prefix + "nodes_", all, static_cast<std::size_t>(features + 4));
}

}  // namespace vernier::detail
