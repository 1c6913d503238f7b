#pragma once

/// @file
/// Geometry, frames and joint errors of an arm as one least-squares problem over measured poses.

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/so3.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/identification/error_model_design.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/identification/pose_system.hpp"

namespace vernier::detail {

/// What was measured from one place, and how well: poses, or distances from there.
template <int N>
struct Station {
  const Dataset<N>* poses = nullptr;
  const Distances<N>* distances = nullptr;  ///< in place of poses
  bool oriented = false;                    ///< whether orientations count
  double position_sigma = 1;                ///< of a position, per component, or of a distance [m]
  double orientation_sigma = 1;             ///< [rad]
  double joint_sigma = 0;                   ///< of the joint readings [rad, m]; 0: exact

  Index size() const { return poses != nullptr ? poses->size() : distances->size(); }
  JointVector<N> joints(Index i) const { return poses != nullptr ? poses->joints(i) : distances->joints(i); }
  /// Measured values of a sample.
  Index values() const { return poses == nullptr ? 1 : oriented ? 6 : 3; }
};

/// A design, and the poses it has to explain.
template <class Chain>
class ErrorModelProblem {
 public:
  static constexpr int N = Chain::dof;

  /// @param stations those of poses first
  ErrorModelProblem(ErrorModelDesign<Chain> start, std::vector<Station<N>> stations, Loss loss)
      : design(std::move(start)), stations_(std::move(stations)), loss_(loss) {
    for (std::size_t s = 0; s < stations_.size(); ++s)
      for (Index i = 0; i < stations_[s].size(); ++i) poses_.push_back({static_cast<int>(s), i, {1, 1}});
  }

  ErrorModelDesign<Chain> design;

  Index poses() const { return static_cast<Index>(poses_.size()); }
  /// Samples by which models are judged, the first ones: where there are any positions, distances do not count.
  Index judged() const {
    const auto of_distance = std::find_if(poses_.begin(), poses_.end(), [&](const Pose& p) {
      return stations_[static_cast<std::size_t>(p.station)].distances != nullptr;
    });
    return of_distance == poses_.begin() ? poses() : static_cast<Index>(of_distance - poses_.begin());
  }
  const Station<N>& station_of(Index pose) const { return stations_[static_cast<std::size_t>(at(pose).station)]; }
  JointVector<N> joints(Index pose) const { return station_of(pose).joints(at(pose).row); }
  /// Measured values: three a position, six a pose, one a distance.
  Index measured_values() const {
    Index sum = 0;
    for (const auto& station : stations_) sum += station.values() * station.size();
    return sum;
  }

  /// Calls `f` with the poses as rows of numbers, where the problem stands.
  template <class F>
  decltype(auto) with_system(F&& f) const {
    const auto rows = [this](Index pose, PoseRows& out) { rows_of(pose, out); };
    return f(PoseSystem{poses(), judged(), design.dense(), design.functions_of(), rows});
  }

  /// Residual and effects of a pose, divided by its sensor's sigmas, weighed as the robust loss has it. Noisy joint
  /// readings are unknowns of their own with a prior; each pose's are eliminated here in closed form, which is what a
  /// sparse solver does with the arrow-shaped system.
  [[gnu::noinline]] void rows_of(Index pose, PoseRows& out) const {
    const Pose& p = at(pose);
    const Station<N>& station = station_of(pose);
    const Isometry3 modelled = design.effect(p.station, station.joints(p.row), out);
    Matrix3 rate = Matrix3::Zero();
    out.residual.setZero();
    if (station.distances != nullptr) {
      const Vector3 along = modelled.translation().normalized();
      out.residual(0) = modelled.translation().norm() - station.distances->length(p.row);
      keep_first(out.dense, along);
      keep_first(out.joint, along);
    } else {
      out.residual.template head<3>() = modelled.translation() - station.poses->position(p.row);
    }
    if (station.oriented) {
      const Vector3 turned = log_so3(modelled.linear() * station.poses->orientation(p.row).transpose());
      out.residual.template tail<3>() = turned;
      rate = left_jacobian_inverse_so3(turned);
    }
    const double position = std::sqrt(p.weight[0]) / station.position_sigma;
    const double orientation = station.oriented ? std::sqrt(p.weight[1]) / station.orientation_sigma : 0;
    out.unit = 1 / position;
    out.residual.template head<3>() *= position;
    out.residual.template tail<3>() *= orientation;
    whiten(out.dense, position, orientation * rate);
    whiten(out.joint, position, orientation * rate);
    out.root.setIdentity();
    if (station.joint_sigma <= 0) return;
    const Rows6 noise = station.joint_sigma * out.joint;
    const Eigen::LLT<Matrix6> root(Matrix6(Matrix6::Identity() + noise * noise.transpose()));
    out.root = root.matrixL();
    root.matrixL().solveInPlace(out.residual);
    root.matrixL().solveInPlace(out.dense);
    root.matrixL().solveInPlace(out.joint);
  }

  /// Gauss-Newton from where the problem stands; a robust loss settles its weights on the way.
  /// @return whether the steps died away
  bool solve(int max_iterations = 20) {
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      if (loss_ != Loss::squared) weigh();
      const VectorX steps = design.steps(), precisions = design.precisions();
      const PoseNormalEquations normal = with_system([](const PoseSystem& s) { return PoseNormalEquations(s); });
      const FactorisedSystem system(normal, precisions, steps);
      if (!system.usable()) return false;
      design.move(system.step);
      // done when steps die away, or bring no more than digits of the cost
      const double gain = -system.step.dot(normal.gradient + precisions.cwiseProduct(steps));
      if (system.step.cwiseAbs().maxCoeff() < 1e-6 || gain < (loss_ == Loss::squared ? 1e-9 : 1e-5) * normal.cost)
        return true;
    }
    return false;
  }

 private:
  struct Pose {
    int station;
    Index row;
    std::array<double, 2> weight;  ///< in [0, 1]: of position, of orientation
  };
  const Pose& at(Index pose) const { return poses_[static_cast<std::size_t>(pose)]; }

  /// The first row becomes what the position rows are along a direction, the others zero.
  static void keep_first(Rows6& rows, const Vector3& along) {
    rows.row(0) = (along.transpose() * rows.topRows<3>()).eval();
    rows.bottomRows<5>().setZero();
  }

  static void whiten(Rows6& rows, double position, const Matrix3& orientation) {
    rows.topRows<3>() *= position;
    rows.bottomRows<3>() = (orientation * rows.bottomRows<3>()).eval();
  }

  /// Weights from residuals where the problem stands; their scale is the median of the residual norms.
  void weigh() {
    PoseRows rows;
    for (Pose& pose : poses_) pose.weight = {1, 1};
    MatrixX norms(poses(), 2);
    for (Index b = 0; b < poses(); ++b) {
      rows_of(b, rows);
      norms.row(b) << rows.residual.head<3>().norm(), rows.residual.tail<3>().norm();
    }
    enum Kind { position, orientation, distance };
    const auto concerns = [&](Index b, Kind kind) {
      const Station<N>& station = station_of(b);
      return kind == orientation ? station.oriented : (kind == distance) == (station.distances != nullptr);
    };
    for (const Kind kind : {position, orientation, distance}) {
      const int part = kind == orientation ? 1 : 0;
      std::vector<double> sorted;
      for (Index b = 0; b < poses(); ++b)
        if (concerns(b, kind)) sorted.push_back(norms(b, part));
      if (sorted.empty()) continue;
      const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
      std::nth_element(sorted.begin(), middle, sorted.end());
      // the median norm of a standard normal 3-vector is 1.538, that of a number 0.6745
      const double bend = (kind == distance ? 1.345 / 0.6745 : 2.8 / 1.538) * *middle;
      if (!(bend > 0)) continue;
      for (Index b = 0; b < poses(); ++b) {
        if (!concerns(b, kind)) continue;
        const double ratio = norms(b, part) / bend;
        poses_[static_cast<std::size_t>(b)].weight[static_cast<std::size_t>(part)] =
            loss_ == Loss::huber ? std::min(1.0, 1 / ratio) : 1 / (1 + ratio * ratio);
      }
    }
  }

  std::vector<Station<N>> stations_;
  std::vector<Pose> poses_;
  Loss loss_;
};

}  // namespace vernier::detail
