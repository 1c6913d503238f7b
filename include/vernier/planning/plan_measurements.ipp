// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/planning/plan_measurements.hpp"

namespace vernier {

VERNIER_IMPL Index PlannedMeasurements::enough(double share) const {
  const auto n = static_cast<Index>(chosen.size());
  constexpr Index ahead = 10;
  for (Index k = 0; k + ahead <= n; ++k)
    if (relative_error(k + ahead) > (1 - share) * relative_error(k)) return k;
  return n;
}

namespace detail {

/// Bins of each joint between the smallest and the largest value of the candidates.
class JointBins {
 public:
  VERNIER_LOCAL JointBins(const MatrixX& candidates, double width) : width_(width), lower_(candidates.cols()) {
    first_.push_back(0);
    for (Index j = 0; j < candidates.cols(); ++j) {
      lower_(j) = VERNIER_LATER(candidates).col(j).minCoeff();
      const double range = VERNIER_LATER(candidates).col(j).maxCoeff() - lower_(j);
      first_.push_back(first_.back() + (std::max)(1, static_cast<int>(std::ceil(range / width - 1e-9))));
    }
  }

  int size() const { return first_.back(); }
  /// Bin of a value of joint j; -1 outside all.
  VERNIER_LOCAL int of(Index j, double q) const {
    const int begin = first_[static_cast<std::size_t>(j)], end = first_[static_cast<std::size_t>(j) + 1];
    const double at = (q - lower_(j)) / width_;
    if (!(at >= 0) || at > end - begin + 1e-9) return -1;
    return begin + (std::min)(static_cast<int>(at), end - begin - 1);
  }
  /// Bins of all joints of some configurations.
  VERNIER_LOCAL Eigen::MatrixXi of_rows(const MatrixX& joints) const {
    Eigen::MatrixXi out(joints.rows(), joints.cols());
    for (Index i = 0; i < out.rows(); ++i)
      for (Index j = 0; j < out.cols(); ++j) out(i, j) = of(j, joints(i, j));
    return out;
  }
  VERNIER_LOCAL UncoveredBin named(int bin) const {
    int joint = 0;
    while (bin >= first_[static_cast<std::size_t>(joint) + 1]) ++joint;
    const double from = lower_(joint) + width_ * (bin - first_[static_cast<std::size_t>(joint)]);
    return {joint, {from, from + width_}};
  }

 private:
  double width_;
  VectorX lower_;
  std::vector<int> first_;
};

/// Three of some points that register a frame best: the two farthest apart, and the one farthest from their line.
VERNIER_LOCAL std::vector<Index> registering_points(const PointRows& points) {
  const Index n = points.rows();
  if (n < 3) return {};
  std::vector<Index> out{0, 1, 2};
  double farthest = -1;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j)
      if (const double d = (point(points, i) - point(points, j)).squaredNorm(); d > farthest) {
        farthest = d;
        out = {j, i, 0};
      }
  const Vector3 from = point(points, out[0]), along = point(points, out[1]) - from;
  farthest = -1;
  for (Index i = 0; i < n; ++i) {
    if (i == out[0] || i == out[1]) continue;
    const Vector3 arm = point(points, i) - from;
    const double d = along.cross(arm).squaredNorm();
    if (!(d > farthest)) continue;
    farthest = d;
    out[2] = i;
  }
  return out;
}

/// Visits of the chosen configurations, see `PlannedMeasurements`.
VERNIER_LOCAL std::vector<Index> planned_visits(const MatrixX& joints, const PointRows& positions,
                                                const PlanOptions& options) {
  std::vector<Index> first = registering_points(positions);
  const auto fixed = static_cast<Index>(first.size());
  std::vector<Index> rows = first;
  for (Index i = 0; i < joints.rows(); ++i)
    if (std::find(first.begin(), first.end(), i) == first.end()) rows.push_back(i);
  const auto sweeps = [&](const Progress&) { return options.observer({joints.rows(), 0, 0}); };
  std::vector<Index> order = visiting_order(rows_of(joints, rows), options.speeds, fixed, sweeps);
  for (Index& visit : order) visit = rows[static_cast<std::size_t>(visit)];
  return with_check_visits(order, options.check_every);
}

/// What candidates, measurements of before and the region tell about the unknowns.
struct PlanRows {
  CandidateRows candidates;
  MatrixX measured, region;
};

/// @throws PlanningStopped where the observer requests a stop
VERNIER_LOCAL PlanRows plan_rows(const ArmGeometry& nominal, const PlanInput& input, const PlanOptions& options) {
  const PlannedCalibration planned{nominal,         options.geometry, options.errors,
                                   options.sensors, options.oriented, options.count + input.measured.rows()};
  PlanRows out{expected_candidate_rows(planned, input.candidates, input.candidates_previous, options.observer),
               MatrixX(), MatrixX()};
  out.measured.resize(0, out.candidates.unknowns());
  if (input.measured.rows() > 0)
    out.measured = expected_rows(planned, input.measured, input.measured_previous, options.observer);

  constexpr Index region_points = 150;
  const MatrixX& of_region = input.region.rows() > 0 ? input.region : input.candidates;
  const Index stride = std::max<Index>(1, of_region.rows() / region_points);
  std::vector<Index> some;
  for (Index i = 0; i < of_region.rows(); i += stride) some.push_back(i);
  PlannedCalibration positions = planned;
  positions.oriented = false;
  out.region = options.sensors.position_sigma * expected_rows(positions, rows_of(of_region, some), MatrixX());
  return out;
}

VERNIER_IMPL PlannedMeasurements plan_measurements(const ArmGeometry& nominal, const PlanInput& input,
                                                   const PlanOptions& options) {
  options.errors.validate();
  options.sensors.validate();
  const Index n = input.candidates.rows();
  demand(options.count >= 1, "plan_measurements: count is ", options.count, ", must be at least 1");
  demand(n >= options.count, "plan_measurements: ", n, " candidates for ", options.count, " measurements");
  demand(input.candidates_previous.rows() == 0 || input.candidates_previous.rows() == n,
         "plan_measurements: ", input.candidates_previous.rows(), " approaches for ", n, " candidates");
  demand(all_finite(input.candidates) && all_finite(input.measured) && all_finite(input.region),
         "plan_measurements: a joint value is not finite");
  demand(options.bin > 0, "plan_measurements: bin is ", options.bin, ", must be positive");
  demand(options.criterion != DesignCriterion::region_variance || input.region.rows() > 0,
         "plan_measurements: no region whose variance could be reduced");
  PlanRows rows;
  try {
    rows = plan_rows(nominal, input, options);
  } catch (const PlanningStopped&) {
    return {};
  }

  const JointBins bins(input.candidates, options.bin);
  PoseDesignOptions design{.count = options.count, .criterion = options.criterion, .observer = options.observer};
  const Eigen::MatrixXi bins_of = bins.of_rows(input.candidates);
  Eigen::VectorXi wanted = Eigen::VectorXi::Zero(bins.size());
  for (Index c = 0; c < bins_of.size(); ++c) wanted(bins_of.data()[c]) = (std::max)(1, options.bin_count);
  const Eigen::MatrixXi bins_measured = bins.of_rows(input.measured);
  for (Index c = 0; c < bins_measured.size(); ++c)
    if (const int bin = bins_measured.data()[c]; bin >= 0) wanted(bin) = (std::max)(0, wanted(bin) - 1);
  if (options.bin_count > 0) design.coverage = {bins_of, wanted};
  const PoseDesign found = design_poses(rows.candidates, design, rows.measured, rows.region);

  PlannedMeasurements out;
  out.chosen = found.chosen;
  out.unknowns = rows.candidates.unknowns();
  out.log_det = found.log_det;
  if (out.chosen.empty()) return out;
  const VectorX relative = found.region_variance / found.region_variance(static_cast<Index>(out.chosen.size()));
  out.relative_error = VERNIER_LATER(relative).cwiseSqrt();
  if (options.bound_iterations > 0 && rows.measured.rows() == 0)
    out.bound = information_bound(VERNIER_LATER(rows.candidates.columns(0, n)).transpose(), rows.candidates.block,
                                  options.count, options.bound_iterations);
  for (const Index c : out.chosen)
    for (Index j = 0; j < bins_of.cols(); ++j) wanted(bins_of(c, j)) = 0;
  if (options.bin_count > 0) wanted = found.missing;
  for (int bin = 0; bin < bins.size(); ++bin)
    if (wanted(bin) > 0) out.uncovered.push_back(bins.named(bin));
  const MatrixX joints = rows_of(input.candidates, out.chosen);
  out.visits = planned_visits(joints, nominal.positions(joints), options);
  return out;
}

VERNIER_IMPL MatrixX admitted_joints(const MeasurementScene& scene, const VectorX& lower, const VectorX& upper, Index n,
                                     std::uint64_t seed, RejectionCounts& rejected, const ObserverRef& observer) {
  demand(n >= 1, "sample_candidates: ", n, " candidates requested");
  bool usable = all_finite(lower) && all_finite(upper);
  const Index joints = scene.controller().joints(static_cast<int>(lower.size()));
  for (Index j = 0; j < joints; ++j) usable = usable && lower(j) < upper(j);
  demand(usable, "sample_candidates: the joint limits are not finite, or empty");
  Rng rng(seed);
  MatrixX out(n, lower.size()), shown(1, joints);
  constexpr Index attempts = 1000;
  Index tried = 0;
  for (Index i = 0; i < n;) {
    if (!observer({0, i, 0})) {
      rejected[0] = 0;
      return VERNIER_LATER(out).topRows(i);
    }
    for (Index j = 0; j < joints; ++j) shown(0, j) = rng.uniform(lower(j), upper(j));
    const MatrixX drawn = scene.controller().to_chain(shown);
    for (Index j = 0; j < lower.size(); ++j) out(i, j) = drawn(0, j);
    const Rejection reason = scene.rejection(row_of(out, i));
    ++rejected[static_cast<std::size_t>(reason)];
    if (reason == Rejection::none) ++i;
    ++tried;
    if (tried < attempts * (i + 1)) continue;
    const auto most = std::max_element(rejected.begin() + 1, rejected.end());
    demand(false, "sample_candidates: of ", tried, " configurations ", i, " can be measured; of the others ", *most,
           " are ", name_of(static_cast<Rejection>(most - rejected.begin())));
  }
  rejected[0] = 0;
  return out;
}

}  // namespace detail

}  // namespace vernier
