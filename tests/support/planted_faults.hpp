// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measured poses with one planted fault, for the audit of data.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "vernier/calibration/data_audit.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier {

/// Sizes of planted faults.
struct PlantedSizes {
  double effect = 5e-3;        ///< of a sign or zero: mean displacement that frames do not absorb, at least [m]
  double zero_min = 0.0349;    ///< of a joint's zero [rad]
  double zero_max = 0.35;      ///< [rad]
  double outlier_min = 5e-3;   ///< displacement of an outlier, or distance of swapped poses [m]
  double outlier_max = 50e-3;  ///< [m]
  double drift_min = 2e-3;     ///< displacement from the first row to the last [m]
  double drift_max = 10e-3;    ///< [m]
};

/// Measured poses with a fault, and what an audit should find.
template <int N>
struct Planted {
  Dataset<N> data;
  FaultKind kind;
  int joint = -1;
  std::vector<Index> rows{};
  double size = 0;

  /// Whether a finding is this fault.
  bool is(const DataFinding& finding) const {
    if (finding.kind != kind) return false;
    if (kind == FaultKind::joints_read) return true;
    if (finding.joint != joint) return false;
    if (kind == FaultKind::shifted_rows)
      return finding.size == size && !finding.rows.empty() && std::abs(finding.rows.front() - rows.front()) <= 3;
    if (kind == FaultKind::length_unit || kind == FaultKind::joint_unit)
      return std::abs(finding.size / size - 1) < 1e-6;
    if (kind == FaultKind::joint_coupling) return finding.size == size;
    if (kind == FaultKind::joint_zero) return std::abs(finding.size - size) < 0.25 * std::abs(size) + 0.01;
    return std::includes(finding.rows.begin(), finding.rows.end(), rows.begin(), rows.end());
  }
};

/// The same approach, times and temperatures with other values.
template <int N>
Dataset<N> with_values(const Dataset<N>& data, const JointRows<N>& joints, const PointRows& positions,
                       const PointRows& orientations) {
  return Dataset<N>(joints, positions, orientations)
      .approached_from(data.previous())
      .measured_at(data.times())
      .at_temperatures(data.temperatures());
}

/// Mean displacement of poses that registered frames do not absorb when an arm is at other joints than stated.
template <class Chain>
double unabsorbed(const Chain& chain, const Dataset<Chain::dof>& data, const JointRows<Chain::dof>& stated) {
  std::vector<Isometry3> poses;
  PointRows positions(data.size(), 3), orientations(data.has_orientations() ? data.size() : 0, 3);
  for (Index i = 0; i < data.size(); ++i) {
    Isometry3 tool = Isometry3::Identity();
    tool.translation().z() = 0.05;
    const Isometry3 pose = chain.pose(data.joints(i)) * tool;
    positions.row(i) = pose.translation().transpose();
    if (data.has_orientations()) orientations.row(i) = log_so3(Matrix3(pose.linear())).transpose();
  }
  const Dataset<Chain::dof> shown(stated, positions, orientations);
  const auto registered = starting_frames(chain, shown, true, true);
  const double position = prediction_error(registered, shown).mean;
  return data.has_orientations() ? std::hypot(position, 0.25 * rotation_errors(registered, shown).mean()) : position;
}

/// Plants a fault of a kind, if the data and the sizes allow one.
template <class Chain>
std::optional<Planted<Chain::dof>> plant(const Chain& chain, const Dataset<Chain::dof>& data, FaultKind kind,
                                         const PlantedSizes& sizes, Rng& rng) {
  constexpr int N = Chain::dof;
  const Index n = data.size();
  JointRows<N> joints = data.joints(), previous = data.previous();
  PointRows positions = data.positions(), orientations = data.orientations();
  const bool oriented = data.has_orientations();
  const auto below = [&](Index count) { return static_cast<Index>(rng.below(static_cast<std::uint64_t>(count))); };
  const auto between = [&](double from, double to) { return from * std::pow(to / from, rng.uniform()); };
  const auto direction = [&] {
    const double x = rng.normal(), y = rng.normal(), z = rng.normal();
    return Vector3(Vector3(x, y, z).normalized());
  };
  Planted<N> out{data, kind};
  const auto changed = [&]() -> std::optional<Planted<N>> {
    out.data = with_values<N>(data, joints, positions, orientations).approached_from(previous);
    return out;
  };
  switch (kind) {
    case FaultKind::length_unit: {
      const double factors[] = {1000, 0.001, 25.4, 1 / 25.4};
      out.size = factors[below(4)];
      positions *= out.size;
      return changed();
    }
    case FaultKind::joint_unit: {
      out.size = below(2) == 0 ? 180 / std::numbers::pi : std::numbers::pi / 180;
      joints *= out.size;
      previous *= out.size;
      return changed();
    }
    case FaultKind::joint_sign:
    case FaultKind::joint_zero:
      for (int attempt = 0; attempt < 20; ++attempt) {
        const int j = static_cast<int>(below(N));
        joints = data.joints();
        previous = data.previous();
        if (kind == FaultKind::joint_sign) {
          joints.col(j) *= -1;
          previous.col(j) *= -1;
        } else {
          out.size = rng.sign() * between(sizes.zero_min, sizes.zero_max);
          joints.col(j).array() -= out.size;
          previous.col(j).array() -= out.size;
        }
        if (unabsorbed(chain, data, joints) < sizes.effect) continue;
        out.joint = j;
        return changed();
      }
      return std::nullopt;
    case FaultKind::joint_coupling:  // of two joints whose axes are parallel
      for (int j = 1; j < N; ++j) {
        if (std::abs(std::sin(chain.row(j - 1).alpha)) > 1e-9 || chain.row(j - 1).joint != JointType::revolute ||
            chain.row(j).joint != JointType::revolute)
          continue;
        out.joint = j;
        out.size = rng.sign();
        joints.col(j) += out.size * joints.col(j - 1);
        previous.col(j) += out.size * previous.col(j - 1);
        return changed();
      }
      return std::nullopt;
    case FaultKind::unexplained: return std::nullopt;
    case FaultKind::mirrored_frame: positions.col(below(3)) *= -1; return changed();
    case FaultKind::orientation_convention: {
      if (!oriented) return std::nullopt;
      const Index which = below(4);
      for (Index i = 0; i < n; ++i) {
        const Matrix3 r = data.orientation(i);
        const double pitch = -std::asin(std::clamp(r(2, 0), -1.0, 1.0));
        const Vector3 rpy(std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0)));
        const Vector3 v = which == 0   ? Vector3(-orientations.row(i).transpose())
                          : which == 1 ? Vector3(orientations.row(i).transpose() * 180 / std::numbers::pi)
                          : which == 2 ? rpy
                                       : Vector3(rpy * 180 / std::numbers::pi);
        orientations.row(i) = v.transpose();
      }
      return changed();
    }
    case FaultKind::shifted_rows: {
      // one or two poses are lost, at the beginning or later; the last joints have no pose then
      const Index lost = 1 + below(2), at = below(2) == 0 ? 0 : 5 + below(n - 15);
      std::vector<Index> poses, rows;
      for (Index i = 0; i < n; ++i) {
        if (i < at || i >= at + lost) poses.push_back(i);
        if (i + lost < n) rows.push_back(i);
      }
      out.data = data.rows(rows);
      const Dataset<N> moved = data.rows(poses);
      out.data = with_values<N>(out.data, out.data.joints(), moved.positions(), moved.orientations());
      out.size = -static_cast<double>(lost);
      for (Index i = at; i < out.data.size(); ++i) out.rows.push_back(i);
      return out;
    }
    case FaultKind::swapped_rows:
      for (int attempt = 0; attempt < 100; ++attempt) {
        const Index a = below(n), b = attempt < 50 ? std::min(a + 1, n - 1) : below(n);
        if ((positions.row(a) - positions.row(b)).norm() < sizes.outlier_min) continue;
        positions.row(a).swap(positions.row(b));
        if (oriented) orientations.row(a).swap(orientations.row(b));
        out.rows = {std::min(a, b), std::max(a, b)};
        return changed();
      }
      return std::nullopt;
    case FaultKind::duplicate_rows: {
      const Index from = below(n), to = from + 1 + below(n - from);
      std::vector<Index> rows;
      for (Index i = 0; i <= n; ++i) {
        if (i == to) rows.push_back(from);
        if (i < n) rows.push_back(i);
      }
      out.data = data.rows(rows);
      if (rng.sign() > 0) {  // a sensor that was not read again
        JointRows<N> other = out.data.joints();
        other.row(to) = data.joints().row(below(n));
        if (other.row(to) == other.row(from)) return std::nullopt;
        out.data = with_values<N>(out.data, other, out.data.positions(), out.data.orientations());
      }
      out.rows = {from, to};
      return out;
    }
    case FaultKind::outlier: {
      const Index row = below(n);
      out.size = between(sizes.outlier_min, sizes.outlier_max);
      positions.row(row) += out.size * direction().transpose();
      out.rows = {row};
      return changed();
    }
    case FaultKind::joints_read: {
      // commands on a grid that are read with noise; the pose moves with the arm
      const double step = 0.2, noise = between(2e-5, 5e-4);
      const auto registered = starting_frames(chain, data, true, true);
      for (Index i = 0; i < n; ++i) {
        JointVector<N> now = data.joints(i);
        for (int j = 0; j < N; ++j) now(j) = step * std::round(now(j) / step);
        const Isometry3 old_pose = registered.pose(data.joints(i)), new_pose = registered.pose(now);
        positions.row(i) += (new_pose.translation() - old_pose.translation()).transpose();
        if (oriented)
          orientations.row(i) =
              log_so3(Matrix3(new_pose.linear() * old_pose.linear().transpose() * data.orientation(i))).transpose();
        for (int j = 0; j < N; ++j) joints(i, j) = now(j) + noise * rng.normal();
      }
      return changed();
    }
    case FaultKind::approach_never_varies: {
      out.joint = static_cast<int>(below(N));
      const double side = rng.sign();
      for (Index i = 0; i < n; ++i) {
        if (!previous.row(i).allFinite()) previous.row(i) = joints.row(i) + JointRows<N>::Constant(1, N, 0.1);
        previous(i, out.joint) = joints(i, out.joint) - side * 0.1;
      }
      return changed();
    }
    case FaultKind::session_drift: {
      out.size = between(sizes.drift_min, sizes.drift_max);
      const Vector3 along = direction(), about = direction();
      const Vector3 mean = positions.colwise().mean().transpose();
      const double first = data.times().minCoeff(), span = data.times().maxCoeff() - first;
      for (Index i = 0; i < n; ++i) {
        const double t = (data.times()(i) - first) / span;
        const Matrix3 turn = exp_so3(Vector3(t * out.size * about));  // an arm of a metre
        positions.row(i) = (mean + turn * (positions.row(i).transpose() - mean) + t * out.size * along).transpose();
        if (oriented) orientations.row(i) = log_so3(Matrix3(turn * data.orientation(i))).transpose();
      }
      return changed();
    }
  }
  return std::nullopt;
}

}  // namespace vernier
