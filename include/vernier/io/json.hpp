#pragma once

/// @file
/// JSON files read with care: whatever is wrong with one is a single line that names the file and the place.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/atomic_file.hpp"
#include "vernier/data/csv.hpp"

namespace vernier {

namespace detail {

/// Text from a file as it may stand in a message: short, printable, on one line.
inline std::string quotable(std::string_view text, std::size_t limit = 60) {
  std::string out;
  for (const char c : text.substr(0, limit)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > limit ? "..." : "");
}

}  // namespace detail

/// The content of a JSON file.
/// @throws DataError naming the file, and where it is not JSON the line and column; also for a key given twice or for
/// nesting deeper than 32
inline nlohmann::json read_json(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::string content;
  try {
    content = read_file(path);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
  if (content.find_first_not_of(" \t\r\n") == std::string::npos) throw DataError(file + ": empty, not JSON");
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
    const std::size_t at = std::min(e.byte > 0 ? e.byte - 1 : 0, content.size());
    const auto line = 1 + std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t start = at == 0 ? std::string::npos : content.rfind('\n', at - 1);
    const std::size_t column = start == std::string::npos ? at + 1 : at - start;
    throw DataError(message(file, ", line ", line, ", column ", column,
                            at == content.size() ? ": the file ends here, but its JSON does not" : ": not valid JSON"));
  } catch (const nlohmann::json::exception& e) {  // a number no double can hold
    const std::string_view what = e.what();
    throw DataError(file + ": " + detail::quotable(what.substr(std::min(what.find("] ") + 2, what.size())), 100));
  }
}

/// A value in a JSON file that knows where it stands, so that every complaint names file and key. Refers to a document
/// that outlives it.
class JsonNode {
 public:
  /// @param document the whole file's value, @param file its name in messages
  JsonNode(const nlohmann::json& document, std::string file) : value_(&document), file_(std::move(file)) {}

  /// Throws a DataError about this value.
  [[noreturn]] void fail(const std::string& what) const {
    throw DataError(file_ + ": " + (path_.empty() ? "" : path_ + ": ") + what);
  }

  /// Whether there is an entry of that name.
  bool has(const std::string& key) const { return object().contains(key); }

  /// A member that must be there.
  JsonNode at(const std::string& key) const {
    if (!has(key)) fail("key '" + key + "' is missing");
    return {(*value_)[key], file_, path_.empty() ? key : path_ + "." + key};
  }

  /// An element of an array.
  JsonNode at(std::size_t index) const {
    if (index >= size()) fail(message("has ", size(), " entries, entry ", index, " is missing"));
    return {(*value_)[index], file_, message(path_, "[", index, "]")};
  }

  /// Number of entries of an array.
  std::size_t size() const {
    if (!value_->is_array()) fail(std::string("must be a list, is ") + kind());
    return value_->size();
  }

  /// A list of exactly `count` entries.
  void require_size(std::size_t count) const {
    if (size() != count) fail(message("has ", size(), " entries, must have ", count));
  }

  /// A finite number of at most 1e9 in size.
  double number() const {
    if (!value_->is_number()) fail(std::string("must be a number, is ") + kind());
    const auto out = value_->get<double>();
    if (!(std::abs(out) <= 1e9)) fail(message(out, " is beyond any angle or length (1e9)"));
    return out;
  }

  /// A whole number in [lower, upper].
  std::int64_t integer(std::int64_t lower, std::int64_t upper) const {
    if (!value_->is_number_integer()) fail(std::string("must be a whole number, is ") + kind());
    const bool huge = value_->is_number_unsigned() && value_->get<std::uint64_t>() > INT64_MAX;
    const auto out = huge ? INT64_MAX : value_->get<std::int64_t>();
    if (out < lower || out > upper) fail(message("must lie in ", lower, "..", upper));
    return out;
  }

  /// A text of 1 to 1000 printable characters.
  std::string text() const {
    if (!value_->is_string()) fail(std::string("must be a text, is ") + kind());
    auto out = value_->get<std::string>();
    if (out.empty() || out.size() > 1000) fail(message("must have 1 to 1000 characters, has ", out.size()));
    if (std::any_of(out.begin(), out.end(), [](unsigned char c) { return c < 32 || c == 127; }))
      fail("has a character that cannot be printed");
    return out;
  }

  /// Whether it is a text of no characters.
  bool is_empty_text() const { return value_->is_string() && value_->get_ref<const std::string&>().empty(); }

  /// Numbers of a list, exactly `count`.
  VectorX numbers(std::size_t count) const {
    require_size(count);
    VectorX out(static_cast<Index>(count));
    for (std::size_t i = 0; i < count; ++i) out(static_cast<Index>(i)) = at(i).number();
    return out;
  }

  /// A length in m, from the member `stem` + `_mm` or `_m`.
  double length(const std::string& stem) const {
    return with_unit(stem, "_mm", "_m",
                     [](double v) { return static_cast<double>(static_cast<long double>(v) / 1000.0L); });
  }

  /// An angle in rad, from the member `stem` + `_deg` or `_rad`.
  double angle(const std::string& stem) const {
    return with_unit(stem, "_deg", "_rad", [](double v) {
      // through long double, as the literals do: a table read from a file equals one that is compiled
      return static_cast<double>(static_cast<long double>(v) * std::numbers::pi_v<long double> / 180.0L);
    });
  }

  /// Whether an object has any member called `stem` + a unit of lengths or angles.
  bool has_quantity(const std::string& stem) const {
    return has(stem + "_mm") || has(stem + "_m") || has(stem + "_deg") || has(stem + "_rad");
  }

  /// Refuses members of an object that are not in the list: a misspelt key must not pass as one left out.
  void allow_only(std::initializer_list<std::string_view> keys) const {
    for (const auto& [key, ignored] : object().items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        fail("key '" + detail::quotable(key) + "' is unknown");
  }

 private:
  JsonNode(const nlohmann::json& value, std::string file, std::string path)
      : value_(&value), file_(std::move(file)), path_(std::move(path)) {}

  const nlohmann::json& object() const {
    if (!value_->is_object()) fail(std::string("must be an object, is ") + kind());
    return *value_;
  }

  std::string kind() const {
    return value_->is_null()             ? "null"
           : value_->is_boolean()        ? "true or false"
           : value_->is_string()         ? "a text"
           : value_->is_array()          ? "a list"
           : value_->is_object()         ? "an object"
           : value_->is_number_integer() ? "a whole number"
                                         : "a number";
  }

  template <class Convert>
  double with_unit(const std::string& stem, const char* edge, const char* inner, Convert&& convert) const {
    const bool first = has(stem + edge), second = has(stem + inner);
    if (first && second) fail("keys '" + stem + edge + "' and '" + stem + inner + "' both give " + stem);
    return second ? at(stem + inner).number() : convert(at(stem + edge).number());
  }

  const nlohmann::json* value_;
  std::string file_, path_;
};

}  // namespace vernier
