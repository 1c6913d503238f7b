#pragma once

/// @file
/// Joints that give way under the arm's own weight and its payload.

#include <algorithm>
#include <cmath>

#include "vernier/kinematics/dh_chain.hpp"

namespace vernier {

/// Joint torques by gravity of unit weights at the ends of the links. With a spring of compliance c_i at joint i
/// [rad/(N m)] and weights W_j [N] the joint gives way by `sum_j c_i W_j torque(i, j)`: the products c_i W_j [rad/m]
/// are all that poses can tell, so they are the parameters, N (N + 1) / 2 of them; a payload is folded into those of
/// the last link.
template <class Chain>
class GravityCompliance {
 public:
  /// Number of joints.
  static constexpr int N = Chain::dof;
  /// Number of products: joint i carries the links j >= i.
  static constexpr Index size = N * (N + 1) / 2;
  /// One value a product.
  using Products = Eigen::Matrix<double, size, 1>;

  /// @param chain nominal chain: torques need no more than that
  /// @param down  direction of gravity in the base frame of the chain; a unit vector
  explicit GravityCompliance(const Chain& chain, const Vector3& down = -Vector3::UnitZ()) : chain_(chain), down_(down) {
    require(std::abs(down.norm() - 1) < 1e-6, "GravityCompliance: the direction of gravity has length ", down.norm(),
            ", must be 1");
  }

  /// Direction of gravity in the base frame of the chain.
  const Vector3& down() const { return down_; }

  /// Position of the product of joint i and link j >= i, both from 0.
  static constexpr Index index(int i, int j) { return i * N - i * (i - 1) / 2 + (j - i); }

  /// Joint errors by one unit of each product, N x size: [N m] for a weight of 1 N (or [N] at a prismatic joint).
  [[gnu::noinline]] void basis(const JointVector<N>& q,
                               Eigen::Ref<Eigen::Matrix<double, N, Eigen::Dynamic>> out) const noexcept {
    const auto links = chain_.links(q);
    out.setZero();
    for (int i = 0; i < N; ++i)
      for (int j = i; j < N; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        out(i, index(i, j)) =
            revolute(i) ? links.axis[a].dot((links.origin[b] - links.point[a]).cross(down_)) : links.axis[a].dot(down_);
      }
  }

  /// Adds the joint errors of given products, and their derivative with respect to the joints.
  [[gnu::noinline]] void add(const JointVector<N>& q, const double* products, JointVector<N>& joints,
                             Eigen::Matrix<double, N, N>& derivative) const noexcept {
    const auto links = chain_.links(q);
    for (int i = 0; i < N; ++i) {
      const auto a = static_cast<std::size_t>(i);
      const Vector3& axis = links.axis[a];
      // moment(k): weights of the links from k on, about a point on axis k
      const auto moment = [&](int k) {
        Vector3 sum = Vector3::Zero();
        for (int j = std::max(i, k); j < N; ++j)
          sum += products[index(i, j)] *
                 (links.origin[static_cast<std::size_t>(j)] - links.point[static_cast<std::size_t>(k)]);
        return sum;
      };
      double weight = 0;
      for (int j = i; j < N; ++j) weight += products[index(i, j)];
      const Vector3 lever = moment(i);
      joints(i) += revolute(i) ? axis.dot(lever.cross(down_)) : weight * axis.dot(down_);
      for (int k = 0; k < N; ++k) {
        const Vector3& turn = links.axis[static_cast<std::size_t>(k)];
        if (k < i) {
          if (!revolute(k)) continue;
          const Vector3 turned = turn.cross(axis);
          derivative(i, k) += revolute(i) ? turned.dot(lever.cross(down_)) + axis.dot(turn.cross(lever).cross(down_))
                                          : weight * turned.dot(down_);
        } else if (revolute(i)) {
          double behind = 0;
          for (int j = k; j < N; ++j) behind += products[index(i, j)];
          const Vector3 moved = revolute(k) ? Vector3(turn.cross(moment(k))) : Vector3(behind * turn);
          derivative(i, k) += axis.dot(moved.cross(down_));
        }
      }
    }
  }

 private:
  bool revolute(int i) const { return chain_.row(i).joint == JointType::revolute; }

  Chain chain_;
  Vector3 down_;
};

}  // namespace vernier
