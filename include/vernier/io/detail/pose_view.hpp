// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The view of poses in a report: data of the script that turns it, and three projections without a script.

#include <array>
#include <string>
#include <vector>

#include "vernier/io/report_input.hpp"

namespace vernier::detail {

/// Colours from small errors to large ones, told apart with any colour vision; points grow with the error, too.
inline constexpr std::array<const char*, 8> error_colours{"#3a66c8", "#4f7fc4", "#6a96b0", "#8fa086",
                                                          "#b99a55", "#d98a2b", "#e66a17", "#d43d0a"};

/// The errors of a stage.
/// @throws std::invalid_argument where it is not there
VERNIER_API const StageErrors& stage_of(const ReportInput& input, const StageName& name);

/// What the view shows: at most 5,000 of the poses.
struct PoseView {
  std::vector<Index> shown{};  ///< rows of the poses
  VectorX before{}, after{};   ///< errors of all poses [m]
  double before_clip = 0;      ///< 99th percentile [m]: larger errors have the last colour
  double after_clip = 0;       ///< likewise
};
VERNIER_API PoseView pose_view(const ReportInput& input);
/// Which colour an error has.
VERNIER_API std::size_t error_class(double error, double clip);
/// The data of the script as JSON: positions in whole millimetres, errors in micrometres, joints in hundredths of
/// degrees or of millimetres.
VERNIER_API std::string poses_json(const ReportInput& input, const PoseView& view);
/// Views along the three axes of the arm's base frame, coloured by the errors after.
VERNIER_API std::string pose_projections(const ReportInput& input, const PoseView& view);
/// The colours with their errors.
VERNIER_API std::string error_legend(double clip);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/pose_view.ipp"
#endif
