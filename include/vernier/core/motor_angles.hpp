// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Angles of the motors behind the joints of a chain, and what errors of these angles do to the joints.

#include <vector>

#include "vernier/core/controller_map.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// The motors of an arm whose gears err as functions of its controller's joints: one value a joint of the chain. The
/// first ones are those joints. The further ones are the passive joints of the chain, which have no motor: their
/// functions are of their own angles. An error `e` of the motors moves the chain's joints by `S e`, S the square matrix
/// of the controller's map.
class MotorAngles {
 public:
  /// The joints of the chain have motors of their own.
  MotorAngles() = default;
  /// Those of a controller; none where its errors are of the chain's joints (`ControllerMap::motor_errors`).
  VERNIER_API explicit MotorAngles(const ControllerMap& controller);

  /// Whether motors are those of the chain's joints.
  bool none() const { return from_chain_.rows() == 0; }
  /// The map that they follow from.
  const ControllerMap& controller() const { return controller_; }
  /// The first row of the chain that a motor moves, from 0: it tells whether the motor turns or slides.
  int row_of(int motor) const { return none() ? motor : rows_[static_cast<std::size_t>(motor)]; }

  /// By how much a joint of the chain moves where a motor errs by one: an entry of S. Where there are motors.
  double moved(int joint, int motor) const { return to_chain_(joint, motor); }

  /// By how much a motor turns where a joint of the chain moves by one: an entry of B. Where there are motors.
  double depends(int motor, int joint) const { return from_chain_(motor, joint); }
  /// Angles of the motors where all joints of the chain are 0 [rad, m]. Where there are motors.
  const VectorX& zeros() const { return zeros_; }

  /// Motor angles at joint values of the chain. Does not allocate.
  /// @param joints one value a joint [rad, m]; where one is not finite, neither are the motors that it depends on
  /// @param out    as many values
  VERNIER_API void angles(const double* joints, double* out) const noexcept;
  /// Motor angles at n configurations; the configurations where there are none.
  /// @param joints n x joints [rad, m]
  VERNIER_API MatrixX angles(const ConstMatrixRef& joints) const;
  /// Adds `S e` to joint values, and `S E B` to their derivative: B the derivative of the motor angles. Does not
  /// allocate.
  /// @param errors     e, one value a motor
  /// @param rates      E, its derivative by the motor angles, n x n by columns
  /// @param effective  one value a joint of the chain
  /// @param derivative n x n, by columns
  VERNIER_API void add(const double* errors, const double* rates, double* effective, double* derivative) const noexcept;
  /// Columns of unit errors of the motors, in place of columns of unit errors of the chain's joints: their product
  /// with S.
  /// @param columns rows x n by columns
  VERNIER_API void to_motors(double* columns, int rows) const noexcept;
  /// The gradient by the chain's joints of a function whose gradient by the motor angles is known: its product with B.
  VERNIER_API void to_chain_gradient(double* gradient) const noexcept;

  /// Equal maps.
  bool operator==(const MotorAngles& other) const { return none() == other.none() && controller_ == other.controller_; }

 private:
  ControllerMap controller_{};
  MatrixX to_chain_{}, from_chain_{};  // S; B
  VectorX zeros_{};                    // of the motor angles
  std::vector<int> rows_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/motor_angles.ipp"
#endif
