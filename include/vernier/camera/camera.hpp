// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A camera as a map from points to pixels: pinhole with the distortion of Brown and Conrady, as OpenCV and ROS state
/// it.

#include <array>
#include <string>

#include "vernier/core/types.hpp"

namespace vernier {

/// A pixel, or a point at depth one.
using Vector2 = Eigen::Vector2d;

/// Intrinsics of a camera. The centre of the first pixel is (0, 0). A point (X, Y, Z) of the camera's frame, x to the
/// right, y down and z along the view, is seen at
///
///     x = X/Z, y = Y/Z, r2 = x^2 + y^2, c = 1 + k1 r2 + k2 r2^2 + k3 r2^3
///     u = fx (x c + 2 p1 x y + p2 (r2 + 2 x^2)) + cx,   v = fy (y c + p1 (r2 + 2 y^2) + 2 p2 x y) + cy
/// @cite Brown 1971
struct Camera {
  double fx = 0;     ///< focal length along u [px]
  double fy = 0;     ///< focal length along v [px]
  double cx = 0;     ///< principal point, u [px]
  double cy = 0;     ///< principal point, v [px]
  double k1 = 0;     ///< radial distortion of second order
  double k2 = 0;     ///< radial distortion of fourth order
  double p1 = 0;     ///< tangential distortion along v
  double p2 = 0;     ///< tangential distortion along u
  double k3 = 0;     ///< radial distortion of sixth order
  Index width = 0;   ///< of the images [px]; 0 where it is not known
  Index height = 0;  ///< of the images [px]; 0 where it is not known

  /// Number of intrinsics.
  static constexpr Index num_parameters = 9;
  /// Their names, in the order of `parameters`.
  static constexpr std::array<const char*, num_parameters> names{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};

  /// The nine intrinsics in the order of `names`.
  VERNIER_API VectorX parameters() const;
  /// A camera of this image size with other intrinsics, in the order of `names`.
  VERNIER_API Camera with_parameters(const VectorX& values) const;
  /// @throws std::invalid_argument naming a value that no camera has
  VERNIER_API void validate() const;
};

/// A pixel and how it moves.
struct ProjectedPoint {
  Vector2 pixel;                                               ///< (u, v)
  Eigen::Matrix<double, 2, 3> by_point;                        ///< derivative by the point [px/m]
  Eigen::Matrix<double, 2, Camera::num_parameters> by_camera;  ///< derivative by the intrinsics
};

/// The pixel at which a camera sees a point, and its exact derivatives.
/// @param camera with intrinsics
/// @param point  in the camera's frame [m], in front of it: z > 0
VERNIER_API ProjectedPoint project(const Camera& camera, const Vector3& point);

/// The point at depth one, (x, y, 1), that a camera sees at a pixel, by Newton's method.
/// @return not a number where there is none: beyond the distortion's fold
VERNIER_API Vector2 normalised(const Camera& camera, const Vector2& pixel);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/camera.ipp"
#endif
