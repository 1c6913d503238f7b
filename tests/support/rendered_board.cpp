// SPDX-License-Identifier: BSD-3-Clause
#include "rendered_board.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "vernier/camera/board_svg.hpp"

namespace vn = vernier;

namespace vernier_test {

std::vector<unsigned char> rendered(const vn::Board& board, const vn::Camera& camera,
                                    const vn::Isometry3& camera_T_board, double half_pixel, vn::Rng& rng) {
  constexpr int per_square = 24;
  const auto columns = static_cast<int>(board.columns) * per_square, rows = static_cast<int>(board.rows) * per_square;
  std::vector<unsigned char> raster(static_cast<std::size_t>(columns * rows));
  const double cell = board.square / per_square;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      raster[static_cast<std::size_t>(r * columns + c)] = vn::is_black(board, (c + 0.5) * cell, (r + 0.5) * cell);
  const vn::Matrix3 back = camera_T_board.linear().transpose();
  const vn::Vector3 eye = -back * camera_T_board.translation();
  // the point at depth one whose distorted place is (x, y), from a start
  const auto undistort = [&](double x, double y, double& a, double& b, int iterations) {
    for (int iteration = 0; iteration < iterations; ++iteration) {
      const double s = a * a + b * b, radial = 1 + s * (camera.k1 + s * camera.k2);
      const double dx = 2 * camera.p1 * a * b + camera.p2 * (s + 2 * a * a);
      const double dy = camera.p1 * (s + 2 * b * b) + 2 * camera.p2 * a * b;
      a = (x - dx) / radial;
      b = (y - dy) / radial;
    }
  };
  std::vector<unsigned char> out;
  for (vn::Index v = 0; v < camera.height; ++v)
    for (vn::Index u = 0; u < camera.width; ++u) {
      const double x = (static_cast<double>(u) + half_pixel - camera.cx) / camera.fx;
      const double y = (static_cast<double>(v) - camera.cy) / camera.fy;
      double at_x = x, at_y = y;
      undistort(x, y, at_x, at_y, 8);
      double c = 0, r = 0;
      // where the ray through (a, b) at depth one meets the board, in cells
      const auto meets = [&](double a, double b, double around) {
        double ray[3];
        for (vn::Index k = 0; k < 3; ++k) ray[k] = back(k, 0) * a + back(k, 1) * b + back(k, 2);
        const double depth = -eye(2) / ray[2];
        c = (eye(0) + depth * ray[0]) / cell;
        r = (eye(1) + depth * ray[1]) / cell;
        return depth > 0 && c >= -around && r >= -around && c < columns + around && r < rows + around;
      };
      const int samples = meets(at_x, at_y, 2 * per_square) ? 16 : 0;  // the rest is white paper
      int white = 16 - samples;
      for (int sample = 0; sample < samples; ++sample) {
        const double off_x = (sample % 4 - 1.5) / (4 * camera.fx), off_y = (sample / 4 - 1.5) / (4 * camera.fy);
        double a = at_x + off_x, b = at_y + off_y;
        undistort(x + off_x, y + off_y, a, b, 2);
        const bool on_board = meets(a, b, 0);
        const bool black =
            on_board && raster[static_cast<std::size_t>(static_cast<int>(r) * columns + static_cast<int>(c))] != 0;
        white += black ? 0 : 1;
      }
      const double value = 30 + 200 * white / 16.0 + 0.02 * 255 * rng.normal_pair()[0];
      out.push_back(static_cast<unsigned char>(std::lround((std::clamp)(value, 0.0, 255.0))));
    }
  return out;
}

void write_image(const std::string& file, const std::vector<unsigned char>& pixels, vn::Index width, vn::Index height) {
  std::ofstream out(file, std::ios::binary);
  out << "P5\n" << width << ' ' << height << "\n255\n";
  out.write(reinterpret_cast<const char*>(pixels.data()), static_cast<std::streamsize>(pixels.size()));
}

}  // namespace vernier_test
