// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/urdf/camera_yaml.hpp"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/io/json.hpp"

namespace vernier {

namespace detail {

/// Throws a DataError that names file and line.
template <class... Parts>
[[noreturn]] void fail_in_camera(const std::string& file, const YAML::Node& node, const Parts&... parts) {
  const int line = node.IsDefined() ? node.Mark().line + 1 : 0;
  throw DataError(line > 0 ? message(file, ", line ", line, ": ", parts...) : message(file, ": ", parts...));
}

VERNIER_LOCAL double camera_number(const std::string& file, const YAML::Node& node, const std::string& key) {
  if (!node.IsScalar()) fail_in_camera(file, node, "'", key, "' must be a number");
  const std::string& word = node.Scalar();
  const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  const bool whole = end == word.data() + word.size() || std::string_view(end) == ".";  // OpenCV writes "0."
  if (error != std::errc{} || !whole || !std::isfinite(value) || std::abs(value) > 1e9)
    fail_in_camera(file, node, "'", key, "': '", quotable(word), "' is not a number");
  return value;
}

/// The numbers of a matrix: its `data`, or a plain list.
VERNIER_LOCAL VectorX camera_numbers(const std::string& file, const YAML::Node& node, const std::string& key) {
  const YAML::Node list = node.IsMap() ? node["data"] : node;
  if (!list.IsDefined() || !list.IsSequence() || list.size() > 100)
    fail_in_camera(file, node, "'", key, "' must have a list 'data' of numbers");
  VectorX out(static_cast<Index>(list.size()));
  for (std::size_t k = 0; k < list.size(); ++k) out(static_cast<Index>(k)) = camera_number(file, list[k], key);
  return out;
}

}  // namespace detail

VERNIER_IMPL Camera read_camera_yaml(const std::string& path) {
  std::string content;
  try {
    content = read_file(path, std::size_t{1} << 16u);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
  if (content.starts_with("%YAML")) content.replace(0, 1, "#");  // OpenCV's first line is no directive of YAML
  Camera out;
  try {
    const YAML::Node file = YAML::Load(content);
    if (!file.IsMap()) throw DataError(path + ": not a map of keys");
    const YAML::Node model = file["distortion_model"];
    if (model.IsDefined() && (!model.IsScalar() || model.Scalar() != "plumb_bob"))
      detail::fail_in_camera(path, model, "distortion_model is '",
                             model.IsScalar() ? detail::quotable(model.Scalar()) : std::string("no text"),
                             "'; the one that is known is plumb_bob");
    const YAML::Node matrix = file["camera_matrix"];
    if (!matrix.IsDefined()) throw DataError(path + ": key 'camera_matrix' is missing");
    const VectorX k = detail::camera_numbers(path, matrix, "camera_matrix");
    if (k.size() != 9) detail::fail_in_camera(path, matrix, "'camera_matrix' has ", k.size(), " numbers, must have 9");
    for (const Index zero : {1, 3, 6, 7})
      if (!same_value(k(zero), 0))
        detail::fail_in_camera(path, matrix, "'camera_matrix' has ", k(zero), " where a camera without skew has 0");
    if (!same_value(k(8), 1)) detail::fail_in_camera(path, matrix, "'camera_matrix' ends in ", k(8), ", must be 1");
    VectorX values = VectorX::Zero(Camera::num_parameters);
    values(0) = k(0);
    values(1) = k(4);
    values(2) = k(2);
    values(3) = k(5);
    const YAML::Node coefficients = file["distortion_coefficients"];
    if (!coefficients.IsDefined()) throw DataError(path + ": key 'distortion_coefficients' is missing");
    const VectorX d = detail::camera_numbers(path, coefficients, "distortion_coefficients");
    for (Index i = 0; i < d.size(); ++i) {
      if (i < 5)
        values(4 + i) = d(i);
      else if (!same_value(d(i), 0))
        detail::fail_in_camera(path, coefficients, "'distortion_coefficients' has ", d.size(),
                               " numbers, of another model than k1, k2, p1, p2, k3");
    }
    out = Camera{}.with_parameters(values);
    const auto size = [&](const char* key) {
      const YAML::Node node = file[key];
      if (!node.IsDefined()) return Index{0};
      const double value = detail::camera_number(path, node, key);
      if (!(value >= 1 && value <= 1e5) || !same_value(value, std::floor(value)))
        detail::fail_in_camera(path, node, "'", key, "' is ", value, ", must be a whole number of pixels");
      return static_cast<Index>(value);
    };
    out.width = size("image_width");
    out.height = size("image_height");
  } catch (const YAML::Exception& e) {
    throw DataError(message(path, ", line ", e.mark.line + 1, ": not valid YAML (", detail::quotable(e.msg), ")"));
  }
  try {
    out.validate();
  } catch (const DataError&) {
    throw;
  } catch (const std::invalid_argument& e) {
    throw DataError(path + ": " + e.what());
  }
  return out;
}

}  // namespace vernier
