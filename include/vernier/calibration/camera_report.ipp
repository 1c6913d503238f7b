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

VERNIER_IMPL std::string CameraReport::counts() const {
  Index corners = 0;
  for (const ImageError& image : images) corners += image.corners;
  return message(images.size(), " images, ", corners, " corners, camera ",
                 mount == CameraMount::flange ? "on the flange" : "standing still");
}

VERNIER_IMPL std::vector<std::string> CameraReport::verdict() const {
  using detail::fixed_digits;
  std::vector<std::string> out;
  std::string distance = "Distance on the board: ";
  if (left_out_mean > 0)
    distance += fixed_digits(left_out_mean * 1e3, 3) + " mm mean at left-out images (largest " +
                fixed_digits(left_out_max * 1e3, 2) + " mm)" +
                (choices_repeated ? ", all decisions made without them, " : ", ");
  out.push_back(distance + fixed_digits(mean * 1e3, 3) + " mm in the fit.");
  out.push_back("Corners scatter by " + fixed_digits(pixel_sigma, 3) + " px within an image" +
                (pose_excess > 1.2
                     ? "; images scatter more, by errors of the arm, and standard deviations follow the images."
                     : "."));
  if (ambiguous > 0 || downweighted > 0) {
    std::string odd;
    if (ambiguous > 0)
      odd = message(counted(ambiguous, "view", "views"),
                    " fitted a wrong pose of the board better; the arm's poses told. ");
    if (downweighted > 0) odd += message(counted(downweighted, "corner counts", "corners count"), " less than half. ");
    odd.pop_back();
    out.push_back(odd);
  }
  if (board_scale_std > 0)
    out.push_back("Scale of the board: " + fixed_digits(board_scale, 5) + " +- " + fixed_digits(board_scale_std, 5) +
                  (scale_effect > 0 ? ". That deviation is " + fixed_digits(scale_effect * 1e3, 3) +
                                          " mm at the arm's reach: measure the board over a long distance, or add a "
                                          "measured length."
                                    : "."));
  if (!blocks.empty()) {
    std::string kept, left;
    for (const CameraBlock& block : blocks) {
      std::string& names = block.kept ? kept : left;
      names += (names.empty() ? "" : ", ") + block.name + " (" + fixed_digits(block.without * 1e3, 3) +
               " mm without, " + fixed_digits(block.with * 1e3, 3) + " with)";
    }
    out.push_back("Left-out images decided. Estimated: " + (kept.empty() ? "no more" : kept) +
                  (left.empty() ? "." : ". Not estimated: " + left + "."));
  }
  const auto unused = [&](const char* what, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::string line = message(what, ": ");
    for (std::size_t k = 0; k < names.size() && k < 10; ++k) line += (k > 0 ? ", " : "") + names[k];
    out.push_back(line + (names.size() > 10 ? message(", and ", names.size() - 10, " more.") : "."));
  };
  unused("Images without a row of the arm, not used", without_row);
  unused("Rows without an image, not used", without_corners);
  return out;
}

VERNIER_IMPL std::string CameraReport::frames_and_intrinsics() const {
  using detail::fixed_digits;
  std::string out(mount == CameraMount::flange ? "Board in the arm's base frame\n"
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
  return out;
}

VERNIER_IMPL std::string CameraReport::summary() const {
  std::string out = counts() + "\n\nVerdict\n";
  for (const std::string& line : verdict()) out += "- " + line + "\n";
  return out + "\n" + frames_and_intrinsics();
}

}  // namespace vernier
