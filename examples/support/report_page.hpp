// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the programs put into a report beside their results: files, rows, poses.

#include <string>
#include <vector>

#include "cli.hpp"
#include "file_name.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// Adds samples of a file to the poses of a report, where the nominal arm is at their joints.
template <int N>
void add_poses(vernier::ReportInput& report, const auto& nominal, const vernier::Dataset<N>& data) {
  vernier::ReportPoses& poses = report.poses;
  const vernier::Index before = poses.positions.rows(), n = data.size();
  for (const std::string& file : data.origin().files) poses.files.push_back(file_name(file));
  const int first = static_cast<int>(poses.files.size() - data.origin().files.size());
  poses.positions.conservativeResize(before + n, 3);
  poses.joints.conservativeResize(before + n, N);
  report.times.conservativeResize(before + n);
  for (vernier::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    poses.file.push_back(first + data.origin().file[row]);
    poses.line.push_back(data.origin().line[row]);
    poses.positions.row(before + i) = nominal.position(data.joints(i)).transpose();
    poses.joints.row(before + i) = data.joints().row(i);
    report.times(before + i) = data.times()(i);
  }
}

/// The findings of audits, one a file.
std::vector<vernier::ReportFinding> audit_rows(const std::vector<std::string>& files,
                                               const std::vector<vernier::DataAudit>& audits);

/// The file of some rows, as it was read.
inline vernier::ReportFile file_of(const vernier::RowOrigin& rows) {
  return {rows.files.front(), static_cast<vernier::Index>(rows.line.size()), rows.hashes.front()};
}

/// Writes a report with its provenance.
/// @param model file of the model that it speaks of, with its hash; without a name where there is none
void write_report(const Program& program, const std::string& path, vernier::ReportInput& report,
                  const std::string& date, const vernier::SourceFile& model);

}  // namespace support
