// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/io/json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

namespace vernier {

namespace detail {

inline constexpr std::size_t largest_json = std::size_t{32} << 20;  // bytes

VERNIER_IMPL std::string read_json_text(const std::string& path) {
  try {
    return read_file(path, largest_json);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
}

}  // namespace detail

VERNIER_IMPL nlohmann::json read_json(const std::string& path) {
  return parse_json(detail::read_json_text(path), path);
}

VERNIER_IMPL nlohmann::json parse_json(std::string_view content, const std::string& file) {
  if (content.find_first_not_of(" \t\r\n") == std::string_view::npos) throw DataError(file + ": empty, not JSON");
  constexpr int deepest = 32;
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > deepest) throw DataError(message(file, ": nested deeper than ", deepest));
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw DataError(file + ": key '" + detail::quotable(parsed.get<std::string>()) + "' is given twice");
    return true;
  };
  try {
    return nlohmann::json::parse(content, watch);
  } catch (const nlohmann::json::parse_error& e) {
    const std::size_t at = (std::min)(e.byte > 0 ? e.byte - 1 : 0, content.size());
    const auto line = 1 + std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t start = at == 0 ? std::string_view::npos : content.rfind('\n', at - 1);
    const std::size_t column = start == std::string_view::npos ? at + 1 : at - start;
    throw DataError(message(file, ", line ", line, ", column ", column,
                            at == content.size() ? ": the file ends here, but its JSON does not" : ": not valid JSON"));
  } catch (const nlohmann::json::exception& e) {  // a number no double can hold
    const std::string_view what = e.what();
    throw DataError(file + ": " + detail::quotable(what.substr((std::min)(what.find("] ") + 2, what.size())), 100));
  }
}

VERNIER_IMPL JsonNode::JsonNode(const nlohmann::json& document, std::string file)
    : value_(&document), file_(std::move(file)) {}

VERNIER_IMPL JsonNode::JsonNode(const nlohmann::json& value, std::string file, std::string path)
    : value_(&value), file_(std::move(file)), path_(std::move(path)) {}

VERNIER_IMPL [[noreturn]] void JsonNode::fail(const std::string& what) const {
  throw DataError(file_ + ": " + (path_.empty() ? "" : path_ + ": ") + what);
}

VERNIER_IMPL bool JsonNode::has(const std::string& key) const { return object().contains(key); }

VERNIER_IMPL JsonNode JsonNode::at(const std::string& key) const {
  if (!has(key)) fail("key '" + key + "' is missing");
  return {(*value_)[key], file_, path_.empty() ? key : path_ + "." + key};
}

VERNIER_IMPL JsonNode JsonNode::at(std::size_t index) const {
  if (index >= size()) fail(message("has ", size(), " entries, entry ", index, " is missing"));
  return {(*value_)[index], file_, message(path_, "[", index, "]")};
}

VERNIER_IMPL std::size_t JsonNode::size() const {
  if (!value_->is_array()) fail(std::string("must be a list, is ") + type_name());
  return value_->size();
}

VERNIER_IMPL void JsonNode::require_size(std::size_t count) const {
  if (size() != count) fail(message("has ", size(), " entries, must have ", count));
}

VERNIER_IMPL double JsonNode::number() const {
  if (!value_->is_number()) fail(std::string("must be a number, is ") + type_name());
  const auto out = value_->get<double>();
  if (!(std::abs(out) <= 1e9)) fail(message(out, " is beyond any angle or length (1e9)"));
  return out;
}

VERNIER_IMPL bool JsonNode::boolean() const {
  if (!value_->is_boolean()) fail(std::string("must be true or false, is ") + type_name());
  return value_->get<bool>();
}

VERNIER_IMPL std::int64_t JsonNode::integer(std::int64_t lower, std::int64_t upper) const {
  if (!value_->is_number_integer()) fail(std::string("must be a whole number, is ") + type_name());
  const bool huge = value_->is_number_unsigned() && value_->get<std::uint64_t>() > INT64_MAX;
  const auto out = huge ? INT64_MAX : value_->get<std::int64_t>();
  if (out < lower || out > upper) fail(message("must lie in ", lower, "..", upper));
  return out;
}

VERNIER_IMPL std::string JsonNode::text(std::size_t most) const {
  if (!value_->is_string()) fail(std::string("must be a text, is ") + type_name());
  auto out = value_->get<std::string>();
  if (out.empty() || out.size() > most) fail(message("must have 1 to ", most, " characters, has ", out.size()));
  if (std::any_of(out.begin(), out.end(), [](unsigned char c) { return c < 32 || c == 127; }))
    fail("has a character that cannot be printed");
  return out;
}

VERNIER_IMPL bool JsonNode::is_empty_text() const {
  return value_->is_string() && value_->get_ref<const std::string&>().empty();
}

VERNIER_IMPL VectorX JsonNode::numbers(std::size_t count) const {
  require_size(count);
  VectorX out(static_cast<Index>(count));
  for (std::size_t i = 0; i < count; ++i) out(static_cast<Index>(i)) = at(i).number();
  return out;
}

VERNIER_IMPL double JsonNode::length(const std::string& stem) const { return with_unit(stem, "_mm", "_m", 1, 1000); }

VERNIER_IMPL double JsonNode::angle(const std::string& stem) const {
  return with_unit(stem, "_deg", "_rad", std::numbers::pi_v<long double>, 180);
}

VERNIER_IMPL bool JsonNode::has_quantity(const std::string& stem) const {
  return has(stem + "_mm") || has(stem + "_m") || has(stem + "_deg") || has(stem + "_rad");
}

VERNIER_IMPL void JsonNode::allow_only(std::initializer_list<std::string_view> keys) const {
  allow_only(std::span(keys.begin(), keys.size()));
}

VERNIER_IMPL void JsonNode::allow_only(std::span<const std::string_view> keys) const {
  for (const auto& [key, ignored] : object().items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) fail("key '" + detail::quotable(key) + "' is unknown");
}

VERNIER_IMPL const nlohmann::json& JsonNode::object() const {
  if (!value_->is_object()) fail(std::string("must be an object, is ") + type_name());
  return *value_;
}

VERNIER_IMPL std::string JsonNode::type_name() const {
  return value_->is_null()             ? "null"
         : value_->is_boolean()        ? "true or false"
         : value_->is_string()         ? "a text"
         : value_->is_array()          ? "a list"
         : value_->is_object()         ? "an object"
         : value_->is_number_integer() ? "a whole number"
                                       : "a number";
}

VERNIER_IMPL double JsonNode::with_unit(const std::string& stem, const char* outer, const char* inner,
                                        long double factor, long double divisor) const {
  const bool first = has(stem + outer), second = has(stem + inner);
  if (first && second) fail("keys '" + stem + outer + "' and '" + stem + inner + "' both give " + stem);
  if (second) return at(stem + inner).number();
  // through long double, as the literals do: a table read from a file equals one that is compiled
  return static_cast<double>(static_cast<long double>(at(stem + outer).number()) * factor / divisor);
}

}  // namespace vernier
