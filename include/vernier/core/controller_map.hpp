// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The joint values that a controller shows and takes, and those of the chain behind them.

#include <span>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

namespace detail {

inline constexpr int most_controller_joints = 64;

}  // namespace detail

/// How the M joint values of a controller become the N of a chain, M <= N: `q_chain = A q_controller + b`. A has whole
/// numbers: signs, and couplings of joints. b are zeros [rad, m]. A palletiser has fewer controller joints than its
/// chain, because a joint of its wrist is passive.
///
///     const ControllerMap fanuc({"J1", "J2", "-J2 - J3", "-J4", "-J5", "-J6"});
///     const MatrixX chain = fanuc.to_chain(joints);  // and back: fanuc.to_controller(chain)
///
/// Both ways are exact: A has an inverse of whole numbers. A default map is of an arm of any number of joints whose
/// controller counts as its chain does.
class ControllerMap {
 public:
  /// The joints of the controller are those of the chain.
  ControllerMap() = default;
  /// @param coefficients A, N x M
  /// @param zeros        b, N values [rad, m]
  /// @throws std::invalid_argument where A has no inverse of whole numbers
  VERNIER_API ControllerMap(const ConstMatrixRef& coefficients, const ConstVectorRef& zeros);
  /// A map of formulas, one a joint of the chain: sums of controller joints `J1` .. and of constants with a unit, e.g.
  /// `-J2 - J3`, `-(J2 + J3)`, `J2 - 90 deg`, `J1 + 0.5 m`. Units are deg, rad, mm and m.
  /// @param formulas one a joint of the chain
  /// @param types    of the joints of the chain; none: all are revolute
  /// @throws std::invalid_argument naming the formula
  VERNIER_API explicit ControllerMap(std::span<const std::string> formulas, std::span<const JointType> types = {});

  /// Whether the controller's joints are those of the chain, whatever their number.
  bool same() const { return square_.rows() == 0; }
  /// Number of controller joints of an arm.
  /// @param chain_joints number of joints of its chain
  /// @throws std::invalid_argument where the map is of a chain of another number of joints
  VERNIER_API int joints(int chain_joints) const;
  /// Number of controller joints; 0 where they are the same.
  int joints() const { return joints_; }
  /// Number of joints of the chain; 0 where any will do.
  int chain_joints() const { return static_cast<int>(square_.rows()); }

  /// Joint values of the chain, n x N.
  /// @param controller n x M [rad, m]
  /// @throws std::invalid_argument on another number of columns
  VERNIER_API MatrixX to_chain(const ConstMatrixRef& controller) const;
  /// Joint values of the controller, n x M. What passive joints differ from their law is left out.
  /// @param chain n x N [rad, m]
  /// @throws std::invalid_argument on another number of columns
  VERNIER_API MatrixX to_controller(const ConstMatrixRef& chain) const;

  /// The box of chain joints that a box of controller joints reaches.
  /// @param lower,upper limits, at least one a joint of the controller [rad, m]; infinite where there are none
  /// @return            lower limits of the chain's joints, then upper ones, n x 2
  VERNIER_API MatrixX chain_limits(const ConstVectorRef& lower, const ConstVectorRef& upper) const;

  /// Types of the controller's joints.
  /// @param chain those of the chain's joints; none: not known
  /// @throws std::invalid_argument where a joint moves revolute and prismatic joints alike, or on another number
  VERNIER_API std::vector<JointType> types(std::span<const JointType> chain) const;
  /// The formulas that make this map.
  /// @param chain types of the chain's joints
  VERNIER_API std::vector<std::string> formulas(std::span<const JointType> chain) const;
  /// The joints whose gears err, one a joint of the chain: these formulas, or where motors err `J1` .. and the formulas
  /// of passive joints.
  VERNIER_API std::vector<std::string> erring_joints(std::span<const JointType> chain) const;

  /// A with further columns, N x N: of passive joints, by how much each differs from its law. These are 0 in every
  /// command. Empty where the joints are the same.
  const MatrixX& square() const { return square_; }
  /// The inverse of `square`, whole numbers.
  const MatrixX& inverse() const { return inverse_; }
  /// b [rad, m].
  const VectorX& zeros() const { return zeros_; }

  /// This map of a controller whose motors err: errors of gears are functions of its joints, as in the drives of a
  /// parallelogram. By default they are those of the chain's joints.
  ControllerMap with_motor_errors(bool of_motors = true) const {
    ControllerMap out = *this;
    out.motor_errors_ = of_motors;
    return out;
  }
  /// Whether errors of gears are functions of the controller's joints.
  bool motor_errors() const { return motor_errors_; }

  /// Equal in every number, and in where gears err.
  VERNIER_API bool operator==(const ControllerMap& other) const;

 private:
  VERNIER_API void complete(const MatrixX& coefficients);

  int joints_ = 0;
  bool motor_errors_ = false;
  MatrixX square_{}, inverse_{};
  VectorX zeros_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/controller_map.ipp"
#endif
