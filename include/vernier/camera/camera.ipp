// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/camera.hpp"

#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"

namespace vernier {

VERNIER_IMPL VectorX Camera::parameters() const {
  VectorX out(num_parameters);
  const double values[] = {fx, fy, cx, cy, k1, k2, p1, p2, k3};
  for (Index k = 0; k < num_parameters; ++k) out(k) = values[k];
  return out;
}

VERNIER_IMPL Camera Camera::with_parameters(const VectorX& values) const {
  demand(values.size() == num_parameters, "Camera: ", values.size(), " intrinsics, there are ", num_parameters);
  Camera out = *this;
  double* const places[] = {&out.fx, &out.fy, &out.cx, &out.cy, &out.k1, &out.k2, &out.p1, &out.p2, &out.k3};
  for (Index k = 0; k < num_parameters; ++k) *places[k] = values(k);
  return out;
}

VERNIER_IMPL void Camera::validate() const {
  const VectorX values = parameters();
  for (Index k = 0; k < num_parameters; ++k)
    demand(std::isfinite(values(k)), "Camera: ", names[static_cast<std::size_t>(k)], " is not finite");
  demand(fx > 0 && fy > 0, "Camera: focal lengths ", fx, " and ", fy, " px, both must be positive");
  demand(width >= 0 && height >= 0, "Camera: images of ", width, " x ", height, " pixels");
}

VERNIER_IMPL ProjectedPoint project(const Camera& camera, const Vector3& point) {
  const double inverse = 1 / point(2), x = point(0) * inverse, y = point(1) * inverse;
  const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double c = 1 + camera.k1 * r2 + camera.k2 * r4 + camera.k3 * r6;
  const double slope = camera.k1 + 2 * camera.k2 * r2 + 3 * camera.k3 * r4;  // of c by r2
  const double u = x * c + 2 * camera.p1 * x * y + camera.p2 * (r2 + 2 * x * x);
  const double v = y * c + camera.p1 * (r2 + 2 * y * y) + 2 * camera.p2 * x * y;
  const double u_x = c + 2 * x * x * slope + 2 * camera.p1 * y + 6 * camera.p2 * x;
  const double mixed = 2 * x * y * slope + 2 * camera.p1 * x + 2 * camera.p2 * y;  // u by y, and v by x
  const double v_y = c + 2 * y * y * slope + 6 * camera.p1 * y + 2 * camera.p2 * x;

  ProjectedPoint out;
  out.pixel = Vector2(camera.fx * u + camera.cx, camera.fy * v + camera.cy);
  const double by_x[2] = {camera.fx * u_x, camera.fy * mixed}, by_y[2] = {camera.fx * mixed, camera.fy * v_y};
  for (Index r = 0; r < 2; ++r) {
    out.by_point(r, 0) = by_x[r] * inverse;
    out.by_point(r, 1) = by_y[r] * inverse;
    out.by_point(r, 2) = -(by_x[r] * x + by_y[r] * y) * inverse;
  }
  const double of_u[] = {u,
                         0,
                         1,
                         0,
                         camera.fx * x * r2,
                         camera.fx * x * r4,
                         camera.fx * 2 * x * y,
                         camera.fx * (r2 + 2 * x * x),
                         camera.fx * x * r6};
  const double of_v[] = {0,
                         v,
                         0,
                         1,
                         camera.fy * y * r2,
                         camera.fy * y * r4,
                         camera.fy * (r2 + 2 * y * y),
                         camera.fy * 2 * x * y,
                         camera.fy * y * r6};
  for (Index k = 0; k < Camera::num_parameters; ++k) {
    out.by_camera(0, k) = of_u[k];
    out.by_camera(1, k) = of_v[k];
  }
  return out;
}

VERNIER_IMPL Vector2 normalised(const Camera& camera, const Vector2& pixel) {
  Vector3 at((pixel(0) - camera.cx) / camera.fx, (pixel(1) - camera.cy) / camera.fy, 1);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const ProjectedPoint seen = project(camera, at);
    const double u = pixel(0) - seen.pixel(0), v = pixel(1) - seen.pixel(1);
    const double a = seen.by_point(0, 0), b = seen.by_point(0, 1), c = seen.by_point(1, 0), d = seen.by_point(1, 1);
    const double determinant = a * d - b * c;
    if (!(determinant > 0)) break;
    const double x = (d * u - b * v) / determinant, y = (a * v - c * u) / determinant;
    at(0) += x;
    at(1) += y;
    if (std::abs(x) + std::abs(y) < 1e-14 * (1 + std::abs(at(0)) + std::abs(at(1)))) return {at(0), at(1)};
  }
  const ProjectedPoint seen = project(camera, at);
  const double missed = std::abs(seen.pixel(0) - pixel(0)) + std::abs(seen.pixel(1) - pixel(1));
  if (missed < 1e-9 * (camera.fx + camera.fy)) return {at(0), at(1)};
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return {none, none};
}

}  // namespace vernier
