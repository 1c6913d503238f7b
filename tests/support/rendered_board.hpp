// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Images of a printed board, by rays from pixels, which share no code with the projection.

#include <string>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/core/rng.hpp"

namespace vernier_test {

/// An image of 8-bit grey values, row by row: 4 x 4 samples a pixel, noise of 2 %. The camera has no sixth order.
/// @param half_pixel shift of the image to the left [px], an error to be planted
std::vector<unsigned char> rendered(const vernier::Board& board, const vernier::Camera& camera,
                                    const vernier::Isometry3& camera_T_board, double half_pixel, vernier::Rng& rng);

/// Writes an image as PGM.
void write_image(const std::string& file, const std::vector<unsigned char>& pixels, vernier::Index width,
                 vernier::Index height);

}  // namespace vernier_test
