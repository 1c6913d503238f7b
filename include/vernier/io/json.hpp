// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Strict reading of JSON files: every error is one line with the file and the place in it.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/detail/quotable.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

namespace detail {

/// The text of a JSON file.
/// @throws DataError naming the file, also where it has more than 32 MiB
VERNIER_API std::string read_json_text(const std::string& path);

}  // namespace detail

/// A JSON text; callers include <nlohmann/json.hpp>.
/// @param content the text
/// @param file    its name in messages
/// @throws DataError naming the file, and where it is not JSON the line and column; also for a duplicate key or for
/// nesting deeper than 32
VERNIER_API nlohmann::json parse_json(std::string_view content, const std::string& file);

/// The content of a JSON file; callers include <nlohmann/json.hpp>.
/// @throws DataError as `parse_json`, and for a file of more than 32 MiB
VERNIER_API nlohmann::json read_json(const std::string& path);

/// A value in a JSON file with its path, so that every error names file and key. Refers to a document that outlives it.
class JsonNode {
 public:
  /// @param document the whole file's value
  /// @param file     its name in messages
  VERNIER_API JsonNode(const nlohmann::json& document, std::string file);

  /// Throws a DataError about this value.
  VERNIER_API [[noreturn]] void fail(const std::string& what) const;

  /// Whether there is a member of that name.
  VERNIER_API bool has(const std::string& key) const;

  /// A member that must be present.
  VERNIER_API JsonNode at(const std::string& key) const;

  /// An element of a list.
  VERNIER_API JsonNode at(std::size_t index) const;

  /// Number of elements of a list.
  VERNIER_API std::size_t size() const;

  /// Requires a list of exactly `count` elements.
  VERNIER_API void require_size(std::size_t count) const;

  /// A finite number, at most 1e9 in magnitude.
  VERNIER_API double number() const;

  /// True or false.
  VERNIER_API bool boolean() const;

  /// A whole number in [lower, upper].
  VERNIER_API std::int64_t integer(std::int64_t lower, std::int64_t upper) const;

  /// A text of 1 to `most` printable characters.
  VERNIER_API std::string text(std::size_t most = 1000) const;

  /// Whether it is an empty text.
  VERNIER_API bool is_empty_text() const;

  /// The numbers of a list of exactly `count` elements.
  VERNIER_API VectorX numbers(std::size_t count) const;

  /// A length in m, from the member `stem` + `_mm` or `_m`.
  VERNIER_API double length(const std::string& stem) const;

  /// An angle in rad, from the member `stem` + `_deg` or `_rad`.
  VERNIER_API double angle(const std::string& stem) const;

  /// Whether an object has any member called `stem` + a unit of lengths or angles.
  VERNIER_API bool has_quantity(const std::string& stem) const;

  /// Refuses members of an object that are not in the list, so that a misspelt key is not ignored.
  VERNIER_API void allow_only(std::span<const std::string_view> keys) const;
  /// Likewise of a list in braces.
  VERNIER_API void allow_only(std::initializer_list<std::string_view> keys) const;

 private:
  VERNIER_API JsonNode(const nlohmann::json& value, std::string file, std::string path);
  VERNIER_API const nlohmann::json& object() const;
  VERNIER_API std::string type_name() const;
  /// The member with the outer unit, times factor / divisor, or the one with the inner unit.
  VERNIER_API double with_unit(const std::string& stem, const char* outer, const char* inner, long double factor,
                               long double divisor) const;

  const nlohmann::json* value_;
  std::string file_, path_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/json.ipp"
#endif
