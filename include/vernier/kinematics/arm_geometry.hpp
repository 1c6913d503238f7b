// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The geometry of an arm, base and tool frames included, with its number of joints known at run time.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "vernier/kinematics/detail/chain_table.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

template <int N, class Convention>
struct Robot;

namespace detail {

template <class Arm>
struct ChainOfArm {};
template <int N, class Convention>
struct ChainOfArm<DhChain<N, Convention>> {
  using type = DhChain<N, Convention>;
};
template <int N, class Convention>
struct ChainOfArm<Framed<DhChain<N, Convention>>> {
  using type = DhChain<N, Convention>;
};
template <int N, class Convention>
struct ChainOfArm<Robot<N, Convention>> {
  using type = DhChain<N, Convention>;
};

}  // namespace detail

/// The chain of a nominal arm: of a `DhChain`, of one between known base and tool frames, or of a `Robot`.
template <class Arm>
using ChainOf = typename detail::ChainOfArm<Arm>::type;

/// A nominal arm: a `DhChain`, one between known (or guessed) base and tool frames, or a `Robot` of the catalogue.
template <class Arm>
concept NominalArm = requires {
  typename ChainOf<Arm>;
};

/// A nominal arm between frames, identity where it has none.
template <NominalArm Arm>
Framed<ChainOf<Arm>> in_frames(const Arm& arm) {
  return Framed<ChainOf<Arm>>(arm);
}
/// The chain of a robot between frames that are identity.
template <int N, class Convention>
Framed<DhChain<N, Convention>> in_frames(const Robot<N, Convention>& robot) {
  return Framed<DhChain<N, Convention>>(robot.chain);
}

/// Where the parameters of an arm stand in a vector: six of the base frame, five per row of the chain, six of the tool
/// frame.
struct ArmParameters {
  /// The first one of the chain.
  static constexpr Index chain_begin = 6;
  /// The first one behind the chain: of the tool frame.
  static constexpr Index chain_end(Index joints) { return chain_begin + 5 * joints; }
  /// One of a row, from 0.
  static constexpr Index of_row(Index row, DhParameter parameter) {
    return chain_begin + 5 * row + static_cast<Index>(parameter);
  }
};

/// What `Framed<DhChain<N, Convention>>` is for a number of joints known at compile time: what identification computes
/// with, so that it is compiled once for all arms. Its parameters are in the order of `ArmParameters`.
class ArmGeometry {
 public:
  /// A chain between frames.
  template <int N, class Convention>
  explicit ArmGeometry(const Framed<DhChain<N, Convention>>& arm)
      : ArmGeometry(detail::ChainTable(arm.model().view()), arm.base_frame(), arm.tool_frame()) {}
  /// @param chain     its rows
  /// @param base,tool its frames
  ArmGeometry(detail::ChainTable chain, const FrameParameters& base, const FrameParameters& tool)
      : chain_(std::move(chain)), base_(base), tool_(tool) {}

  /// This arm as a chain between frames whose number of joints and convention are known at compile time.
  /// @throws std::invalid_argument where they are others
  template <int N, class Convention>
  Framed<DhChain<N, Convention>> framed(const DhChain<N, Convention>&) const {
    demand(joints() == N && chain_.modified() == Convention::modified, "ArmGeometry: an arm of ", joints(),
           " joints in the ", chain_.modified() ? "modified" : "standard", " convention, expected ", N, " in the ",
           Convention::modified ? "modified" : "standard", " one");
    std::array<DhRow, N> rows;
    std::copy(chain_.rows().begin(), chain_.rows().end(), rows.begin());
    return Framed<DhChain<N, Convention>>(DhChain<N, Convention>::from_rows(rows), base_, tool_);
  }

  /// Number of joints.
  int joints() const { return chain_.joints(); }
  /// Number of parameters.
  Index num_parameters() const { return ArmParameters::chain_end(joints()) + 6; }
  /// The parameter to which a joint's value adds: theta of a revolute joint, d of a prismatic one.
  Index joint_parameter(int joint) const {
    return ArmParameters::of_row(joint, chain_.revolute(joint) ? DhParameter::theta : DhParameter::d);
  }
  /// The chain between the frames.
  const detail::ChainTable& chain() const { return chain_; }
  /// Base frame with its six values.
  const FrameParameters& base() const { return base_; }
  /// Tool frame with its six values.
  const FrameParameters& tool() const { return tool_; }
  /// This chain between other frames.
  VERNIER_API ArmGeometry with_frames(const FrameParameters& base, const FrameParameters& tool) const {
    return {chain_, base, tool};
  }

  /// Values of the parameters [m, rad].
  VERNIER_API VectorX parameters() const;
  /// A frame whose six values do not change keeps its matrix bit for bit.
  VERNIER_API ArmGeometry with_parameters(const ConstVectorRef& values) const;
  /// Names of the parameters.
  VERNIER_API std::vector<std::string> parameter_names() const;
  /// What each parameter measures.
  VERNIER_API std::vector<ParameterKind> parameter_kinds() const;

  /// Tool positions [m] at n configurations, n x joints.
  VERNIER_API PointRows positions(const ConstMatrixRef& joints) const;
  /// base_T_tool at n configurations.
  VERNIER_API std::vector<Isometry3> poses(const ConstMatrixRef& joints) const;
  /// Poses and parameter Jacobians at n configurations.
  VERNIER_API void poses_and_parameter_jacobians(const ConstMatrixRef& joints, PosesAndJacobians& out) const;

 private:
  detail::ChainTable chain_;
  FrameParameters base_, tool_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/arm_geometry.ipp"
#endif
