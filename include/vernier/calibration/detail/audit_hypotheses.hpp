// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Hypotheses on what is wrong with all rows of measured poses, for the audit of data.

#include <optional>
#include <vector>

#include "vernier/calibration/data_finding.hpp"
#include "vernier/calibration/detail/audit_fit.hpp"
#include "vernier/core/function_ref.hpp"

namespace vernier::detail {

/// A fault of all rows.
struct AuditHypothesis {
  std::optional<FaultKind> kind{};  ///< none: nothing is wrong
  int joint = -1;                   ///< of a zero
  std::vector<int> reversed{};      ///< joints that count in the other direction, ascending
  /// Of each joint the factor by which its values contain those of the joint before it, as they are; empty: none do.
  std::vector<double> couplings{};
  double factor = 1;   ///< of measured lengths or joint angles, to be divided out
  double zero = 0;     ///< where the search for a joint's zero starts [rad, m]
  int convention = 0;  ///< of orientations, see `convention_name`

  /// Number of joints that are reversed or coupled.
  VERNIER_API int faults() const;
  /// A factor of residuals in comparisons: one fault is simpler than two.
  double simplicity() const { return 1 + 0.25 * (faults() > 1 ? faults() - 1 : 0); }
  /// The rows without the fault; coupled joints are taken apart before signs are reversed.
  VERNIER_API AuditRows corrected(const AuditRows& rows, const ArmGeometry& arm) const;
};

/// What values that are no rotation vectors are, in words.
VERNIER_API std::string convention_name(int convention);

/// A hypothesis, and the frames that fit the rows best under it.
struct HypothesisFit {
  AuditHypothesis hypothesis;
  AuditFit fit;
  double zero = 0;               ///< of its joint [rad, m]
  bool plausible = false;        ///< whether the rows, corrected, may be those of the arm
  bool plausible_as_is = false;  ///< whether the rows may be as they are
};

/// Registers frames, and a joint's zero where the hypothesis says so.
VERNIER_API HypothesisFit fit_hypothesis(const ArmGeometry& nominal, const AuditRows& rows,
                                         const AuditHypothesis& hypothesis);

/// Whether each joint and the one before it turn about parallel axes, so that its values may contain those of that.
VERNIER_API std::vector<bool> parallel_to_previous(const ArmGeometry& arm);
/// Calls `f` for every combination of factors -1, 0, 1 of some joints, one a joint, 0 where it may not be coupled.
VERNIER_API void for_all_couplings(const std::vector<bool>& may_be, FunctionRef<void(const std::vector<double>&)> f);

/// Whether a nominal arm may leave such residuals: a twentieth of the scatter of the positions, or 10 mm.
VERNIER_API bool plausible_residuals(const ArmGeometry& nominal, const AuditRows& rows,
                                     const AuditResiduals& residuals);

/// The hypothesis that halves the robust residuals and makes them smallest, or that nothing is wrong. Where rows as
/// they are cannot be those of the arm, every pattern of the joints' signs is registered in closed form, also with
/// joints that contain the one before where their axes are parallel; the best patterns are fitted robustly.
VERNIER_API HypothesisFit best_hypothesis(const ArmGeometry& nominal, const AuditRows& rows, double smallest_zero);

/// Joints and poses that are off by some rows against each other: the pose of row i lies in row i + shift.
struct RowShift {
  Index first = 0, end = 0;  ///< rows concerned
  Index shift = 0;
  double score = 0;              ///< of the rows that fit [m]
  std::vector<Index> fitting{};  ///< rows that have a pose, ascending
  std::vector<Index> shifts{};   ///< of each of them
};

/// A shift by up to three rows, of all rows or from some row on, if there is one.
VERNIER_API std::optional<RowShift> find_shift(const ArmGeometry& nominal, const AuditRows& rows, double best_score);

/// A robust scale of the distances of points from their mean [m].
VERNIER_API double point_scatter(const PointRows& points);

/// At most `count` rows at equal distances.
VERNIER_API std::vector<Index> spread_rows(Index rows, Index count);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/audit_hypotheses.ipp"
#endif
