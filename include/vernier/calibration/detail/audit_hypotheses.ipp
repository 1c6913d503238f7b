// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "vernier/calibration/detail/audit_hypotheses.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string convention_name(int convention) {
  switch (convention) {
    case 1: return "rotation vectors of the inverse rotation";
    case 2: return "rotation vectors in degrees";
    case 3: return "roll, pitch and yaw angles in radians (about fixed x, y, z)";
    case 4: return "roll, pitch and yaw angles in degrees (about fixed x, y, z)";
    case 5: return "Euler angles in radians (about moving x, y, z)";
    case 6: return "Euler angles in degrees (about moving x, y, z)";
    default: return "rotation vectors";
  }
}

VERNIER_LOCAL Matrix3 rotation_by_convention(int convention, const Vector3& v) {
  const Vector3 angles = convention % 2 == 0 ? Vector3(v * std::numbers::pi / 180) : v;
  if (convention == 1) return VERNIER_LATER(exp_so3(v)).transpose();
  if (convention == 2) return exp_so3(angles);
  const Matrix3 x = exp_so3(Vector3(angles(0), 0, 0)), y = exp_so3(Vector3(0, angles(1), 0)),
                z = exp_so3(Vector3(0, 0, angles(2)));
  const bool fixed = convention <= 4;
  const Matrix3 first = (fixed ? z : x) * y;
  return first * (fixed ? x : z);
}

VERNIER_IMPL int AuditHypothesis::faults() const {
  return static_cast<int>(reversed.size()) + static_cast<int>(couplings.size()) -
         static_cast<int>(std::count(couplings.begin(), couplings.end(), 0.0));
}

VERNIER_IMPL AuditRows AuditHypothesis::corrected(const AuditRows& rows, const ArmGeometry& arm) const {
  AuditRows out = rows;
  if (!kind) return out;
  switch (*kind) {
    case FaultKind::length_unit:
      for (Index i = 0; i < out.size(); ++i) set_point(out.positions, i, point(out.positions, i) / factor);
      break;
    case FaultKind::joint_unit:
      for (int j = 0; j < arm.joints(); ++j)
        if (arm.chain().revolute(j)) VERNIER_LATER(out.joints).col(j) /= factor;
      break;
    case FaultKind::joint_sign:
    case FaultKind::joint_coupling:
      for (int j = static_cast<int>(couplings.size()) - 1; j > 0; --j)  // the joints before are still as they were
        VERNIER_LATER(out.joints).col(j) -=
            couplings[static_cast<std::size_t>(j)] * VERNIER_LATER(out.joints).col(j - 1);
      for (const int j : reversed) VERNIER_LATER(out.joints).col(j) *= -1;
      break;
    case FaultKind::mirrored_frame: {
      const bool turned = convention == 3;  // the orientations are mirrored, too
      for (Index i = 0; i < out.size(); ++i) out.positions(i, turned ? 0 : convention) *= -1;
      if (!turned) break;
      for (Matrix3& r : out.orientations)
        for (Index k = 1; k < 3; ++k) {
          r(0, k) = -r(0, k);
          r(k, 0) = -r(k, 0);
        }
      break;
    }
    case FaultKind::orientation_convention:
      for (std::size_t i = 0; i < out.orientations.size(); ++i)
        out.orientations[i] = rotation_by_convention(convention, point(rows.rotation_vectors, static_cast<Index>(i)));
      break;
    default: break;
  }
  return out;
}

VERNIER_IMPL std::vector<Index> spread_rows(Index rows, Index count) {
  const Index n = (std::min)(rows, count);
  std::vector<Index> out(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) out[static_cast<std::size_t>(i)] = i * rows / n;
  return out;
}

VERNIER_IMPL HypothesisFit fit_hypothesis(const ArmGeometry& nominal, const AuditRows& rows,
                                          const AuditHypothesis& hypothesis) {
  const AuditRows corrected = hypothesis.corrected(rows, nominal);
  VectorX stds = audit_frames_std(nominal, rows.oriented()), values = nominal.parameters();
  const VectorX centre = values;
  const bool zero = hypothesis.kind == FaultKind::joint_zero;
  const Index parameter = zero ? zero_parameter(nominal, hypothesis.joint) : 0;
  if (zero) {
    stds(parameter) = std::numeric_limits<double>::infinity();
    values(parameter) += hypothesis.zero;
  }
  const ArmGeometry start = starting_frames(nominal.with_parameters(values), corrected.measured(), true, true);
  HypothesisFit out{hypothesis, audit_fit(start, centre, stds, corrected, 20)};
  if (zero) out.zero = out.fit.arm.parameters()(parameter) - centre(parameter);
  return out;
}

VERNIER_IMPL double point_scatter(const PointRows& points) {
  return robust_scale(rows_minus(points, centroid(points)));
}

VERNIER_IMPL bool plausible_residuals(const ArmGeometry& nominal, const AuditRows& rows,
                                      const AuditResiduals& residuals) {
  const double scatter = (std::min)(point_scatter(nominal.positions(rows.joints)), point_scatter(rows.positions));
  return residuals.score() <= (std::max)(0.05 * scatter, 0.01);
}

VERNIER_IMPL std::vector<bool> parallel_to_previous(const ArmGeometry& arm) {
  std::vector<bool> out(static_cast<std::size_t>(arm.joints()), false);
  const VectorX parameters = arm.parameters();
  for (int j = 1; j < arm.joints(); ++j) {
    const double alpha = parameters(ArmParameters::of_row(j - 1, DhParameter::alpha));
    out[static_cast<std::size_t>(j)] =
        arm.chain().revolute(j - 1) && arm.chain().revolute(j) && std::abs(std::sin(alpha)) < 1e-6;
  }
  return out;
}

VERNIER_IMPL void for_all_couplings(const std::vector<bool>& may_be, FunctionRef<void(const std::vector<double>&)> f) {
  std::vector<double> now(may_be.size(), 0.0);
  for (std::size_t j = 0; j < now.size();) {
    if (j == 0) f(now);
    if (!may_be[j] || now[j] < 0) {  // counts 0, 1, -1; a joint at its end carries over
      now[j++] = 0;
      continue;
    }
    now[j] = now[j] > 0 ? -1 : 1;
    j = 0;
  }
}

/// The patterns of signs and couplings that fit best after registration in closed form, best first.
VERNIER_LOCAL std::vector<AuditHypothesis> best_patterns(const ArmGeometry& nominal, const AuditRows& rows) {
  constexpr std::size_t kept = 8;
  if (nominal.joints() > max_arm_joints) return {};  // too many patterns
  const AuditRows sample = rows.rows(spread_rows(rows.size(), 60));
  std::vector<std::pair<double, AuditHypothesis>> all;
  for_all_couplings(parallel_to_previous(nominal), [&](const std::vector<double>& couplings) {
    const bool coupled =
        std::any_of(couplings.begin(), couplings.end(), [](double factor) { return factor < 0 || factor > 0; });
    for (unsigned signs = coupled ? 0 : 1; signs < 1u << nominal.joints(); ++signs) {
      AuditHypothesis pattern{.kind = coupled ? FaultKind::joint_coupling : FaultKind::joint_sign};
      if (coupled) pattern.couplings = couplings;
      for (int j = 0; j < nominal.joints(); ++j)
        if ((signs >> j & 1u) != 0) pattern.reversed.push_back(j);
      const AuditRows corrected = pattern.corrected(sample, nominal);
      const ArmGeometry arm = starting_frames(nominal, corrected.measured(), true, true);
      all.emplace_back(pattern.simplicity() * audit_residuals(arm, corrected).score(), std::move(pattern));
    }
  });
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<AuditHypothesis> out;
  for (std::size_t k = 0; k < all.size() && k < kept; ++k) out.push_back(std::move(all[k].second));
  return out;
}

VERNIER_IMPL HypothesisFit best_hypothesis(const ArmGeometry& nominal, const AuditRows& rows, double smallest_zero) {
  HypothesisFit best = fit_hypothesis(nominal, rows, {});
  const double none = best.fit.residuals.score();
  const bool plausible_as_is = plausible_residuals(nominal, rows, best.fit.residuals);
  const auto attempt = [&](const AuditHypothesis& hypothesis) {
    HypothesisFit fit = fit_hypothesis(nominal, rows, hypothesis);
    if (hypothesis.kind == FaultKind::joint_zero && nominal.chain().revolute(hypothesis.joint)) {
      fit.zero = std::remainder(fit.zero, 2 * std::numbers::pi);
      if (std::abs(fit.zero) < smallest_zero) return;
    }
    // half a turn of a joint's zero may be the same as another joint's sign, which is simpler; so is one fault than two
    const auto weight = [](const HypothesisFit& of) {
      return std::abs(of.zero) > 0.5 ? 2.5 : of.hypothesis.simplicity();
    };
    // in the unit of the measured positions: dividing lengths makes residuals small, too
    const auto score = [](const HypothesisFit& of) {
      return of.fit.residuals.score() * (of.hypothesis.kind == FaultKind::length_unit ? of.hypothesis.factor : 1.0);
    };
    if (score(fit) < 0.5 * none && weight(fit) * score(fit) < weight(best) * score(best)) best = std::move(fit);
  };
  const double expected = point_scatter(nominal.positions(rows.joints)), measured = point_scatter(rows.positions);
  const bool gross = none > 0.02 * (std::min)(expected, measured);
  if (gross) {
    for (const double factor : {1000.0, 100.0, 1000 / 25.4, 25.4, 10.0, 0.1, 1 / 25.4, 25.4e-3, 0.01, 0.001})
      if (const double ratio = measured / expected / factor; ratio > 0.3 && ratio < 3)
        attempt({.kind = FaultKind::length_unit, .factor = factor});
    for (const double factor : {180 / std::numbers::pi, std::numbers::pi / 180})
      attempt({.kind = FaultKind::joint_unit, .factor = factor});
  }
  for (int j = 0; j < nominal.joints(); ++j) {
    attempt({.kind = FaultKind::joint_sign, .reversed = {j}});
    if (j == 0 || j + 1 == nominal.joints()) continue;  // the frames absorb these zeros
    attempt({.kind = FaultKind::joint_zero, .joint = j});
    if (gross && nominal.chain().revolute(j))
      for (const double zero : {-0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.0})
        attempt({.kind = FaultKind::joint_zero, .joint = j, .zero = zero * std::numbers::pi});
  }
  attempt({.kind = FaultKind::mirrored_frame});
  if (rows.oriented()) {
    for (int axis = 1; axis <= 3; ++axis) attempt({.kind = FaultKind::mirrored_frame, .convention = axis});
    for (int convention = 1; convention <= 6; ++convention)
      attempt({.kind = FaultKind::orientation_convention, .convention = convention});
  }
  if (gross)
    for (const AuditHypothesis& pattern : best_patterns(nominal, rows)) attempt(pattern);
  best.plausible = plausible_residuals(nominal, best.hypothesis.corrected(rows, nominal), best.fit.residuals);
  best.plausible_as_is = plausible_as_is;
  return best;
}

VERNIER_IMPL std::optional<RowShift> find_shift(const ArmGeometry& nominal, const AuditRows& rows, double best_score) {
  constexpr Index most = 3;
  const Index n = rows.size();
  const auto range = [&](Index first, Index end) {
    std::vector<Index> all;
    for (const Index k : spread_rows(end - first, 200)) all.push_back(first + k);
    return all;
  };
  const double spread = point_scatter(rows.positions);
  std::optional<HypothesisFit> best;
  for (const auto& [first, end] : {std::pair<Index, Index>{0, n}, {0, n / 2}, {n / 2, n}, {n / 4, 3 * n / 4}})
    for (Index shift = -most; shift <= most; ++shift) {
      const std::vector<Index> block = range((std::max)(first, -shift), (std::min)(end, n - shift));
      if (block.size() < 8) continue;
      HypothesisFit fit = fit_hypothesis(nominal, rows.rows(block, shift), {});
      if (!best || fit.fit.residuals.score() < best->fit.residuals.score()) best = std::move(fit);
    }
  if (!best || best->fit.residuals.score() > (std::min)(0.1 * spread, 1.5 * best_score)) return std::nullopt;

  // cost of each row under each shift, capped where it does not fit at all
  const double limit = 8 * best->fit.residuals.score();
  MatrixX cost = MatrixX::Ones(n, 2 * most + 1);
  for (Index shift = -most; shift <= most; ++shift) {
    std::vector<Index> all;
    for (Index i = std::max<Index>(0, -shift); i < (std::min)(n, n - shift); ++i) all.push_back(i);
    if (all.empty()) continue;
    const AuditResiduals residuals = audit_residuals(best->fit.arm, rows.rows(all, shift));
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto row = static_cast<Index>(k);
      double size = point(residuals.position, row).norm();
      if (rows.oriented()) size = (std::max)(size, 0.25 * point(residuals.rotation, row).norm());
      cost(all[k], shift + most) = (std::min)(1.0, std::pow(size / limit, 2));
    }
  }
  const double unshifted = VERNIER_LATER(cost).col(most).sum();
  double least = std::numeric_limits<double>::infinity();
  Index before = 0, after = 0, change = 0;
  for (Index a = 0; a <= 2 * most; ++a)
    for (Index b = 0; b <= 2 * most; ++b) {
      if (a == b) {
        if (const double sum = VERNIER_LATER(cost).col(a).sum(); sum < least)
          least = sum, before = after = a, change = 0;
        continue;
      }
      double sum = VERNIER_LATER(cost).col(b).sum();
      for (Index r = 0; r < n; ++r) {
        if (r > 0 && sum < least - 1e-9) least = sum, before = a, after = b, change = r;
        sum += cost(r, a) - cost(r, b);
      }
    }
  if ((before == most && after == most) || least > unshifted - 5 || least > 0.3 * static_cast<double>(n))
    return std::nullopt;
  RowShift out;
  out.score = best->fit.residuals.score();
  const bool whole = before == after, tail = after != most;
  out.first = whole || !tail || before != most ? 0 : change;
  out.end = whole || tail ? n : change;
  out.shift = (tail ? after : before) - most;
  for (Index i = 0; i < n; ++i) {
    const Index shift = (i < change ? before : after) - most;
    if (i + shift < 0 || i + shift >= n) continue;
    // next to the change a pose may be missing
    if (!whole && std::abs(i - change) <= most + 1 && cost(i, shift + most) >= 1) continue;
    out.fitting.push_back(i);
    out.shifts.push_back(shift);
  }
  return out;
}

}  // namespace vernier::detail
