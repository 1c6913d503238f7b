// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "vernier/calibration/detail/audit_rows.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/quantile.hpp"

namespace vernier::detail {

VERNIER_IMPL double outlier_limit(const VectorX& factors, double least) {
  // what the model lacks makes longer tails than noise has; more than a tenth of outliers, too, hence the bound
  constexpr double p90_of_normal = 2.5003;
  return least * std::clamp(quantile(factors, 0.9) / p90_of_normal, 1.0, 2.0);
}

VERNIER_IMPL void audit_single_rows(const AuditFit& geometry, const ConstVectorRef& stds, const AuditRows& rows,
                                    const std::vector<Index>& numbers, const RowOrigin& origin, double least_factor,
                                    std::vector<DataFinding>& findings) {
  const std::vector<LeftOut> left = leave_out_rows(geometry, stds, rows);
  std::vector<Index> wrong;
  VectorX by_position_factor(rows.size()), by_rotation_factor(rows.size());
  for (Index i = 0; i < rows.size(); ++i) {
    by_position_factor(i) = left[static_cast<std::size_t>(i)].position_factor;
    by_rotation_factor(i) = left[static_cast<std::size_t>(i)].rotation_factor;
  }
  const double factor = outlier_limit(by_position_factor, least_factor),
               rotation_limit = outlier_limit(by_rotation_factor, least_factor);
  for (Index i = 0; i < rows.size(); ++i) {
    const LeftOut& row = left[static_cast<std::size_t>(i)];
    if (row.position_factor > factor || row.rotation_factor > rotation_limit) wrong.push_back(i);
  }
  // which pairs fit when their poses are exchanged
  const auto exchanged = [&](Index joints, Index pose) {
    const Index index[] = {joints};
    const AuditResiduals r = audit_residuals(geometry.arm, rows.rows(index, pose - joints));
    const Vector3 error = point(r.position, 0),
                  weighted = left[static_cast<std::size_t>(joints)].position_weight * error;
    const bool fits = std::sqrt(error.dot(weighted)) < factor;
    const bool turned =
        rows.oriented() && point(r.rotation, 0).norm() > 2 * rotation_limit * geometry.residuals.rotation_scale;
    return fits && !turned;
  };
  std::vector<bool> paired(wrong.size(), false);
  if (wrong.size() <= 200)
    for (std::size_t a = 0; a < wrong.size(); ++a)
      for (std::size_t b = a + 1; b < wrong.size() && !paired[a]; ++b) {
        if (paired[b] || !exchanged(wrong[a], wrong[b]) || !exchanged(wrong[b], wrong[a])) continue;
        paired[a] = paired[b] = true;
        const Index first = numbers[static_cast<std::size_t>(wrong[a])],
                    second = numbers[static_cast<std::size_t>(wrong[b])];
        findings.push_back({FaultKind::swapped_rows,
                            -1,
                            {first, second},
                            left[static_cast<std::size_t>(wrong[a])].position,
                            message(origin.where({first, second}), ": their poses are exchanged: swap them")});
      }
  DataFinding outliers{FaultKind::outlier};
  bool by_position = false;
  double turn = 0;
  for (std::size_t k = 0; k < wrong.size(); ++k) {
    if (paired[k]) continue;
    const LeftOut& row = left[static_cast<std::size_t>(wrong[k])];
    outliers.rows.push_back(numbers[static_cast<std::size_t>(wrong[k])]);
    if (row.position_factor > factor) {
      by_position = true;
      outliers.size = (std::max)(outliers.size, row.position);
    }
    if (row.rotation_factor > rotation_limit) turn = (std::max)(turn, row.rotation);
  }
  if (outliers.rows.empty()) return;
  if (!by_position) outliers.size = turn;
  std::string by = by_position ? brief(outliers.size * 1e3) + " mm" : "";
  if (turn > 0) by += (by.empty() ? "" : " and ") + brief(turn * 180 / std::numbers::pi) + " deg";
  outliers.message = origin.where(outliers.rows) + ": the pose is not that of the joints, off by up to " + by +
                     ": check the entries, measure again or leave them out";
  findings.push_back(std::move(outliers));
}

VERNIER_IMPL void audit_duplicates(const MeasuredSet& data, const PointRows& rotation_vectors,
                                   std::vector<DataFinding>& findings) {
  const Index n = data.size();
  const auto before = [&](Index a, Index b) {
    for (Index c = 0; c < 3; ++c)
      if (!same_value((*data.positions())(a, c), (*data.positions())(b, c)))
        return (*data.positions())(a, c) < (*data.positions())(b, c);
    if (rotation_vectors.rows() == n)
      for (Index c = 0; c < 3; ++c)
        if (!same_value(rotation_vectors(a, c), rotation_vectors(b, c)))
          return rotation_vectors(a, c) < rotation_vectors(b, c);
    return false;
  };
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return before(a, b) || (a < b && !before(b, a)); });
  std::vector<DataFinding> found;
  for (std::size_t a = 0; a < order.size();) {
    std::size_t b = a + 1;
    while (b < order.size() && !before(order[a], order[b])) ++b;
    if (b - a > 1) {
      DataFinding finding{
          FaultKind::duplicate_rows,
          -1,
          {order.begin() + static_cast<std::ptrdiff_t>(a), order.begin() + static_cast<std::ptrdiff_t>(b)}};
      bool same = true;
      for (const Index row : finding.rows)
        for (Index j = 0; j < data.joints.cols(); ++j)
          same = same && same_value(data.joints(row, j), data.joints(finding.rows.front(), j));
      finding.message = data.origin.where(finding.rows) +
                        (same ? ": joints and pose are the same in all digits: leave out all but one"
                              : ": the same pose in all digits at different joints: the sensor was not read again, "
                                "measure these rows again or leave them out");
      found.push_back(std::move(finding));
    }
    a = b;
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.rows < b.rows; });
  findings.insert(findings.end(), found.begin(), found.end());
}

VERNIER_IMPL void audit_joint_values(const MatrixX& joints, std::vector<DataFinding>& findings) {
  std::vector<int> read;
  double scatter = 0;
  for (int j = 0; j < static_cast<int>(joints.cols()); ++j) {
    std::vector<double> values(VERNIER_LATER(joints).col(j).begin(), VERNIER_LATER(joints).col(j).end()), gaps;
    std::sort(values.begin(), values.end());
    for (std::size_t k = 0; k + 1 < values.size(); ++k) gaps.push_back(values[k + 1] - values[k]);
    const std::vector<double> in_order = gaps;
    std::sort(gaps.begin(), gaps.end());
    // readings of one command lie close together, three or more commands far apart
    for (std::size_t k = gaps.size() * 2 / 5; k + 2 < gaps.size(); ++k) {
      if (gaps[k + 1] < 4 * gaps[k] || gaps[k / 2] < 1e-9) continue;
      double width = 0, widest = 0;
      for (const double gap : in_order) {
        width = gap > gaps[k] ? 0 : width + gap;
        widest = (std::max)(widest, width);
      }
      if (widest > 0.2 * gaps[k + 1] || widest > 0.02) continue;
      read.push_back(j);
      scatter = (std::max)(scatter, widest);
      break;
    }
  }
  if (read.empty()) return;
  std::string names;
  for (std::size_t k = 0; k < read.size(); ++k)
    names += message(k == 0 ? "" : k + 1 == read.size() ? " and " : ", ", read[k] + 1);
  findings.push_back({FaultKind::joints_read,
                      read.size() == 1 ? read.front() : -1,
                      {},
                      scatter,
                      message("all rows: values of joint", read.size() == 1 ? " " : "s ", names,
                              " scatter about repeated commands: they were read, not commanded: a model fitted to "
                              "them corrects readings, use the commands if commands are to be corrected")});
}

VERNIER_IMPL void audit_approaches(const MeasuredSet& data, std::vector<DataFinding>& findings) {
  if (data.previous.rows() == 0) return;
  for (int j = 0; j < data.joints.cols(); ++j) {
    Index up = 0, down = 0;
    for (Index i = 0; i < data.size(); ++i) {
      const double move = data.joints(i, j) - data.previous(i, j);
      if (move > 1e-6) ++up;
      if (move < -1e-6) ++down;
    }
    if ((std::min)(up, down) > 0 || (std::max)(up, down) < 25) continue;
    findings.push_back({FaultKind::approach_never_varies,
                        j,
                        {},
                        0,
                        message("all rows: joint ", j + 1, " always comes from ", up > 0 ? "below" : "above",
                                ": its hysteresis cannot be told from its zero, approach some poses from the other "
                                "side if commands will be")});
  }
}

}  // namespace vernier::detail
