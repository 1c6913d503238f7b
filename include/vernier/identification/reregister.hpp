#pragma once

/// @file
/// A fitted arm that was moved, re-mounted or has drifted: its frames and joint zeros again, the rest kept.

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/identification/error_model.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier {

/// What may move, and how well it is measured.
struct ReregisterOptions {
  bool base = true;                   ///< the arm, or the sensor, stands elsewhere
  bool tool = false;                  ///< another tool, or the same in another place
  bool offsets = false;               ///< joint zeros
  double position_sigma = 0.03e-3;    ///< of the sensor, per component [m]
  double orientation_sigma = 0.1e-3;  ///< of the sensor, per component [rad]
  double offset_size = 1e-3;          ///< expected change of a joint zero [rad, m]: a prior, so that few poses do
  bool use_orientations = true;       ///< measured orientations count too, where there are any

  /// @throws std::invalid_argument naming the value
  void validate() const {
    require(base || tool || offsets, "ReregisterOptions: nothing may move");
    require(position_sigma > 0 && orientation_sigma > 0 && offset_size > 0, "ReregisterOptions: position_sigma ",
            position_sigma, ", orientation_sigma ", orientation_sigma, " and offset_size ", offset_size,
            " must be positive");
  }
};

namespace detail {

/// Small changes of base (twist in the outer frame), joint zeros and tool (twist in its own frame), those that may
/// move.
template <int N>
struct Adjustment {
  bool base, offsets, tool;

  Index size() const { return (base ? 6 : 0) + (offsets ? N : 0) + (tool ? 6 : 0); }

  /// Effect of unit changes on a pose, 6 x size.
  MatrixX effect(const PoseAndJacobian<N>& at) const {
    MatrixX out = MatrixX::Zero(6, size());
    Index column = 0;
    if (base) {
      out.block<3, 3>(0, 0).setIdentity();
      out.block<3, 3>(0, 3) = -skew(at.pose.translation());
      out.block<3, 3>(3, 3).setIdentity();
      column = 6;
    }
    if (offsets) {
      out.middleCols<N>(column) = at.jacobian;
      column += N;
    }
    if (tool) {
      out.block<3, 3>(0, column) = at.pose.linear();
      out.block<3, 3>(3, column + 3) = at.pose.linear();
    }
    return out;
  }

  template <class Chain>
  ErrorModel<Chain> apply(const ErrorModel<Chain>& model, const VectorX& by) const {
    Vector6 front = Vector6::Zero(), back = Vector6::Zero();
    JointVector<N> zeros = JointVector<N>::Zero();
    Index at = 0;
    if (base) front = by.segment<6>(std::exchange(at, at + 6));
    if (offsets) zeros = by.segment<N>(std::exchange(at, at + N));
    if (tool) back = by.segment<6>(at);
    return model.moved(FrameParameters(front).isometry(), zeros, FrameParameters(back).isometry());
  }
};

/// How far the tool was turned when base and tool both were: from `seen_i = X model_i Y` the sum over i of the
/// Kronecker products of `model_i` and `seen_i` has X, as a vector, for its dominant left singular vector; Y follows.
/// @cite Shah 2013
template <class Chain>
Isometry3 tool_turn(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data) {
  MatrixX sum = MatrixX::Zero(9, 9);
  std::vector<Matrix3> modelled;
  for (Index i = 0; i < data.size(); ++i) {
    modelled.push_back(model.pose(data.joints(i)).linear());
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) sum.block<3, 3>(3 * r, 3 * c) += modelled.back()(r, c) * data.orientation(i);
  }
  const VectorX x = Eigen::JacobiSVD<MatrixX>(sum, Eigen::ComputeThinU | Eigen::ComputeThinV).matrixU().col(0);
  Matrix3 base = Eigen::Map<const Matrix3>(x.data());
  if (base.determinant() < 0) base = -base;
  base = nearest_rotation(base);
  Matrix3 turned = Matrix3::Zero();
  for (Index i = 0; i < data.size(); ++i)
    turned += (base * modelled[static_cast<std::size_t>(i)]).transpose() * data.orientation(i);
  Isometry3 out = Isometry3::Identity();
  out.linear() = nearest_rotation(turned);
  return out;
}

}  // namespace detail

/// A re-registered arm.
template <class Chain>
struct Reregistered {
  ErrorModel<Chain> model;  ///< where it stands now
  bool determined = false;  ///< whether the poses say where everything is that may have moved
  bool converged = false;   ///< whether the iteration ended
  double rms_before = 0;    ///< position error with the frames of before [m]
  double rms_after = 0;     ///< position error now [m]
  VectorX change_std{};     ///< standard deviations: base twist (6), joint zeros (N), tool twist (6), those that move
};

/// Finds base, tool or joint zeros of a fitted arm again, from a handful of poses; everything else is kept.
/// @param model   as fitted, wherever it stood then
/// @param data    n >= 1 poses from where it stands now
/// @param options what may move
/// @throws std::invalid_argument on no data or an unusable option
template <class Chain>
Reregistered<Chain> reregister(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data,
                               const ReregisterOptions& options = {}) {
  constexpr int N = Chain::dof;
  options.validate();
  require(data.size() >= 1, "reregister: no samples");
  const bool oriented = options.use_orientations && data.has_orientations();
  const detail::Adjustment<N> change{options.base, options.offsets, options.tool};
  const auto rms = [&](const ErrorModel<Chain>& m) {
    return std::sqrt((positions(m, data.joints()) - data.positions()).rowwise().squaredNorm().mean());
  };
  Reregistered<Chain> out{model};
  out.rms_before = rms(model);
  if (options.base) {  // the arm may be anywhere: a closed-form start
    if (oriented && options.tool)
      out.model = model.moved(Isometry3::Identity(), JointVector<N>::Zero(), detail::tool_turn(model, data));
    const PointRows there = positions(out.model, data.joints());
    Isometry3 jump = Isometry3::Identity();
    if (oriented) {
      Matrix3 sum = Matrix3::Zero();
      for (Index i = 0; i < data.size(); ++i)
        sum += data.orientation(i) * out.model.pose(data.joints(i)).linear().transpose();
      jump.linear() = nearest_rotation(sum);
      jump.translation() =
          data.positions().colwise().mean().transpose() - jump.linear() * there.colwise().mean().transpose();
    } else {
      jump = register_points(there, data.positions());
    }
    out.model = out.model.moved(jump, JointVector<N>::Zero(), Isometry3::Identity());
  }
  const Index size = change.size(), rows = (oriented ? 6 : 3) * data.size();
  MatrixX jacobian(rows + (options.offsets ? N : 0), size);
  VectorX residual(jacobian.rows()), total = VectorX::Zero(size);
  for (int iteration = 0; iteration < 50 && !out.converged; ++iteration) {
    for (Index i = 0; i < data.size(); ++i) {
      const PoseAndJacobian<N> at = out.model.pose_and_jacobian(data.joints(i));
      const MatrixX effect = change.effect(at);
      const Index row = (oriented ? 6 : 3) * i;
      jacobian.middleRows(row, 3) = effect.topRows<3>() / options.position_sigma;
      residual.segment<3>(row) = (data.position(i) - at.pose.translation()) / options.position_sigma;
      if (!oriented) continue;
      jacobian.middleRows(row + 3, 3) = effect.bottomRows<3>() / options.orientation_sigma;
      residual.segment<3>(row + 3) =
          log_so3(data.orientation(i) * at.pose.linear().transpose()) / options.orientation_sigma;
    }
    if (options.offsets) {
      const Index first = options.base ? 6 : 0;
      jacobian.bottomRows<N>().setZero();
      jacobian.block<N, N>(rows, first).diagonal().setConstant(1 / options.offset_size);
      residual.tail<N>() = -total.segment<N>(first) / options.offset_size;
    }
    Eigen::ColPivHouseholderQR<MatrixX> qr(jacobian);
    qr.setThreshold(1e-9);
    out.determined = qr.rank() == size;
    if (!out.determined) break;
    const VectorX step = qr.solve(residual);
    total += step;
    out.model = change.apply(out.model, step);
    out.converged = step.cwiseAbs().maxCoeff() < 1e-10;
    out.change_std =
        (jacobian.transpose() * jacobian).ldlt().solve(MatrixX::Identity(size, size)).diagonal().cwiseSqrt();
  }
  out.rms_after = rms(out.model);
  return out;
}

}  // namespace vernier
