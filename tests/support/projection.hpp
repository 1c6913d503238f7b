// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// A camera written down a second time, in long double, that shares no code with the library; and views of a board.

#include <array>
#include <cmath>
#include <vector>

#include "vernier/camera/corner_views.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"

namespace vernier_test {

/// The pixel of a point, from fx, fy, cx, cy, k1, k2, p1, p2, k3.
inline std::array<long double, 2> pixel_of(const std::array<long double, 9>& c,
                                           const std::array<long double, 3>& point) {
  const long double x = point[0] / point[2], y = point[1] / point[2], r = std::sqrt(x * x + y * y);
  const long double radial = 1 + c[4] * std::pow(r, 2.0L) + c[5] * std::pow(r, 4.0L) + c[8] * std::pow(r, 6.0L);
  const long double dx = x * radial + 2 * c[6] * x * y + c[7] * (r * r + 2 * x * x);
  const long double dy = y * radial + c[6] * (r * r + 2 * y * y) + 2 * c[7] * x * y;
  return {c[0] * dx + c[2], c[1] * dy + c[3]};
}

inline std::array<long double, 9> numbers_of(const vernier::Camera& camera) {
  const double values[] = {camera.fx, camera.fy, camera.cx, camera.cy, camera.k1,
                           camera.k2, camera.p1, camera.p2, camera.k3};
  std::array<long double, 9> out{};
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<long double>(values[k]);
  return out;
}

/// A point in more digits.
inline std::array<long double, 3> long_numbers(const vernier::Vector3& point) {
  return {static_cast<long double>(point(0)), static_cast<long double>(point(1)), static_cast<long double>(point(2))};
}

/// The pixel at which a camera sees a point of its frame [m].
inline vernier::Vector2 seen_at(const vernier::Camera& camera, const vernier::Vector3& point) {
  const auto [u, v] = pixel_of(numbers_of(camera), long_numbers(point));
  return {static_cast<double>(u), static_cast<double>(v)};
}

/// All corners of a board that lie in the image, with noise.
inline vernier::View view_of(const vernier::Camera& camera, const vernier::Board& board,
                             const vernier::Isometry3& camera_T_board, double noise, vernier::Rng& rng) {
  vernier::View out;
  for (vernier::Index k = 0; k < board.corners(); ++k) {
    const vernier::Vector3 at = camera_T_board * board.corner(k);
    if (!(at.z() > 0.05)) continue;
    const vernier::Vector2 pixel = seen_at(camera, at);
    if (pixel(0) < 0 || pixel(1) < 0 || pixel(0) > static_cast<double>(camera.width - 1) ||
        pixel(1) > static_cast<double>(camera.height - 1))
      continue;
    out.corners.push_back(k);
    const auto [a, b] = rng.normal_pair();
    out.pixels.emplace_back(pixel(0) + noise * a, pixel(1) + noise * b);
  }
  return out;
}

/// A camera as machines have it.
inline vernier::Camera machine_camera() {
  vernier::Camera out{.fx = 1400, .fy = 1405, .cx = 810, .cy = 590, .k1 = -0.11, .k2 = 0.08, .p1 = 4e-4, .p2 = -6e-4};
  out.width = 1600;
  out.height = 1200;
  return out;
}

/// A pose of a board before the camera, tilted by up to 0.7 rad.
inline vernier::Isometry3 board_before_camera(const vernier::Board& board, double distance, vernier::Rng& rng) {
  const double about_z = rng.uniform(-1.5, 1.5), about_y = rng.uniform(-0.7, 0.7), about_x = rng.uniform(-0.7, 0.7);
  const vernier::Vector3 turn(about_x, about_y, about_z);
  const vernier::Matrix3 rotation = vernier::exp_so3(turn);
  const double z = distance * rng.uniform(0.9, 1.2), y = rng.uniform(-0.1, 0.1), x = rng.uniform(-0.1, 0.1);
  const vernier::Vector3 middle(x, y, z);
  return vernier::rigid_motion(rotation, middle - rotation * board.middle());
}

}  // namespace vernier_test
