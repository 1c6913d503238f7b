// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where a saved calibration comes from.

#include <optional>
#include <string>

#include "vernier/camera/camera_setup.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/types.hpp"
#include "vernier/measurements/row_fingerprints.hpp"

namespace vernier {

/// Where a calibration comes from.
struct Provenance {
  std::string data_file{};              ///< name of the file of measured poses; of several, joined by commas
  Index rows = 0;                       ///< number of poses, touches or distances it was fitted to
  std::string date{};                   ///< as given by the caller
  std::string joints = "commanded";     ///< which joint values the data contain: commanded, or encoder
  std::string measured = "poses";       ///< what was measured: poses, positions, contacts, images or distances
  double position_sigma = 0;            ///< of a visit, per component, as estimated from the data [m]; 0: unknown
  double left_out_error = 0;            ///< rms position error of poses that were left out in turn [m]; 0: unknown
  double held_out_error = 0;            ///< mean position error of poses it was not fitted to [m]; 0: unknown
  std::string data_sha256{};            ///< of the bytes of those files, likewise joined; empty: unknown
  std::optional<CameraSetup> camera{};  ///< cameras and board, where images were measured
  RowFingerprints fitted_rows{};        ///< of the poses it was fitted to; empty: unknown

  /// Whether it was fitted to a file with these bytes.
  /// @param sha256 of the bytes
  bool fitted_to(const std::string& sha256) const {
    return !sha256.empty() && data_sha256.find(sha256) != std::string::npos;
  }
  /// The error to expect at other poses [m]: held out, else left out in turn; 0: unknown.
  double expected_error() const { return held_out_error > 0 ? held_out_error : left_out_error; }

  /// Equal in every entry but the cameras.
  bool operator==(const Provenance& other) const {
    return data_file == other.data_file && rows == other.rows && date == other.date && joints == other.joints &&
           measured == other.measured && same_value(position_sigma, other.position_sigma) &&
           same_value(left_out_error, other.left_out_error) && same_value(held_out_error, other.held_out_error) &&
           data_sha256 == other.data_sha256 && fitted_rows == other.fitted_rows;
  }
};

}  // namespace vernier
