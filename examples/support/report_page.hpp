#pragma once

/// @file
/// What the programs put into a report beside their results: files, rows, poses.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cli.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/core/check.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/io/html_report.hpp"

namespace support {

/// Where some samples of a data set were in it: their row numbers, from 0. Equal rows are taken in their order.
template <int N>
std::vector<vernier::Index> rows_of(const vernier::Dataset<N>& all, const vernier::Dataset<N>& some) {
  const auto key = [](const vernier::Dataset<N>& data, vernier::Index i) {
    std::vector<double> out(data.joints().row(i).begin(), data.joints().row(i).end());
    out.insert(out.end(), data.positions().row(i).begin(), data.positions().row(i).end());
    return out;
  };
  std::map<std::vector<double>, std::vector<vernier::Index>> places;
  for (vernier::Index i = all.size(); i-- > 0;) places[key(all, i)].push_back(i);
  std::vector<vernier::Index> out;
  for (vernier::Index i = 0; i < some.size(); ++i) {
    std::vector<vernier::Index>& at = places[key(some, i)];
    vernier::require(!at.empty(), "rows_of: sample ", i, " is not in the data set");
    out.push_back(at.back());
    if (at.size() > 1) at.pop_back();
  }
  return out;
}

/// Adds samples of a file to the poses of a report, where the nominal arm is at their joints.
/// @param file name of the file
/// @param rows of the samples in it
template <int N>
void add_poses(vernier::ReportInput& report, const auto& nominal, const vernier::Dataset<N>& data,
               const std::string& file, const std::vector<vernier::Index>& rows) {
  vernier::ReportPoses& poses = report.poses;
  const vernier::Index before = poses.positions.rows(), n = data.size();
  poses.files.push_back(file);
  poses.positions.conservativeResize(before + n, 3);
  poses.joints.conservativeResize(before + n, N);
  report.times.conservativeResize(before + n);
  for (vernier::Index i = 0; i < n; ++i) {
    poses.file.push_back(static_cast<int>(poses.files.size()) - 1);
    poses.row.push_back(rows[static_cast<std::size_t>(i)]);
    poses.positions.row(before + i) = nominal.position(data.joints(i)).transpose();
    poses.joints.row(before + i) = data.joints().row(i);
    report.times(before + i) = data.times()(i);
  }
}

/// The findings of audits, one a file.
std::vector<vernier::ReportFinding> audit_rows(const std::vector<std::string>& files,
                                               const std::vector<vernier::DataAudit>& audits);

/// A file that was read, with the digest of its bytes.
vernier::ReportFile file_read(const std::string& path, vernier::Index rows);

/// Writes a report with its provenance, the model among it where there is one.
void write_report(const Program& program, const std::string& path, vernier::ReportInput& report,
                  const std::string& date, const std::string& model);

}  // namespace support
