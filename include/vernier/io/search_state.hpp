// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Ongoing searches as JSON files, resumed in another process with the bits of an uninterrupted search.

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>

#include "vernier/io/json.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

namespace detail {

inline constexpr int search_schema = 1;

using RngWords = std::array<std::uint64_t, 4>;
static_assert(std::is_trivially_copyable_v<Rng> && sizeof(Rng) == sizeof(RngWords));

/// A number, exactly; values that are not finite, which JSON does not have, as texts.
template <class T>
nlohmann::ordered_json json_number(T value) {
  if constexpr (std::floating_point<T>) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  }
  return value;
}

/// Writes the members of a state.
template <ListedState S>
nlohmann::ordered_json state_to_json(const S& state) {
  nlohmann::ordered_json out;
  S::each_member(state, [&out](const char* name, const auto& member) {
    using T = std::remove_cvref_t<decltype(member)>;
    auto& json = out[name];
    if constexpr (ListedState<T>) {
      json = state_to_json(member);
    } else if constexpr (std::same_as<T, Rng>) {
      json = std::bit_cast<RngWords>(member);
    } else if constexpr (std::is_arithmetic_v<T>) {
      json = json_number(member);
    } else {
      json = {{"rows", member.rows()}, {"values", nlohmann::ordered_json::array()}};
      for (Index i = 0; i < member.size(); ++i) json["values"].push_back(json_number(member.data()[i]));
    }
  });
  return out;
}

/// Reads the members of a state and checks their types and sizes.
class StateReader {
 public:
  /// @param file its name in messages
  explicit StateReader(std::string file) : file_(std::move(file)) {}

  /// All members, no others, of sizes that agree.
  template <ListedState S>
  void read(const nlohmann::json& json, const std::string& place, S& state) const {
    if (!json.is_object()) fail(place, "must be an object");
    std::size_t members = 0;
    S::each_member(state, [&](const char* name, auto& member) {
      const std::string here = place + "." + name;
      if (!json.contains(name)) fail(here, "is missing");
      value(json.at(name), here, member);
      ++members;
    });
    if (json.size() != members) fail(place, "has members that are not of this search");
    if (!state.consistent()) fail(place, "has members of inconsistent sizes");
  }

  /// One member.
  template <class T>
  void value(const nlohmann::json& json, const std::string& place, T& out) const {
    if constexpr (ListedState<T>) {
      read(json, place, out);
    } else if constexpr (std::same_as<T, Rng>) {
      RngWords words{};
      if (!json.is_array() || json.size() != words.size()) fail(place, "must be a list of 4 whole numbers");
      for (std::size_t i = 0; i < words.size(); ++i) value(json[i], place, words[i]);
      if (words == RngWords{}) fail(place, "must not be all zero");
      out = std::bit_cast<Rng>(words);
    } else if constexpr (std::same_as<T, bool>) {
      if (!json.is_boolean()) fail(place, "must be true or false");
      out = json.get<bool>();
    } else if constexpr (std::floating_point<T>) {
      if (json == "nan" || json == "inf" || json == "-inf") {
        out = json == "nan"   ? std::numeric_limits<T>::quiet_NaN()
              : json == "inf" ? std::numeric_limits<T>::infinity()
                              : -std::numeric_limits<T>::infinity();
      } else if (json.is_number()) {
        out = json.get<T>();
      } else {
        fail(place, "must be a number");
      }
    } else if constexpr (std::integral<T>) {
      if (!json.is_number_integer()) fail(place, "must be a whole number");
      const bool fits = json.is_number_unsigned() ? std::in_range<T>(json.get<std::uint64_t>())
                                                  : std::in_range<T>(json.get<std::int64_t>());
      if (!fits) fail(place, "is too large or too small");
      out = json.get<T>();
    } else {
      matrix(json, place, out);
    }
  }

  /// Throws a DataError about a place in the file.
  [[noreturn]] void fail(const std::string& place, const char* what) const {
    throw DataError(file_ + ": " + place + ": " + what);
  }

 private:
  template <class Matrix>
  void matrix(const nlohmann::json& json, const std::string& place, Matrix& out) const {
    if (!json.is_object() || !json.contains("rows") || !json.contains("values") || !json.at("values").is_array())
      fail(place, "must have 'rows' and a list of 'values'");
    const auto& values = json.at("values");
    const auto size = static_cast<Index>(values.size());
    Index rows = 0;
    value(json.at("rows"), place + ".rows", rows);
    if (rows < 0 || (rows == 0 ? size != 0 : size % rows != 0))
      fail(place, "has a number of values that its rows do not divide");
    if constexpr (Matrix::ColsAtCompileTime == 1) {
      if (rows != size) fail(place, "must have one column");
    }
    out.resize(rows, Matrix::ColsAtCompileTime == 1 ? 1 : rows == 0 ? 0 : size / rows);
    for (Index i = 0; i < size; ++i) value(values[static_cast<std::size_t>(i)], place, out.data()[i]);
  }

  std::string file_;
};

}  // namespace detail

/// Writes a search to a file, atomically and every number exactly. An observer may call it.
/// @throws std::runtime_error where the file cannot be written
template <ListedState S>
void save_state(const std::string& path, const OngoingSearch<S>& search) {
  const nlohmann::ordered_json document{{"schema_version", detail::search_schema},
                                        {"evaluations", search.evaluations},
                                        {"improved_at", search.improved_at},
                                        {"state", detail::state_to_json(search.state)}};
  write_file(path, document.dump(1) + "\n");
}

/// Reads a search that `save_state` wrote: `load_state<Pso>(path)`. The caller keeps its algorithm, objective and box;
/// a state of another algorithm is refused where its members differ.
/// @throws DataError naming the file and the member
template <Metaheuristic A>
OngoingSearch<typename A::State> load_state(const std::string& path) {
  const nlohmann::json document = read_json(path);
  const detail::StateReader reader(path);
  const auto member = [&](const char* name, auto& out) {
    if (!document.is_object() || !document.contains(name)) reader.fail(name, "is missing");
    reader.value(document.at(name), name, out);
  };
  int schema = 0;
  member("schema_version", schema);
  if (schema != detail::search_schema) reader.fail("schema_version", "is not supported by this program");
  OngoingSearch<typename A::State> search;
  member("evaluations", search.evaluations);
  member("improved_at", search.improved_at);
  member("state", search.state);
  if (search.evaluations < 0 || search.state.generation < 0) reader.fail("state", "has negative counts");
  return search;
}

}  // namespace vernier
