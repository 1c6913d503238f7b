// SPDX-License-Identifier: BSD-3-Clause
// Projection and its derivatives, against a case by hand and an account in long double; and its inverse.

#include "vernier/camera/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.hpp"
#include "projection.hpp"

namespace vn = vernier;

namespace camera_test {
namespace {

vn::Camera distorted() {
  return {.fx = 1000, .fy = 900, .cx = 500, .cy = 400, .k1 = 0.1, .k2 = 0.01, .p1 = 0.001, .p2 = 0.002, .k3 = 0.001};
}

// x = 0.5, y = 1, r2 = 1.25, c = 1.142578125
TEST(Projection, OfAPointByHand) {
  const vn::Vector2 seen = vn::project(distorted(), {1, 2, 2}).pixel;
  EXPECT_NEAR(seen(0), 1000 * (0.5 * 1.142578125 + 0.001 + 0.0035) + 500, 1e-10);
  EXPECT_NEAR(seen(1), 900 * (1.142578125 + 0.00325 + 0.002) + 400, 1e-10);
}

TEST(Projection, OfAPointOnTheAxisIsThePrincipalPoint) {
  const vn::Vector2 seen = vn::project(distorted(), {0, 0, 3}).pixel;  // half a pixel more is another convention
  EXPECT_NEAR(seen(0), 500, 1e-12);
  EXPECT_NEAR(seen(1), 400, 1e-12);
}

TEST(Projection, HasTheDerivativesOfItsDefinition) {
  vn::Rng rng(1);
  for (int trial = 0; trial < 200; ++trial) {
    vn::VectorX values = distorted().parameters();
    for (vn::Index k = 4; k < 9; ++k) values(k) = rng.uniform(-0.05, 0.05);
    const vn::Camera camera = vn::Camera{}.with_parameters(values);
    const vn::Vector3 point(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(0.8, 2));
    const vn::ProjectedPoint seen = vn::project(camera, point);
    const auto intrinsics = vernier_test::numbers_of(camera);
    const std::array<long double, 3> at = vernier_test::long_numbers(point);
    const auto exact = vernier_test::pixel_of(intrinsics, at);
    const auto slope = [&](auto moved, std::size_t k, vn::Index row) {
      auto up = moved, down = moved;
      const long double h = 1e-6L * (1 + std::abs(moved[k]));
      up[k] += h;
      down[k] -= h;
      if constexpr (std::tuple_size_v<decltype(moved)> == 9) {
        return static_cast<double>((vernier_test::pixel_of(up, at)[static_cast<std::size_t>(row)] -
                                    vernier_test::pixel_of(down, at)[static_cast<std::size_t>(row)]) /
                                   (2 * h));
      } else {
        return static_cast<double>((vernier_test::pixel_of(intrinsics, up)[static_cast<std::size_t>(row)] -
                                    vernier_test::pixel_of(intrinsics, down)[static_cast<std::size_t>(row)]) /
                                   (2 * h));
      }
    };
    for (vn::Index row = 0; row < 2; ++row) {
      EXPECT_NEAR(seen.pixel(row), static_cast<double>(exact[static_cast<std::size_t>(row)]), 1e-9);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(seen.by_point(row, static_cast<vn::Index>(k)), slope(at, k, row), 1e-5) << k;
      for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(seen.by_camera(row, static_cast<vn::Index>(k)), slope(intrinsics, k, row), 1e-6) << k;
    }
  }
}

TEST(NormalisedPoint, ProjectsToItsPixel) {
  const vn::Camera camera = vernier_test::machine_camera();
  for (double u = 0; u < 1600; u += 100)
    for (double v = 0; v < 1200; v += 100) {
      const vn::Vector2 ray = vn::normalised(camera, {u, v});
      const vn::Vector2 back = vernier_test::seen_at(camera, {ray(0), ray(1), 1});
      EXPECT_NEAR(back(0), u, 1e-8);
      EXPECT_NEAR(back(1), v, 1e-8);
    }
}

TEST(NormalisedPoint, DoesNotExistBeyondTheFold) {
  const vn::Camera folded{.fx = 1000, .fy = 1000, .cx = 0, .cy = 0, .k1 = -0.5};  // x (1 - x^2 / 2) is at most 0.544
  EXPECT_TRUE(std::isnan(vn::normalised(folded, {700, 0})(0)));
}

TEST(Camera, RefusesWhatNoCameraHas) {
  vn::Camera camera = distorted();
  camera.fy = -1;
  EXPECT_NE(vernier_test::complaint([&] { camera.validate(); }).find("focal lengths 1000 and -1"), std::string::npos);
}

}  // namespace
}  // namespace camera_test
