// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a report of a calibration shows, as plain values.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vernier/calibration/calibration_report.hpp"

namespace vernier {

/// The poses whose errors a report shows: held-out ones, one row each.
struct ReportPoses {
  PointRows positions = PointRows(0, 3);  ///< of the tool, in the arm's base frame [m]
  MatrixX joints{};                       ///< n x N [rad, m]
  std::vector<std::string> files{};       ///< names of the files of measured poses
  std::vector<int> file{};                ///< which of them, one a pose; empty: all of the first
  std::vector<Index> line{};              ///< its line there, from 1; empty: rows 0 .. n-1
  std::vector<Index> visited{};           ///< number of the pose that each row visits; empty: each its own
  VectorX normalised{};                   ///< errors in predicted standard deviations; empty where unknown
  VectorX gates{};                        ///< share of the joint-wise terms; empty where there are none
};

/// A finding of the audit of the data.
struct ReportFinding {
  std::string kind;     ///< what it is, in a word or two
  std::string rows;     ///< which rows it concerns
  std::string message;  ///< what was seen and what to do
};

/// A training row whose error is too large, predicted by the model without it.
struct ReportSuspect {
  std::string row;        ///< its number and file
  double error = 0;       ///< [m]
  double normalised = 0;  ///< in standard deviations
  std::string remark{};   ///< a likely reason; may be empty
};

/// A table of a report's own kind, in a section of its own behind the errors.
struct ReportTable {
  std::string title;                             ///< heading
  std::string note{};                            ///< a sentence in front
  std::vector<std::string> head{};               ///< of the columns
  std::vector<std::vector<std::string>> rows{};  ///< the first cell of each is its heading
};

/// A file that a report was made from.
struct ReportFile {
  std::string name;    ///< as given
  Index rows = 0;      ///< number of rows
  std::string sha256;  ///< of its bytes, see `sha256`
};

/// Where a report comes from.
struct ReportProvenance {
  std::string command{};             ///< command line
  std::string date{};                ///< as given by the caller
  std::uint64_t seed = 0;            ///< of everything random
  std::vector<ReportFile> inputs{};  ///< files that were read
  std::string model{};               ///< name of the model file; empty for none
  std::string model_sha256{};        ///< of its bytes
  std::string version{};             ///< of this library; empty: as compiled
  std::string compiler{};            ///< likewise
  std::string eigen{};               ///< version of Eigen, likewise
};

/// Everything that a report shows: plain values. What is empty is left out.
struct ReportInput {
  std::string robot{};                   ///< name of the arm
  std::string title = "Calibration";     ///< what this is the report of
  std::string what = "poses";            ///< what has errors: poses, touches of objects, distances
  std::string headline{};                ///< first sentence of the verdict; the errors follow
  std::vector<StageErrors> stages{};     ///< position errors of the poses [m], orientation errors [rad]
  StageName before = Stage::frames;      ///< the stage before
  StageName after{};                     ///< the stage that is deployed
  bool held_out = true;                  ///< whether the poses are none that the model was fitted to
  std::string rule{};                    ///< how they were held out, in words
  Index train_poses = 0;                 ///< number of poses it was fitted to
  std::optional<double> accept{};        ///< largest mean position error that is accepted [m]
  std::optional<bool> passed{};          ///< whether the headline is good news; by default as `accept` decides
  std::vector<std::string> sentences{};  ///< the verdict in detail
  std::optional<std::vector<ReportFinding>> audit{};  ///< findings in the data; without a value no audit was made
  ReportPoses poses{};                                ///< whose errors are shown, as many as the stages have
  std::vector<ReportTable> tables{};                  ///< of this kind of report
  std::optional<double> ellipsoid_coverage{};         ///< share of poses within their predicted 95 % ellipsoid
  std::vector<JointReport> joints{};                  ///< one a joint: ranges, functions, spectrum
  std::vector<ParameterEstimate> parameters{};        ///< of frames and chain
  std::vector<std::string> correlated{};              ///< pairs of parameters that the poses hardly tell apart
  Index left_out = 0;                                 ///< training poses that were left out in turn
  std::vector<ReportSuspect> suspects{};              ///< training rows
  std::vector<SessionDrift> drift{};                  ///< of each station's base
  VectorX times{};                                    ///< of the poses, in the order of measuring; empty where unknown
  std::vector<std::string> advice{};                  ///< what to measure next, a sentence each
  ReportProvenance provenance{};                      ///< where it comes from
  std::string results{};                              ///< all results as JSON text, as the program writes them
};

}  // namespace vernier
