// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/io/camera_files.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "vernier/core/data_error.hpp"
#include "vernier/io/json.hpp"

namespace vernier {

VERNIER_IMPL Board read_board(const std::string& path) {
  const nlohmann::json document = read_json(path);
  const JsonNode file(document, path);
  file.allow_only({"rows", "columns", "square_mm", "square_m", "marker_mm", "marker_m", "dictionary", "legacy_pattern",
                   "measured_mm", "measured_m", "measured_squares", "sigma_mm", "sigma_m"});
  Board out;
  out.rows = file.at("rows").integer(3, 1000);
  out.columns = file.at("columns").integer(3, 1000);
  out.square = file.length("square");
  if (!(out.square > 0)) file.fail("square_mm must be positive");
  if (file.has_quantity("marker")) out.marker = file.length("marker");
  if (file.has("dictionary")) out.dictionary = file.at("dictionary").text(40);
  if (file.has("legacy_pattern")) out.legacy_pattern = file.at("legacy_pattern").boolean();
  if (out.dictionary.empty() != !(out.marker > 0)) file.fail("marker_mm and dictionary belong together");
  if (file.has_quantity("measured")) {
    const Index squares = file.has("measured_squares")
                              ? file.at("measured_squares").integer(1, (std::max)(out.rows, out.columns))
                              : (std::max)(out.rows, out.columns);
    const double measured = file.length("measured"), sigma = file.length("sigma");
    const double square = measured / static_cast<double>(squares);
    if (!(std::abs(square / out.square - 1) < 0.03))
      file.fail(message("measured_mm is ", measured * 1e3, " over ", squares, " squares, so a square has ",
                        square * 1e3, " mm, but square_mm is ", out.square * 1e3, "; state measured_squares"));
    if (!(sigma > 0)) file.fail("sigma_mm must be positive");
    if (out.marker > 0) out.marker *= square / out.square;
    out.square = square;
    out.scale_sigma = sigma / measured;
  } else {
    for (const char* of_measured : {"measured_squares", "sigma_mm", "sigma_m"})
      if (file.has(of_measured)) file.fail(message(of_measured, " belongs to measured_mm, which is missing"));
  }
  try {
    out.validate();
  } catch (const std::invalid_argument& e) {
    file.fail(e.what());
  }
  return out;
}

VERNIER_IMPL Camera read_camera_json(const std::string& path) {
  const nlohmann::json document = read_json(path);
  const JsonNode file(document, path);
  file.allow_only({"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "width", "height"});
  VectorX values = VectorX::Zero(Camera::num_parameters);
  for (Index k = 0; k < values.size(); ++k) {
    const char* name = Camera::names[static_cast<std::size_t>(k)];
    if (k < 4 || file.has(name)) values(k) = file.at(name).number();
  }
  Camera out = Camera{}.with_parameters(values);
  if (file.has("width")) out.width = file.at("width").integer(1, 100000);
  if (file.has("height")) out.height = file.at("height").integer(1, 100000);
  try {
    out.validate();
  } catch (const std::invalid_argument& e) {
    file.fail(e.what());
  }
  return out;
}

VERNIER_IMPL nlohmann::ordered_json camera_to_json(const Camera& camera) {
  nlohmann::ordered_json out;
  const VectorX values = camera.parameters();
  for (Index k = 0; k < values.size(); ++k) out[Camera::names[static_cast<std::size_t>(k)]] = values(k);
  if (camera.width > 0) out["width"] = camera.width;
  if (camera.height > 0) out["height"] = camera.height;
  return out;
}

VERNIER_IMPL nlohmann::ordered_json board_to_json(const Board& board) {
  nlohmann::ordered_json out{{"rows", board.rows}, {"columns", board.columns}, {"square_mm", board.square * 1e3}};
  if (board.marker > 0) {
    out["marker_mm"] = board.marker * 1e3;
    out["dictionary"] = board.dictionary;
    if (board.legacy_pattern) out["legacy_pattern"] = true;
  }
  const auto squares = (std::max)(board.rows, board.columns);
  const double side = static_cast<double>(squares) * board.square * 1e3;
  out["measured_mm"] = side;
  out["measured_squares"] = squares;
  out["sigma_mm"] = side * board.scale_sigma;
  return out;
}

}  // namespace vernier
