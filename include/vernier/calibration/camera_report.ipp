// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/calibration/camera_report.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/so3.hpp"

namespace vernier {

namespace detail {

/// A pose in words.
VERNIER_LOCAL std::string frame_in_words(const std::string& name, const Isometry3& pose, const Vector6& std) {
  const Vector3 turn = log_so3(rotation(pose));
  std::string out = "  " + name + ": (";
  for (Index k = 0; k < 3; ++k) out += (k > 0 ? ", " : "") + fixed_digits(pose(k, 3) * 1e3, 2);
  out += ") mm, rotation vector (";
  for (Index k = 0; k < 3; ++k) out += (k > 0 ? ", " : "") + fixed_digits(turn(k), 5);
  out += ") rad; standard deviations up to ";
  out += fixed_digits(1e3 * (std::max)({std(0), std(1), std(2)}), 3) + " mm and ";
  return out + fixed_digits(1e3 * (std::max)({std(3), std(4), std(5)}), 3) + " mrad\n";
}

}  // namespace detail

VERNIER_IMPL std::string CameraReport::summary() const {
  using detail::fixed_digits;
  Index corners = 0;
  for (const ImageError& image : images) corners += image.corners;
  std::string out = message(images.size(), " images, ", corners, " corners, camera ",
                            mount == CameraMount::flange ? "on the flange" : "standing still", "\n");
  const auto names_of = [&](const char* what, const std::vector<std::string>& names) {
    if (names.empty()) return;
    out += message(what, ": ");
    for (std::size_t k = 0; k < names.size() && k < 10; ++k) out += (k > 0 ? ", " : "") + names[k];
    out += names.size() > 10 ? message(", and ", names.size() - 10, " more\n") : "\n";
  };
  names_of("Images without a row of the arm, not used", without_row);
  names_of("Rows without an image, not used", without_corners);
  out += "\nMean distance on the board: " + fixed_digits(mean * 1e3, 3) + " mm in the fit";
  if (left_out_mean > 0)
    out += ", " + fixed_digits(left_out_mean * 1e3, 3) + " mm at left-out images (largest " +
           fixed_digits(left_out_max * 1e3, 2) + " mm)" + (choices_repeated ? ", all decisions made without them" : "");
  out += "\n";
  out += "Corners scatter by " + fixed_digits(pixel_sigma, 3) + " px within an image";
  if (pose_excess > 1.2)
    out += "; images scatter more, by errors of the arm, and standard deviations follow the images";
  out += "\n";
  if (ambiguous > 0)
    out += message(counted(ambiguous, "view", "views"),
                   " fitted a wrong pose of the board better; the arm's poses told\n");
  if (downweighted > 0) out += message(counted(downweighted, "corner counts", "corners count"), " less than half\n");
  out += "\n" + std::string(mount == CameraMount::flange ? "Board in the arm's base frame\n"
                                                         : "Camera in the arm's base frame\n");
  const auto& standing = mount == CameraMount::flange ? board_names : camera_names;
  const auto& carried = mount == CameraMount::flange ? camera_names : board_names;
  for (std::size_t k = 0; k < in_base.size(); ++k)
    out += detail::frame_in_words(standing[k], in_base[k], in_base_std[k]);
  out += mount == CameraMount::flange ? "Camera in the flange's frame\n" : "Board in the flange's frame\n";
  for (std::size_t k = 0; k < in_flange.size(); ++k)
    out += detail::frame_in_words(carried[k], in_flange[k], in_flange_std[k]);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    out += "Intrinsics of " + camera_names[c] + "\n";
    const VectorX values = cameras[c].parameters();
    for (Index k = 0; k < values.size(); ++k) {
      const int behind = k < 4 ? 2 : 6;
      out += message("  ", Camera::names[static_cast<std::size_t>(k)], "  ", fixed_digits(values(k), behind),
                     camera_std[c](k) > 0 ? " +- " + fixed_digits(camera_std[c](k), behind) : std::string(" (held)"),
                     "\n");
    }
  }
  if (board_scale_std > 0)
    out += "Scale of the board: " + fixed_digits(board_scale, 5) + " +- " + fixed_digits(board_scale_std, 5) + "\n";
  if (scale_effect > 0)
    out += "  that deviation is " + fixed_digits(scale_effect * 1e3, 3) +
           " mm at the arm's reach: measure the board over a long distance, or add a measured length\n";
  if (!blocks.empty()) out += "Left-out images decided, in mm on the board (mean of medians)\n";
  for (const CameraBlock& block : blocks)
    out += "  " + block.name + ": " + fixed_digits(block.without * 1e3, 3) + " without, " +
           fixed_digits(block.with * 1e3, 3) + " with: " + (block.kept ? "kept" : "left out") + "\n";
  return out;
}

}  // namespace vernier
