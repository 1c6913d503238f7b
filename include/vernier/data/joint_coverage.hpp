// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The joint ranges covered by measurements, which bound where a model learned from them is valid.

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/core/motor_angles.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

namespace detail {

/// Ranges of the measured values of one joint.
struct CoveredRanges {
  std::vector<JointRange> widened, measured;  ///< as many of each
  double margin;
};
VERNIER_API CoveredRanges covered_ranges(const ConstVectorRef& values);

/// The union of ranges, those closer than two margins merged.
VERNIER_API std::vector<JointRange> joined_ranges(std::vector<JointRange> ranges, const std::vector<JointRange>& others,
                                                  double margin);

/// A gate's value and slope.
struct GateFactor {
  double value, slope;
};
/// @param periodic whether values that differ by whole turns count as the same
VERNIER_API GateFactor gate_factor(const std::vector<JointRange>& ranges, double margin, bool periodic,
                                   double q) noexcept;

}  // namespace detail

/// The measured ranges of each joint, as a gate: 1 where every joint lies within one of its ranges, decreasing smoothly
/// (cubic) to 0 where one joint is `margin` away from all of its own. Between ranges of at most two margins apart it is
/// 1. A joint without ranges has no effect. In a joint that is `periodic`, angles that differ by whole turns count as
/// the same, and the gap between the last range and the first, a turn further, is a gap like any other.
template <int N>
struct JointCoverage {
  std::array<std::vector<JointRange>, N> ranges{};      ///< ascending, more than two margins apart
  JointVector<N> margin = JointVector<N>::Constant(1);  ///< width of the transition [rad, m], > 0
  std::array<bool, N> periodic{};                       ///< whether angles that differ by whole turns count as the same
  std::array<std::vector<JointRange>, N> measured{};  ///< from the least to the greatest measured value in each of the
                                                      ///< ranges, which are wider; empty where not known
  MotorAngles motors{};  ///< whose angles the ranges are of, in place of those of the joints; none: of the joints

  /// The ranges of n measured joints. The margin is a tenth of a joint's total range, at least 0.02; values closer than
  /// two margins belong to one range; every range is widened by 3/n of the total (the extremes of n random values fall
  /// short by 1/n on average), at most half a margin, and ranges then closer than two margins are merged. `periodic` is
  /// left false; fits set it for revolute joints.
  /// @param joints n x N [rad, m]
  /// @param of     motors whose ranges are wanted in place of those of the joints
  static JointCoverage covering(const JointRows<N>& joints, const MotorAngles& of = {}) {
    JointCoverage coverage;
    coverage.motors = of;
    if (joints.rows() == 0) return coverage;
    const MatrixX values = of.none() ? MatrixX() : of.angles(joints);
    for (int i = 0; i < N; ++i) {
      detail::CoveredRanges found =
          of.none() ? detail::covered_ranges(joints.col(i)) : detail::covered_ranges(values.col(i));
      coverage.ranges[static_cast<std::size_t>(i)] = std::move(found.widened);
      coverage.measured[static_cast<std::size_t>(i)] = std::move(found.measured);
      coverage.margin(i) = found.margin;
    }
    return coverage;
  }
  /// The ranges of measured joints whose number is known at run time.
  /// @throws std::invalid_argument on another number of columns
  template <ColumnsAtRunTime Rows>
  static JointCoverage covering(const Rows& joints, const MotorAngles& of = {}) {
    return covering(detail::joint_rows<N>(joints), of);
  }

  /// This gate widened to the ranges of other measurements; `measured` stays.
  /// @param others  of each joint, ascending; no joints: those measurements were everywhere
  /// @param margins of each joint; the larger of the two counts
  /// @throws std::invalid_argument for ranges or margins of another number of joints
  JointCoverage joined(const std::vector<std::vector<JointRange>>& others, const VectorX& margins) const {
    demand(others.empty() || (others.size() == N && margins.size() == N), "JointCoverage: ranges of ", others.size(),
           " joints and margins of ", margins.size(), " for an arm of ", N, " joints");
    JointCoverage out = *this;
    for (std::size_t i = 0; i < N; ++i) {
      if (others.empty()) {
        out.ranges[i].clear();
        continue;
      }
      const auto k = static_cast<Index>(i);
      out.margin(k) = (std::max)(margin(k), margins(k));
      out.ranges[i] = ranges[i].empty() || others[i].empty()
                          ? std::vector<JointRange>{}
                          : detail::joined_ranges(ranges[i], others[i], out.margin(k));
    }
    return out;
  }

  /// The gate at q; no allocation.
  double operator()(const JointVector<N>& q) const noexcept {
    const JointVector<N> at = values(q);
    double product = 1;
    for (int i = 0; i < N; ++i) product *= factor(i, at(i)).value;
    return product;
  }
  /// The gate at joint values whose number is known at run time.
  /// @throws std::invalid_argument on another number
  template <SizedAtRunTime Q>
  double operator()(const Q& q) const {
    return (*this)(detail::joint_vector<N>(q));
  }

  /// Its derivative with respect to q; no allocation.
  Eigen::Matrix<double, 1, N> derivative(const JointVector<N>& q) const noexcept {
    const JointVector<N> at = values(q);
    std::array<detail::GateFactor, N> factors;
    for (int i = 0; i < N; ++i) factors[static_cast<std::size_t>(i)] = factor(i, at(i));
    Eigen::Matrix<double, 1, N> out;
    for (int j = 0; j < N; ++j) {
      out(j) = factors[static_cast<std::size_t>(j)].slope;
      for (int i = 0; i < N; ++i)
        if (i != j) out(j) *= factors[static_cast<std::size_t>(i)].value;
    }
    if (!motors.none()) motors.to_chain_gradient(out.data());
    return out;
  }
  /// Its derivative with respect to joint values whose number is known at run time.
  /// @throws std::invalid_argument on another number
  template <SizedAtRunTime Q>
  Eigen::Matrix<double, 1, N> derivative(const Q& q) const {
    return derivative(detail::joint_vector<N>(q));
  }

 private:
  JointVector<N> values(const JointVector<N>& q) const noexcept {
    JointVector<N> out = q;
    if (!motors.none()) motors.angles(q.data(), out.data());
    return out;
  }
  detail::GateFactor factor(int i, double q) const noexcept {
    return detail::gate_factor(ranges[static_cast<std::size_t>(i)], margin(i), periodic[static_cast<std::size_t>(i)],
                               q);
  }
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/joint_coverage.ipp"
#endif
