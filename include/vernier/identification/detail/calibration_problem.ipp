#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/twists.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/factorised_equations.hpp"
#include "vernier/least_squares/marquardt_damping.hpp"

namespace vernier::detail {

VERNIER_IMPL CalibrationProblem::CalibrationProblem(ArmParameterisation start, std::vector<Station> stations, Loss loss)
    : arm(std::move(start)), stations_(std::move(stations)), loss_(loss) {
  for (std::size_t s = 0; s < stations_.size(); ++s)
    for (Index i = 0; i < stations_[s].size(); ++i) blocks_.push_back({static_cast<int>(s), i, {1, 1}});
  for (const Station& station : stations_)
    if (station.positions != nullptr) validation_blocks_ += station.size();
  if (validation_blocks_ == 0) validation_blocks_ = num_blocks();
}

VERNIER_IMPL BlockSystem CalibrationProblem::system() const {
  BlockSystem out{num_blocks(), num_validation_blocks(), arm.num_dense(), arm.group_sizes(), *this};
  if (drift.empty()) return out;
  out.local_size = drift_scale_.size();
  for (const SessionDrift& of_station : drift) out.local_states += of_station.knots.cols();
  return out;
}

VERNIER_IMPL NormalEquations CalibrationProblem::normal_equations() const {
  NormalEquations out(system(), drift_priors(), executor);
  if (prior) out.add(*prior, arm.steps());
  return out;
}

VERNIER_IMPL Index CalibrationProblem::measured_values() const {
  Index sum = 0;
  for (const auto& station : stations_) sum += station.values() * station.size();
  return sum;
}

VERNIER_IMPL MatrixX CalibrationProblem::joints() const {
  MatrixX out(num_blocks(), arm.geometry(0).joints());
  Index at = 0;
  for (const Station& station : stations_) {
    out.middleRows(at, station.size()) = station.joints();
    at += station.size();
  }
  return out;
}

VERNIER_IMPL CalibrationProblem::Temperatures CalibrationProblem::temperatures() const {
  std::vector<double> all;
  for (const Station& station : stations_) {
    if (station.positions == nullptr) continue;
    if (station.temperatures == nullptr) return {};
    all.insert(all.end(), station.temperatures->begin(), station.temperatures->end());
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
  drift.assign(stations_.size(), {});
  first_state_.assign(stations_.size(), 0);
  Index states = 0;
  for (std::size_t s = 0; s < stations_.size(); ++s) {
    const Station& station = stations_[s];
    first_state_[s] = states;
    if (station.positions == nullptr || station.times == nullptr) continue;
    const Index intervals = std::max<Index>(1, station.size() / rows_per_knot);
    const double begin = station.times->minCoeff(), end = station.times->maxCoeff();
    if (!(end > begin)) continue;
    drift[s] = {begin, (end - begin) / static_cast<double>(intervals), centroid(*station.positions), {}};
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
      of_station.knots.bottomRows(joints).setZero();
    }
  const double step = drift_scale_(3) / 2;  // half of the base's rotation
  drift_scale_.conservativeResize(6 + joints);
  drift_scale_.tail(joints).setConstant(step);
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
    for (Index k = 0; k < drift[s].knots.cols(); ++k) {
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
             std::max(1.0, noise_variance / (k < 6 ? drift_precision : joint_drift_precision));
  return out;
}

VERNIER_IMPL VectorX CalibrationProblem::drift_joint_zeros(Index block) const {
  const auto s = static_cast<std::size_t>(at(block).station);
  if (drift.empty() || drift[s].empty()) return {};
  return drift[s].joint_zeros((*stations_[s].times)(at(block).row));
}

VERNIER_IMPL Isometry3 CalibrationProblem::drift_motion(Index block) const {
  const auto s = static_cast<std::size_t>(at(block).station);
  if (drift.empty() || drift[s].empty()) return Isometry3::Identity();
  return drift[s].motion((*stations_[s].times)(at(block).row));
}

VERNIER_IMPL void CalibrationProblem::add_drift(const Block& block, Isometry3& pose, RowBlock& rows) const {
  const auto s = static_cast<std::size_t>(block.station);
  if (drift.empty() || drift[s].empty()) return;
  const double time = (*stations_[s].times)(block.row);
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

/// Residual of a sample, not whitened: model minus measured; and what maps rates of the model to rates of the residual.
/// @param along of a single number, the direction in which it is measured: from the fixed point to the tool point, or
///              normal to the plane
VERNIER_API Vector6 measured_residual(const Station& station, Index row, const Isometry3& modelled, Vector3& along,
                                      Matrix3& rotation_rate) {
  Vector6 out = Vector6::Zero();
  const Vector3 point = translation(modelled);
  if (station.lengths != nullptr) {
    along = point.normalized();
    out(0) = point.norm() - (*station.lengths)(row);
  } else if (station.projected()) {
    along = Vector3::UnitZ();
    out(0) = point.z() - station.height(row);
  } else {
    out.head<3>() = point - station.position(row);
  }
  if (station.oriented()) {
    const Vector3 turn = rotation_difference(rotation(modelled), station.orientations[static_cast<std::size_t>(row)]);
    out.tail<3>() = turn;
    rotation_rate = left_jacobian_inverse_so3(turn);
  }
  return out;
}

/// Scales rows by the sensor's precision; of a single number the position rows are projected to its direction first.
VERNIER_API void whiten_rows(const Station& station, const Vector3& along, double position, const Matrix3& orientation,
                             Rows6& rows) {
  const bool projected = station.projected(), oriented = station.oriented();
  for (Index k = 0; k < rows.cols(); ++k) {
    double* column = rows.data() + 6 * k;
    if (projected) {
      column[0] = position * (along(0) * column[0] + along(1) * column[1] + along(2) * column[2]);
      column[1] = column[2] = 0;
    } else {
      for (int r = 0; r < 3; ++r) column[r] *= position;
    }
    if (oriented) {
      const Vector3 angular = orientation * Vector3(column[3], column[4], column[5]);
      std::copy_n(angular.data(), 3, column + 3);
    } else {
      column[3] = column[4] = column[5] = 0;
    }
  }
}

VERNIER_IMPL void CalibrationProblem::operator()(Index first, Index count, RowBlock* out) const {
  for (Index done = 0; done < count;) {  // stretches of one station
    const Block& begin = at(first + done);
    const Station& station = stations_[static_cast<std::size_t>(begin.station)];
    const Index stretch = std::min(count - done, station.size() - begin.row);
    VectorX warmer;
    if (station.temperatures != nullptr) warmer.resize(stretch);
    for (Index i = 0; i < warmer.size(); ++i)
      warmer(i) = (*station.temperatures)(begin.row + i) - reference_temperature;
    std::vector<Isometry3> poses =
        arm.linearise(begin.station, station.joints().middleRows(begin.row, stretch),
                      station.previous().middleRows(station.previous().rows() > 0 ? begin.row : 0,
                                                    station.previous().rows() > 0 ? stretch : 0),
                      out + done, joint_columns || station.joint_sigma > 0, warmer);
    for (Index i = 0; i < stretch; ++i) {
      const Block& block = at(first + done + i);
      RowBlock& rows = out[done + i];
      add_drift(block, poses[static_cast<std::size_t>(i)], rows);
      Vector3 along = Vector3::Zero();
      Matrix3 rate = Matrix3::Zero();
      rows.residual = measured_residual(station, block.row, poses[static_cast<std::size_t>(i)], along, rate);
      const double position = std::sqrt(block.weight[0]) / station.position_sigma;
      const double orientation = station.oriented() ? std::sqrt(block.weight[1]) / station.orientation_sigma : 0;
      rows.position_sigma = 1 / position;
      rows.residual.head<3>() *= position;
      rows.residual.tail<3>() *= orientation;
      const Matrix3 angular = orientation * rate;
      whiten_rows(station, along, position, angular, rows.dense);
      whiten_rows(station, along, position, angular, rows.factor);
      for (RowBlock::Local& local : rows.local)
        if (local.state >= 0) whiten_rows(station, along, position, angular, local.columns);
      rows.unwhiten.setIdentity();
      if (station.joint_sigma <= 0) continue;
      // the residual's covariance with the joint readings eliminated: I + noise noise'
      const double variance = station.joint_sigma * station.joint_sigma;
      Matrix6& factor = rows.unwhiten;
      for (Index j = 0; j < rows.factor.cols(); ++j)
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
    const Index count = station_of(b).values();
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
    const Vector3 linear = rows.residual.head<3>(), angular = rows.residual.tail<3>();
    norms(b, 0) = linear.norm();
    norms(b, 1) = angular.norm();
  });
  return norms;
}

VERNIER_IMPL void CalibrationProblem::reset_weights() {
  for (Block& block : blocks_) block.weight = {1, 1};
}

/// Thresholds of norms of residuals: of positions, orientations, single numbers.
VERNIER_API std::array<double, 3> loss_thresholds(const CalibrationProblem& problem, const MatrixX& norms) {
  std::array<std::vector<double>, 3> kinds;
  for (Index b = 0; b < problem.num_blocks(); ++b) {
    const Station& station = problem.station_of(b);
    kinds[station.projected() ? 2 : 0].push_back(norms(b, 0));
    if (station.oriented()) kinds[1].push_back(norms(b, 1));
  }
  return {robust_threshold(std::move(kinds[0]), 3), robust_threshold(std::move(kinds[1]), 3),
          robust_threshold(std::move(kinds[2]), 1)};
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
    const Station& station = station_of(b);
    const double position = thresholds[station.projected() ? 2 : 0];
    if (position > 0) block.weight[0] = robust_weight(loss_, norms(b, 0), position);
    if (station.oriented() && thresholds[1] > 0) block.weight[1] = robust_weight(loss_, norms(b, 1), thresholds[1]);
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
  const bool robust = loss_ != Loss::squared;
  MarquardtDamping damping;
  ArmParameterisation accepted = arm;
  std::vector<SessionDrift> accepted_drift = drift;
  double reached = std::numeric_limits<double>::infinity(), predicted = 0;
  bool returned = false;  // to where the step before began, since it failed
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const VectorX steps = arm.steps(), precisions = arm.precisions();
    const VectorX local_steps = drift_steps();
    std::array<double, 2> sums{};
    if (robust) sums = reweight();
    const NormalEquations normal = normal_equations();
    double of_priors = weighted_square(precisions, steps) + local_prior_cost(normal, local_steps);
    if (!robust) sums = {normal.cost, normal.cost};
    if (robust && prior) of_priors += prior->cost(steps);  // `normal.cost` has it
    const double sum = sums[0] + of_priors;
    if (sum > (1 + 1e-9) * reached) {  // the step failed, by more than rounding
      damping.reject();
      arm = accepted;
      drift = accepted_drift;
      if (robust) reweight();
      returned = true;
      continue;
    }
    if (damping.value() > 0 && !returned) damping.accept(std::max(reached - sum, 0.0), predicted);
    returned = false;
    accepted = arm;
    accepted_drift = drift;
    reached = sums[1] + of_priors;
    const FactorisedEquations solved(normal, precisions, steps, local_steps, eigen_sparse_solver, damping.value());
    if (!solved.usable()) return false;
    arm.move(solved.step());
    if (!drift.empty()) move_drift(solved.local_step());
    // converged when steps vanish, or change no more than digits of the cost
    double gain = -local_gain(normal, solved.local_step(), local_steps), damped = 0;
    for (Index k = 0; k < steps.size(); ++k) {
      const double step = solved.step()(k);
      gain -= step * (normal.gradient(k) + precisions(k) * steps(k));
      damped += step * step * (normal.matrix(k, k) + precisions(k));
    }
    predicted = gain + damping.value() * damped;
    if (damping.value() < 1 &&
        (solved.step().cwiseAbs().maxCoeff() < 1e-6 || gain < (robust ? 1e-5 : 1e-9) * normal.cost))
      return true;
  }
  return false;
}

}  // namespace vernier::detail
