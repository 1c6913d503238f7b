// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Tables of an exported arm as C source.

#include <span>
#include <string>
#include <string_view>

#include "vernier/io/model_file.hpp"

namespace vernier::detail {

/// A number with 17 significant digits, which is the same double again.
/// @throws std::invalid_argument on one that is not finite
VERNIER_API std::string c_number(double value);

/// A text for a comment or a string: printable ASCII that ends neither.
VERNIER_API std::string c_text(std::string_view text);

/// `static const double name[n] = {...};`, some numbers a line.
VERNIER_API std::string c_table(const std::string& name, std::span<const double> values, std::size_t per_line);
/// `static const int name[n] = {...};`.
VERNIER_API std::string c_table(const std::string& name, std::span<const int> values);

/// Of each joint: theta, d, a, sin and cos of alpha, sin and cos of beta.
VERNIER_API std::string c_chain_table(const std::string& name, const ChainTable& chain);

/// The kinds of joint errors with a column a coefficient, as an enumeration `CAPITALS_KEY_, ..., CAPITALS_KINDS_`.
VERNIER_API std::string c_kinds(const std::string& capitals);

/// All tables of an arm, and a struct `name` of type `type` that points to them.
/// @param lanes numbers of an order of the harmonics, at least one a joint
VERNIER_API std::string c_arm_tables(const std::string& type, const std::string& name, const FittedArm& arm, int lanes);

/// The tables of a gate, and a struct `name` of type `type` that points to them.
VERNIER_API std::string c_coverage_tables(const std::string& type, const std::string& name,
                                          const CoverageData& coverage);

/// The tables of a network: `prefix` feature_offset_, feature_factor_, output_offset_, nodes_.
VERNIER_API std::string c_network_tables(const std::string& prefix, const FittedNetwork& network);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_tables.ipp"
#endif
