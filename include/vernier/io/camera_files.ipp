// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/io/camera_files.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "vernier/core/data_error.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/io/json.hpp"

namespace vernier {

namespace detail {

VERNIER_LOCAL Board board_from_json(const JsonNode& file) {
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

VERNIER_LOCAL Camera camera_from_json(const JsonNode& file) {
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

}  // namespace detail

VERNIER_IMPL Board read_board(const std::string& path) {
  const nlohmann::json document = read_json(path);
  return detail::board_from_json(JsonNode(document, path));
}

VERNIER_IMPL Camera read_camera_json(const std::string& path) {
  const nlohmann::json document = read_json(path);
  return detail::camera_from_json(JsonNode(document, path));
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

namespace detail {

/// Poses by name: position [m], rotation vector [rad].
VERNIER_LOCAL nlohmann::ordered_json named_poses(const std::vector<std::string>& names,
                                                 const std::vector<Isometry3>& poses) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Vector3 at = translation(poses[k]), turn = log_so3(rotation(poses[k]));
    out.push_back({{"name", names[k]},
                   {"position_m", {at(0), at(1), at(2)}},
                   {"rotation_vector_rad", {turn(0), turn(1), turn(2)}}});
  }
  return out;
}

/// The reverse.
VERNIER_LOCAL std::vector<Isometry3> poses_of(const JsonNode& list, std::vector<std::string>& names) {
  std::vector<Isometry3> out;
  names.clear();
  for (std::size_t k = 0; k < list.size(); ++k) {
    const JsonNode node = list.at(k);
    names.push_back(node.at("name").text());
    const VectorX at = node.at("position_m").numbers(3), turn = node.at("rotation_vector_rad").numbers(3);
    out.push_back(rigid_motion(exp_so3(Vector3(turn(0), turn(1), turn(2))), Vector3(at(0), at(1), at(2))));
  }
  return out;
}

VERNIER_IMPL nlohmann::ordered_json setup_to_json(const CameraSetup& setup) {
  const auto& standing = setup.on_flange ? setup.board_names : setup.camera_names;
  const auto& carried = setup.on_flange ? setup.camera_names : setup.board_names;
  nlohmann::ordered_json out{{"mount", setup.on_flange ? "flange" : "fixed"}, {"board", board_to_json(setup.board)}};
  for (const Camera& camera : setup.cameras) out["intrinsics"].push_back(camera_to_json(camera));
  for (const MatrixX& covariance : setup.covariances) {
    nlohmann::ordered_json triangle = nlohmann::ordered_json::array();
    for (Index r = 0; r < covariance.rows(); ++r)
      for (Index c = r; c < covariance.cols(); ++c) triangle.push_back(covariance(r, c));
    out["intrinsics_covariance"].push_back(std::move(triangle));
  }
  out["in_base"] = named_poses(standing, setup.in_base);
  out["in_flange"] = named_poses(carried, setup.in_flange);
  return out;
}

VERNIER_IMPL CameraSetup setup_from_json(const JsonNode& node) {
  node.allow_only({"mount", "board", "intrinsics", "intrinsics_covariance", "in_base", "in_flange"});
  CameraSetup out;
  const std::string mount = node.at("mount").text();
  if (mount != "flange" && mount != "fixed") node.at("mount").fail("must be flange or fixed");
  out.on_flange = mount == "flange";
  out.board = board_from_json(node.at("board"));
  const JsonNode cameras = node.at("intrinsics");
  for (std::size_t k = 0; k < cameras.size(); ++k) out.cameras.push_back(camera_from_json(cameras.at(k)));
  if (node.has("intrinsics_covariance")) {
    const JsonNode covariances = node.at("intrinsics_covariance");
    constexpr Index n = Camera::num_parameters;
    if (covariances.size() != out.cameras.size()) covariances.fail("as many covariances as intrinsics are needed");
    for (std::size_t k = 0; k < covariances.size(); ++k) {
      const VectorX triangle = covariances.at(k).numbers(static_cast<std::size_t>(n * (n + 1) / 2));
      MatrixX& one = out.covariances.emplace_back(n, n);
      Index at = 0;
      for (Index r = 0; r < n; ++r)
        for (Index c = r; c < n; ++c) one(r, c) = one(c, r) = triangle(at++);
      for (Index r = 0; r < n; ++r)
        if (!(one(r, r) >= 0)) covariances.at(k).fail("a variance must not be negative");
    }
  }
  out.in_base = poses_of(node.at("in_base"), out.on_flange ? out.board_names : out.camera_names);
  out.in_flange = poses_of(node.at("in_flange"), out.on_flange ? out.camera_names : out.board_names);
  if (out.cameras.size() != out.camera_names.size()) node.fail("as many intrinsics as cameras are needed");
  return out;
}

}  // namespace detail

}  // namespace vernier
