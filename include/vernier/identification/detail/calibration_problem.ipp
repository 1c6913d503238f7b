// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/same_pose.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/twists.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"

namespace vernier::detail {

VERNIER_IMPL CalibrationProblem::CalibrationProblem(ArmParameterisation start, std::vector<MeasuredSet> sets, Loss loss,
                                                    double joint_sigma)
    : arm(std::move(start)), sets_(std::move(sets)), joint_sigma_(joint_sigma), loss_(loss) {
  for (std::size_t s = 0; s < sets_.size(); ++s)
    for (Index i = 0; i < sets_[s].size(); ++i) blocks_.push_back({static_cast<int>(s), i, {1, 1}});
  for (const MeasuredSet& set : sets_)
    if (set.locates()) validation_blocks_ += set.size();
  if (validation_blocks_ == 0) validation_blocks_ = num_blocks();
  std::vector<JointType> types;
  for (int j = 0; j < arm.geometry(0).joints(); ++j)
    types.push_back(arm.geometry(0).chain().revolute(j) ? JointType::revolute : JointType::prismatic);
  poses_ = pose_numbers(VERNIER_LATER(joints()).topRows(validation_blocks_), {.joint_types = types});
  for (const Index pose : poses_) validation_poses_ = (std::max)(validation_poses_, pose + 1);
  if (validation_poses_ == validation_blocks_) poses_.clear();
  for (const MeasuredSet& set : sets_)
    demand(!set.correlated() || set.seen_from.rows() == 0, set.name,
           ": between two configurations a sensor has no covariances");
  for (const MeasuredSet& set : sets_)
    demand(same_value(joint_sigma, 0) || set.seen_from.rows() == 0, set.name,
           ": errors of joint readings are not estimated between two configurations");
}

VERNIER_IMPL BlockSystem CalibrationProblem::system() const {
  BlockSystem out{num_blocks(), num_validation_blocks(), arm.num_dense(), arm.group_sizes(), *this};
  out.poses = poses_;
  if (drift.empty()) return out;
  out.local_size = drift_scale_.size();
  for (std::size_t s = 0; s < drift.size(); ++s)
    if (place_of(s) == s) out.local_states += drift[s].knots.cols();
  return out;
}

VERNIER_IMPL NormalEquations CalibrationProblem::normal_equations(const NormalEquations* same_functions) const {
  NormalEquations out(system(), drift_priors(), executor, same_functions);
  if (prior) out.add(*prior, arm.steps());
  return out;
}

VERNIER_IMPL Index CalibrationProblem::measured_values() const {
  Index sum = 0;
  for (const MeasuredSet& set : sets_) sum += set.values() * set.size();
  return sum;
}

VERNIER_IMPL MatrixX CalibrationProblem::joints() const {
  MatrixX out(num_blocks(), arm.geometry(0).joints());
  Index at = 0;
  for (const MeasuredSet& set : sets_) {
    VERNIER_LATER(out).middleRows(at, set.size()) = set.joints;
    at += set.size();
  }
  return out;
}

VERNIER_IMPL CalibrationProblem::Temperatures CalibrationProblem::temperatures() const {
  std::vector<double> all;
  for (const MeasuredSet& set : sets_) {
    if (!set.locates()) continue;
    if (set.temperatures.size() == 0) return {};
    all.insert(all.end(), set.temperatures.begin(), set.temperatures.end());
  }
  if (all.empty()) return {};
  const auto n = static_cast<double>(all.size());
  const double mean = std::accumulate(all.begin(), all.end(), 0.0) / n;
  double squares = 0;
  for (const double value : all) squares += (value - mean) * (value - mean);
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  return {mean, std::sqrt(squares / n), {*low, *high}};
}

VERNIER_IMPL void CalibrationProblem::start_drift(Index rows_per_knot) {
  drift.assign(sets_.size(), {});
  first_state_.assign(sets_.size(), 0);
  Index states = 0;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    first_state_[s] = states;
    if (!sets_[s].locates()) continue;
    if (const std::size_t first = place_of(s); first != s) {
      first_state_[s] = first_state_[first];
      drift[s] = drift[first];
      continue;
    }
    Index rows = 0;
    double begin = std::numeric_limits<double>::infinity(), end = -begin;
    bool timed = true;
    Vector3 sum = Vector3::Zero();
    for (std::size_t of = s; of < sets_.size(); ++of) {
      const MeasuredSet& set = sets_[of];
      if (!set.locates() || place_of(of) != s) continue;
      timed = timed && set.times.size() > 0;
      if (!timed) break;
      begin = (std::min)(begin, VERNIER_LATER(set.times).minCoeff());
      end = (std::max)(end, VERNIER_LATER(set.times).maxCoeff());
      sum += static_cast<double>(set.size()) *
             (set.positions() != nullptr ? centroid(*set.positions())
                                         : centroid(positions_of(arm.poses(static_cast<int>(of), set.joints))));
      rows += set.size();
    }
    if (!timed || !(end > begin)) continue;
    const Index intervals = std::max<Index>(1, rows / rows_per_knot);
    const Vector3 centre = sum / static_cast<double>(rows);
    drift[s] = {begin, (end - begin) / static_cast<double>(intervals), centre, {}};
    drift[s].knots.setZero(6, intervals + 1);
    states += intervals + 1;
  }
  const double root = std::sqrt(static_cast<double>(rows_per_knot) / 200);
  drift_scale_.resize(6);
  for (Index k = 0; k < 6; ++k) drift_scale_(k) = (k < 3 ? 0.03e-3 : 20e-6) * root;
}

VERNIER_IMPL void CalibrationProblem::start_joint_drift() {
  const Index joints = arm.geometry(0).joints();
  for (SessionDrift& of_station : drift)
    if (!of_station.empty()) {
      of_station.knots.conservativeResize(6 + joints, Eigen::NoChange);
      VERNIER_LATER(of_station.knots).bottomRows(joints).setZero();
    }
  const double step = drift_scale_(3) / 2;  // half of the base's rotation
  drift_scale_.conservativeResize(6 + joints);
  VERNIER_LATER(drift_scale_).tail(joints).setConstant(step);
}

VERNIER_IMPL void CalibrationProblem::stop_joint_drift() {
  drift_scale_.conservativeResize(6);
  for (SessionDrift& of_station : drift)
    if (!of_station.empty()) of_station.knots.conservativeResize(6, Eigen::NoChange);
}

VERNIER_IMPL std::vector<LocalPrior> CalibrationProblem::drift_priors() const {
  std::vector<LocalPrior> out;
  MatrixX walk = MatrixX::Zero(drift_scale_.size(), drift_scale_.size());
  for (Index k = 0; k < walk.cols(); ++k) walk(k, k) = k < 6 ? drift_precision : joint_drift_precision;
  const MatrixX anchor = 0.01 * walk, coupling = -1.0 * walk;
  for (std::size_t s = 0; s < drift.size(); ++s)
    for (Index k = 0; k < drift[s].knots.cols() && place_of(s) == s; ++k) {
      const Index state = first_state_[s] + k;
      out.push_back({state, state, anchor});
      if (k == 0) continue;
      out.push_back({state, state, walk});
      out.push_back({state - 1, state - 1, walk});
      out.push_back({state, state - 1, coupling});
    }
  return out;
}

VERNIER_IMPL VectorX CalibrationProblem::drift_steps() const {
  const Index states = system().local_states;
  const Index size = drift_scale_.size();
  VectorX out(size * states);
  for (std::size_t s = 0; s < drift.size(); ++s)
    for (Index k = 0; k < drift[s].knots.cols(); ++k)
      for (Index r = 0; r < size; ++r) out(size * (first_state_[s] + k) + r) = drift[s].knots(r, k) / drift_scale_(r);
  return out;
}

VERNIER_IMPL void CalibrationProblem::move_drift(const VectorX& steps) {
  const Index size = drift_scale_.size();
  for (std::size_t s = 0; s < drift.size(); ++s)
    for (Index k = 0; k < drift[s].knots.cols(); ++k)
      for (Index r = 0; r < size; ++r)
        drift[s].knots(r, k) += steps(size * (first_state_[s] + k) + r) * drift_scale_(r);
}

VERNIER_IMPL VectorX CalibrationProblem::drift_step_variance(double noise_variance) const {
  VectorX out(drift_scale_.size());
  for (Index k = 0; k < out.size(); ++k)
    out(k) = drift_scale_(k) * drift_scale_(k) *
             (std::max)(1.0, noise_variance / (k < 6 ? drift_precision : joint_drift_precision));
  return out;
}

VERNIER_IMPL VectorX CalibrationProblem::drift_joint_zeros(Index block) const {
  const auto s = static_cast<std::size_t>(at(block).station);
  if (drift.empty() || drift[s].empty()) return {};
  return drift[s].joint_zeros(sets_[s].times(at(block).row));
}

VERNIER_IMPL Isometry3 CalibrationProblem::drift_motion(Index block) const {
  const auto s = static_cast<std::size_t>(at(block).station);
  if (drift.empty() || drift[s].empty()) return Isometry3::Identity();
  return drift[s].motion(sets_[s].times(at(block).row));
}

VERNIER_IMPL void CalibrationProblem::add_drift(const Block& block, Isometry3& pose, RowBlock& rows) const {
  const auto s = static_cast<std::size_t>(block.station);
  if (drift.empty() || drift[s].empty()) return;
  const double time = sets_[s].times(block.row);
  const Isometry3 motion = drift[s].motion(time);
  const Index joints = drift_scale_.size() - 6;
  if (joints > 0) {
    const VectorX zeros = drift[s].joint_zeros(time);
    Vector6 shift = Vector6::Zero();  // tiny, so it adds up
    for (Index j = 0; j < joints; ++j)
      for (Index r = 0; r < 6; ++r) shift(r) += rows.factor(r, j) * zeros(j);
    pose = shifted(pose, shift);
  }
  const Vector3 lever = translation(pose) - drift[s].centre;
  pose = composed(motion, pose);
  const Matrix3 turn = rotation(motion);
  turn_columns(turn, rows.dense);
  turn_columns(turn, rows.factor);
  const Matrix6 of_base = effect_of_twist(lever);
  const auto [knot, share] = drift[s].position(time);
  for (std::size_t k = 0; k < 2 && (k == 0 || share > 0); ++k) {
    const double of_knot = k == 0 ? 1 - share : share;
    Rows6 columns(6, 6 + joints);
    for (Index c = 0; c < columns.cols(); ++c)
      for (Index r = 0; r < 6; ++r)
        columns(r, c) = of_knot * drift_scale_(c) * (c < 6 ? of_base(r, c) : rows.factor(r, c - 6));
    rows.local[k] = {first_state_[s] + knot + static_cast<Index>(k), std::move(columns)};
  }
}

/// Whitens rows: each column is mapped by the derivative of the residual, already weighted and divided by the sensor's
/// standard deviations.
/// @param mixed whether lengths depend on rotations, or angles on shifts
VERNIER_LOCAL void whiten_rows(const Matrix6& motion, Index values, bool mixed, Rows6& rows) {
  const double* m = motion.data();
  for (Index k = 0; k < rows.cols(); ++k) {
    double* column = rows.data() + 6 * k;
    double out[6] = {};
    const Index lengths = values == 1 ? 1 : 3;
    for (Index c = 0; c < 3; ++c)
      for (Index r = 0; r < lengths; ++r) out[r] += m[6 * c + r] * column[c];
    for (Index c = 3; c < 6 && values == 6; ++c)
      for (Index r = 3; r < 6; ++r) out[r] += m[6 * c + r] * column[c];
    if (mixed) {
      for (Index c = 3; c < 6; ++c)
        for (Index r = 0; r < lengths; ++r) out[r] += m[6 * c + r] * column[c];
      for (Index c = 0; c < 3 && values == 6; ++c)
        for (Index r = 3; r < 6; ++r) out[r] += m[6 * c + r] * column[c];
    }
    std::copy_n(out, 6, column);
  }
}

/// Poses seen from those of other configurations, and their columns, of measurements of one length: transmissions act
/// through both configurations, so what they do is in `functions`, and `factor` is one along the length.
/// @param along  the derivative of the length by a small motion of the relative pose
VERNIER_LOCAL void fold_pair(const RowBlock& from, const Isometry3& from_pose, const Isometry3& relative,
                             const std::vector<Index>& group_sizes, const Vector6& along, RowBlock& rows) {
  const Matrix3 back = VERNIER_LATER(rotation(from_pose)).transpose();
  const auto relative_rate = [&](const double* of, const double* of_from) {
    const Vector3 lever = rotation(from_pose) * translation(relative);
    const Vector3 turn(of_from[3], of_from[4], of_from[5]);
    const Vector3 shift = Vector3(of[0] - of_from[0], of[1] - of_from[1], of[2] - of_from[2]) - turn.cross(lever);
    const Vector3 linear = back * shift;
    const Vector3 angular = back * Vector3(of[3] - turn.x(), of[4] - turn.y(), of[5] - turn.z());
    return VERNIER_LATER(along).template head<3>().dot(linear) + VERNIER_LATER(along).template tail<3>().dot(angular);
  };
  const double none[6] = {};
  for (Index k = 0; k < rows.dense.cols(); ++k) {
    double* column = rows.dense.data() + 6 * k;
    const double rate = relative_rate(column, from.dense.data() + 6 * k);
    std::fill_n(column, 6, 0.0);
    column[0] = rate;
  }
  Index at = 0;
  for (Index j = 0; j < rows.factor.cols(); ++j) {
    double* column = rows.factor.data() + 6 * j;
    const double here = relative_rate(column, none), there = relative_rate(none, from.factor.data() + 6 * j);
    std::fill_n(column, 6, 0.0);
    column[0] = 1;
    for (Index k = 0; k < group_sizes[static_cast<std::size_t>(j)] && rows.functions.size() > 0; ++k, ++at)
      rows.functions(at) = here * rows.functions(at) + there * from.functions(at);
  }
}

VERNIER_IMPL void CalibrationProblem::operator()(Index first, Index count, RowBlock* out) const {
  std::vector<RowBlock> others;  // of the configurations from which poses are seen
  SensedRows sensed;
  for (Index done = 0; done < count;) {  // stretches of one set
    const Block& begin = at(first + done);
    const MeasuredSet& set = sets_[static_cast<std::size_t>(begin.station)];
    const Index stretch = (std::min)(count - done, set.size() - begin.row);
    VectorX warmer;
    if (set.temperatures.size() > 0) warmer.resize(stretch);
    for (Index i = 0; i < warmer.size(); ++i) warmer(i) = set.temperatures(begin.row + i) - reference_temperature;
    const bool visited = set.previous.rows() > 0, paired = set.seen_from.rows() > 0, loaded = set.payloads.rows() > 0;
    const auto linearise = [&](const MatrixX& joints, bool with_previous, RowBlock* rows) {
      return arm.linearise(
          begin.station, VERNIER_LATER(joints).middleRows(begin.row, stretch),
          VERNIER_LATER(set.previous).middleRows(with_previous ? begin.row : 0, with_previous ? stretch : 0), rows,
          joint_columns || joint_sigma_ > 0, warmer,
          VERNIER_LATER(set.payloads).middleRows(loaded ? begin.row : 0, loaded ? stretch : 0));
    };
    std::vector<Isometry3> poses = linearise(set.joints, visited, out + done), from;
    if (paired) {
      others.resize(static_cast<std::size_t>(stretch));
      from = linearise(set.seen_from, false, others.data());
    }
    for (Index i = 0; i < stretch; ++i) {
      const Block& block = at(first + done + i);
      RowBlock& rows = out[done + i];
      Isometry3& pose = poses[static_cast<std::size_t>(i)];
      if (paired)
        pose = composed(inverse_of(from[static_cast<std::size_t>(i)]), pose);
      else
        add_drift(block, pose, rows);
      set.sense(block.row, pose, sensed);
      const double position = std::sqrt(block.weight[0]) / set.sigma().length;
      const double orientation = set.oriented() ? std::sqrt(block.weight[1]) / set.sigma().angle : 0;
      rows.position_sigma = 1 / position;
      rows.residual = sensed.residual;
      VERNIER_LATER(rows.residual).template head<3>() *= position;
      VERNIER_LATER(rows.residual).template tail<3>() *= orientation;
      bool mixed = false;
      for (Index c = 0; c < 6; ++c)
        for (Index r = 0; r < 6; ++r) {
          mixed = mixed || ((r < 3) != (c < 3) && !same_value(sensed.motion(r, c), 0));
          sensed.motion(r, c) *= r < 3 ? position : orientation;
        }
      rows.unwhiten.setIdentity();
      const bool correlated = set.correlated();
      if (correlated) {  // its lower triangle
        const Matrix6 covariance = set.relative_covariance(block.row);
        for (Index c = 0; c < 6; ++c)
          for (Index r = c; r < 6; ++r) rows.unwhiten(r, c) = covariance(r, c);
      }
      if (paired) {
        Vector6 along;
        for (Index c = 0; c < 6; ++c) along(c) = sensed.motion(0, c);
        fold_pair(others[static_cast<std::size_t>(i)], from[static_cast<std::size_t>(i)], pose, arm.group_sizes(),
                  along, rows);
        continue;
      }
      whiten_rows(sensed.motion, set.values(), mixed, rows.dense);
      whiten_rows(sensed.motion, set.values(), mixed, rows.factor);
      for (RowBlock::Local& local : rows.local)
        if (local.state >= 0) whiten_rows(sensed.motion, set.values(), mixed, local.columns);
      if (joint_sigma_ <= 0 && !correlated) continue;
      // the residual's own covariance, and the joint readings eliminated: C + noise noise'
      const double variance = joint_sigma_ * joint_sigma_;
      Matrix6& factor = rows.unwhiten;
      for (Index j = 0; j < rows.factor.cols() && joint_sigma_ > 0; ++j)
        for (Index c = 0; c < 6; ++c)
          for (Index r = c; r < 6; ++r) factor(r, c) += variance * rows.factor(r, j) * rows.factor(c, j);
      cholesky(factor);
      solve_lower(factor, rows.residual);
      solve_lower(factor, rows.dense);
      solve_lower(factor, rows.factor);
      for (RowBlock::Local& local : rows.local)
        if (local.state >= 0) solve_lower(factor, local.columns);
    }
    done += stretch;
  }
}

VERNIER_IMPL StackedRows CalibrationProblem::stacked(bool with_jacobian) const {
  StackedRows out;
  stack(with_jacobian, out);
  return out;
}

VERNIER_IMPL void CalibrationProblem::stack(bool with_jacobian, StackedRows& out) const {
  const Index values = measured_values(), unknowns = arm.size();
  out.residuals.resize(values);
  if (with_jacobian) out.jacobian.resize(values, unknowns);
  const bool known = out.block.size() == static_cast<std::size_t>(values);  // which row is which never changes
  if (!known) out.block.reserve(static_cast<std::size_t>(values));
  const bool factored = arm.num_dense() < unknowns;
  const std::vector<Index> group_sizes = arm.group_sizes();
  Rows6 expanded(6, factored ? unknowns : 0);
  Index row = 0;
  visit_blocks(system(), 0, 1, num_blocks(), [&](Index b, const RowBlock& rows) {
    const Index count = set_of(b).values();
    if (with_jacobian && factored) rows.expand(group_sizes, expanded);
    const Rows6& columns = factored ? expanded : rows.dense;
    for (Index k = 0; with_jacobian && k < unknowns; ++k)
      std::copy_n(columns.data() + 6 * k, count, &out.jacobian(row, k));
    for (Index r = 0; r < count; ++r, ++row) {
      out.residuals(row) = rows.residual(r);
      if (known) continue;
      out.block.push_back(b);
      out.of_orientation.push_back(r >= 3);
    }
  });
}

VERNIER_IMPL MatrixX CalibrationProblem::residual_norms() const {
  MatrixX norms(num_blocks(), 2);
  visit_blocks(system(), 0, 1, num_blocks(), [&](Index b, const RowBlock& rows) {
    const Vector3 linear = VERNIER_LATER(rows.residual).template head<3>(),
                  angular = VERNIER_LATER(rows.residual).template tail<3>();
    norms(b, 0) = linear.norm();
    norms(b, 1) = angular.norm();
  });
  return norms;
}

VERNIER_IMPL void CalibrationProblem::reset_weights() {
  for (Block& block : blocks_) block.weight = {1, 1};
}

/// Whether a set's rows have one weight, because their positions and orientations go together: each with a weight of
/// its own would no longer be white, and the sum of squares that is minimised no loss of the residuals.
VERNIER_LOCAL bool weighed_together(const MeasuredSet& set) { return set.correlated() && set.oriented(); }

/// The norm of a whole row, as large as that of its position alone.
VERNIER_LOCAL double norm_together(const MatrixX& norms, Index block) {
  return std::sqrt((norms(block, 0) * norms(block, 0) + norms(block, 1) * norms(block, 1)) / 2);
}

/// Thresholds of norms of residuals: of positions, orientations, single numbers.
VERNIER_LOCAL std::array<double, 3> loss_thresholds(const CalibrationProblem& problem, const MatrixX& norms) {
  std::array<std::vector<double>, 3> kinds;
  for (Index b = 0; b < problem.num_blocks(); ++b) {
    const MeasuredSet& set = problem.set_of(b);
    const bool together = weighed_together(set);
    kinds[set.projected() ? 2 : 0].push_back(together ? norm_together(norms, b) : norms(b, 0));
    if (set.oriented() && !together) kinds[1].push_back(norms(b, 1));
  }
  return {problem.loss_scale * robust_threshold(std::move(kinds[0]), 3),
          problem.loss_scale * robust_threshold(std::move(kinds[1]), 3),
          problem.loss_scale * robust_threshold(std::move(kinds[2]), 1)};
}

VERNIER_IMPL std::array<double, 3> CalibrationProblem::thresholds() const {
  return loss_thresholds(*this, residual_norms());
}

VERNIER_IMPL std::array<double, 2> CalibrationProblem::reweight() {
  const std::vector<Block> before = blocks_;
  reset_weights();
  const MatrixX norms = residual_norms();
  const std::array<double, 3> thresholds = loss_thresholds(*this, norms);
  for (Index b = 0; b < num_blocks(); ++b) {
    Block& block = blocks_[static_cast<std::size_t>(b)];
    const MeasuredSet& set = set_of(b);
    const double position = thresholds[set.projected() ? 2 : 0];
    if (weighed_together(set)) {
      if (position > 0) block.weight[0] = block.weight[1] = robust_weight(loss_, norm_together(norms, b), position);
      continue;
    }
    if (position > 0) block.weight[0] = robust_weight(loss_, norms(b, 0), position);
    if (set.oriented() && thresholds[1] > 0) block.weight[1] = robust_weight(loss_, norms(b, 1), thresholds[1]);
  }
  std::array<double, 2> sums{};
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (std::size_t k = 0; k < 2; ++k) {
      const double norm = norms(static_cast<Index>(b), static_cast<Index>(k));
      sums[0] += before[b].weight[k] * norm * norm;
      sums[1] += blocks_[b].weight[k] * norm * norm;
    }
  return sums;
}

VERNIER_IMPL bool CalibrationProblem::solve(int max_iterations) {
  return solve(max_iterations, loss_ == Loss::squared ? 1e-9 : 1e-5).converged;
}

VERNIER_IMPL IterationEnd CalibrationProblem::solve(int max_iterations, double least_gain) {
  const bool robust = loss_ != Loss::squared;
  ArmParameterisation accepted = arm;
  std::vector<SessionDrift> accepted_drift = drift;
  const auto linearise = [&] {
    const std::array<double, 2> weighted = robust ? reweight() : std::array<double, 2>{};
    LinearisedProblem out{normal_equations(), arm.precisions(), arm.steps(), drift_steps()};
    double of_priors = weighted_square(out.precisions, out.steps) + local_prior_cost(out.normal, out.local_steps);
    if (robust && prior) of_priors += prior->cost(out.steps);  // `normal.cost` has it
    out.with_old_weights = of_priors + (robust ? weighted[0] : out.normal.cost);
    out.with_new_weights = of_priors + (robust ? weighted[1] : out.normal.cost);
    return out;
  };
  const auto move = [&](const VectorX& step, const VectorX& local_step) {
    arm.move(step);
    if (!drift.empty()) move_drift(local_step);
  };
  const auto keep = [&] {
    accepted = arm;
    accepted_drift = drift;
  };
  const auto restore = [&] {
    arm = accepted;
    drift = accepted_drift;
    if (robust) reweight();
  };
  return minimise({linearise, move, keep, restore}, {max_iterations, 1e-6, least_gain});
}

}  // namespace vernier::detail
