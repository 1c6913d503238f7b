// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/calibration/controller_search.hpp"
#include "vernier/calibration/detail/audit_hypotheses.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier {

namespace detail {

/// The controllers with which one joint is passive, signs and couplings of the others, simplest first.
VERNIER_LOCAL std::vector<std::pair<int, MatrixX>> passive_patterns(const ArmGeometry& arm) {
  const int n = arm.joints();
  const std::vector<bool> parallel = parallel_to_previous(arm);
  const VectorX parameters = arm.parameters();
  std::vector<std::pair<int, MatrixX>> out;  // number of signs and couplings; factors
  for (int passive = n - 1; passive > 0; --passive) {
    if (!parallel[static_cast<std::size_t>(passive)]) continue;
    std::vector<bool> may_be = parallel;
    may_be[static_cast<std::size_t>(passive)] = false;
    if (passive + 1 < n) may_be[static_cast<std::size_t>(passive) + 1] = false;  // of a joint that is not shown
    for_all_couplings(may_be, [&](const std::vector<double>& couplings) {
      for (unsigned signs = 0; signs < 1u << (n - 1); ++signs) {
        MatrixX factors = MatrixX::Zero(n, n - 1);
        int faults = 0;
        for (int row = 0; row < n; ++row) {
          if (row == passive) continue;
          const int shown = row - (row > passive ? 1 : 0);
          const double sign = (signs >> shown & 1u) != 0 ? -1 : 1, coupling = couplings[static_cast<std::size_t>(row)];
          factors(row, shown) = sign;
          if (shown > 0) factors(row, shown - 1) = -sign * coupling;
          faults += (sign < 0 ? 1 : 0) + (std::abs(coupling) > 0 ? 1 : 0);
        }
        double direction = -1;  // the axes before may point the other way
        for (int row = passive - 1; row >= 0; --row) {
          direction *= std::cos(parameters(ArmParameters::of_row(row, DhParameter::alpha))) < 0 ? -1 : 1;
          for (int j = 0; j < n - 1; ++j) factors(passive, j) += direction * factors(row, j);
          if (!parallel[static_cast<std::size_t>(row)]) break;
        }
        out.emplace_back(faults, std::move(factors));
      }
    });
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return out;
}

}  // namespace detail

VERNIER_IMPL std::optional<FoundController> find_passive_joint(const ArmGeometry& nominal, const ConstMatrixRef& shown,
                                                               const PointRows& positions,
                                                               const PointRows& rotation_vectors) {
  constexpr std::size_t kept = 8;
  demand(shown.cols() == nominal.joints() - 1, "find_passive_joint: ", shown.cols(), " joint values, expected ",
         nominal.joints() - 1);
  demand(shown.rows() >= 10 && positions.rows() == shown.rows(), "find_passive_joint: ", shown.rows(),
         " rows of joints, ", positions.rows(), " of positions, 10 or more are needed");
  if (nominal.joints() > max_arm_joints) return std::nullopt;  // too many patterns
  detail::AuditRows all{MatrixX(), positions, {}, rotation_vectors};
  for (Index i = 0; i < rotation_vectors.rows(); ++i) all.orientations.push_back(exp_so3(point(rotation_vectors, i)));
  const auto rows_by = [&](const ControllerMap& map, Index count) {
    detail::AuditRows out = all;
    out.joints = map.to_chain(shown);
    return out.rows(detail::spread_rows(out.size(), count));
  };
  struct Candidate {
    double score;
    int faults;
    ControllerMap map;
  };
  std::vector<Candidate> candidates;
  const auto weighted = [](double score, int faults) { return score * (1 + 0.25 * (faults > 1 ? faults - 1 : 0)); };
  for (const auto& [faults, factors] : detail::passive_patterns(nominal)) {
    ControllerMap map(factors, VectorX::Zero(nominal.joints()));
    const detail::AuditRows rows = rows_by(map, 60);
    const ArmGeometry arm = detail::starting_frames(nominal, rows.measured(), true, true);
    candidates.push_back({weighted(detail::audit_residuals(arm, rows).score(), faults), faults, std::move(map)});
  }
  const auto better = [](const Candidate& a, const Candidate& b) { return a.score < b.score; };
  std::stable_sort(candidates.begin(), candidates.end(), better);
  if (candidates.size() > kept) candidates.erase(candidates.begin() + kept, candidates.end());
  std::optional<FoundController> out;
  double best = 0;
  for (const Candidate& one : candidates) {
    const detail::AuditRows rows = rows_by(one.map, 200);
    const detail::HypothesisFit fit = detail::fit_hypothesis(nominal, rows, {});
    const double score = weighted(fit.fit.residuals.score(), one.faults);
    if (!detail::plausible_residuals(nominal, rows, fit.fit.residuals) || (out && score >= best)) continue;
    best = score;
    out = FoundController{one.map,
                          ErrorStatistics::of(distances_from(fit.fit.residuals.position, Vector3::Zero())).median};
  }
  return out;
}

}  // namespace vernier
