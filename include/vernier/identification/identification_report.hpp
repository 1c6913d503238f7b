// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The outcome of an identification, whatever the arm: how well it is known, in numbers and in words.

#include <limits>
#include <string>
#include <vector>

#include "vernier/identification/observability.hpp"
#include "vernier/kinematics/concepts.hpp"

namespace vernier {

/// How an identification ended.
enum class IdentifyStatus {
  converged,        ///< the model is the best the data support
  underdetermined,  ///< too few or too uniform measurements: the solution is one of many
  not_converged,    ///< the solver stopped before it converged
};

/// Status of one parameter.
enum class ParameterState {
  fixed,            ///< not estimated; its value is unchanged bit for bit
  identified,       ///< determined by the data
  weak,             ///< weakly determined: regularised by a prior of physical size around nominal
  not_identifiable  ///< linearly dependent on others, or without effect on what was measured; its value is unchanged
};

/// One parameter of the arm, its frames included.
struct ParameterEstimate {
  std::string name;      ///< its name
  ParameterKind kind;    ///< length [m] or angle [rad]
  double nominal;        ///< value at the start
  double identified;     ///< estimate
  double std;            ///< standard deviation of the estimate; 0 for a parameter that was not estimated
  ParameterState state;  ///< its status
  std::string remark;    ///< why it is not identifiable, in words; else empty
  double scale = 0;      ///< expected size of its error
  /// Standard deviation of the prior around nominal; infinite where there is none.
  double prior_std = std::numeric_limits<double>::infinity();
};

/// Everything of an identification but the model.
struct IdentificationReport {
  IdentifyStatus status = IdentifyStatus::converged;  ///< how it ended
  std::string message;                                ///< why it ended, in words
  double rms_before = 0;                              ///< position error with frames registered and links nominal [m]
  double rms_after = 0;                               ///< position error of the identified arm [m]
  double rotation_rms_after = 0;              ///< orientation error of the identified arm [rad]; 0 for positions alone
  std::vector<ParameterEstimate> parameters;  ///< base, chain, tool: all of them
  std::vector<Index> free;                    ///< the estimated ones, in the order of `covariance`
  MatrixX covariance;                         ///< of the estimated parameters [m, rad]; empty where rank deficient
  Index rank = 0;                             ///< of the Jacobian of the estimated parameters
  double condition = 0;  ///< of the Jacobian in steps of expected sizes; above 100 poses are poorly chosen
  int iterations = 0;    ///< of the solver, all rounds
  /// Whether the links stay as designed, because others do not predict left-out poses better.
  bool links_as_designed = false;
  bool too_few = false;           ///< whether there are no more measured values than parameters to be estimated
  double residual_variance = 1;   ///< of residuals divided by the sensor's standard deviation
  Observability observability{};  ///< of the estimated parameters

  /// Whether the model may be trusted.
  bool converged() const { return status == IdentifyStatus::converged; }
  /// Names of the parameters in a state.
  VERNIER_API std::vector<std::string> names(ParameterState state) const;
  /// Pairs of estimated parameters that the poses hardly distinguish, by name, strongest first: "d4 and tool_z
  /// (+0.98)".
  VERNIER_API std::vector<std::string> strongly_correlated(double limit = 0.95) const;
  /// The outcome in plain words, a few lines.
  VERNIER_API std::string summary() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/identification_report.ipp"
#endif
