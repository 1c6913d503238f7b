// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The unknowns of an arm seen from one or more stations: which there are, their values, and their effect on a pose.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/least_squares/row_block.hpp"

namespace vernier {

/// A geometric parameter that is estimated: of the chain, or of a frame.
struct GeometricUnknown {
  Index parameter;       ///< as `ArmGeometry` counts them
  int station = -1;      ///< whose frame it belongs to; -1: shared by all stations
  double scale = 1;      ///< unit in which it is estimated: the expected size of its error [m, rad]
  double precision = 0;  ///< of a prior around its start, in that unit: an inverse variance; 0 for none
  bool thermal = false;  ///< the change of the parameter with temperature [m/K, rad/K], not the parameter itself
  std::vector<int> shared_with{};  ///< further stations that have the same frame

  /// Whether it acts on a station.
  bool acts_on(int of_station) const {
    return station < 0 || station == of_station ||
           std::find(shared_with.begin(), shared_with.end(), of_station) != shared_with.end();
  }
};

/// Geometric unknowns and coefficients of joint errors. Estimation is in steps of their scales: geometry first, then
/// the coefficients in their own order.
class ArmParameterisation {
 public:
  /// @param arms     where to start, one a station, all with the same chain
  /// @param unknowns geometric parameters to estimate
  VERNIER_API ArmParameterisation(std::vector<ArmGeometry> arms, std::vector<GeometricUnknown> unknowns);

  /// Replaces the geometric unknowns; values stay, changes with temperature start from none.
  VERNIER_API void set_geometric(std::vector<GeometricUnknown> unknowns) {
    unknowns_ = std::move(unknowns);
    thermal_rates_.clear();
  }
  /// Replaces the terms of joint errors. Coefficients of terms that were there before keep their values; others are
  /// zero.
  /// @param terms      the new ones
  /// @param scales     units of the coefficients
  /// @param precisions of their zero-mean priors, in those units
  VERNIER_API void set_terms(JointTerms terms, VectorX scales, VectorX precisions);
  /// Replaces the precisions of the priors of all unknowns.
  VERNIER_API void set_precisions(const VectorX& precisions);

  /// Geometric unknowns.
  const std::vector<GeometricUnknown>& geometric() const { return unknowns_; }
  /// Terms of joint errors.
  const JointTerms& terms() const { return errors_.terms(); }
  /// Joint errors as they are.
  const JointErrors& joint_errors() const { return errors_; }
  /// Number of unknowns before the transmissions'.
  Index num_dense() const { return static_cast<Index>(unknowns_.size()) + terms().num_dense_terms(); }
  /// Number of unknowns.
  Index size() const { return static_cast<Index>(unknowns_.size()) + terms().size(); }
  /// Number of stations.
  int stations() const { return static_cast<int>(arms_.size()); }
  /// Chain and frames of a station, without joint errors.
  const ArmGeometry& geometry(int station) const { return arms_[static_cast<std::size_t>(station)]; }
  /// Changes of the parameters a kelvin; empty where no unknown is thermal.
  VERNIER_API VectorX thermal_rates(int station) const;
  /// Number of functions of each joint's transmission.
  VERNIER_API std::vector<Index> group_sizes() const;

  /// Scales of the unknowns.
  VERNIER_API VectorX scales() const;
  /// Precisions of the priors, in steps of the scales.
  VERNIER_API VectorX precisions() const;
  /// Present values in steps of the scales, relative to the means of the priors: the start for geometry, zero for
  /// coefficients.
  VERNIER_API VectorX steps() const;
  /// Adds to the present values.
  VERNIER_API void move(const VectorX& steps);
  /// Names; those of a frame of station s > 0 end in `@s+1`, those of changes with temperature in `/K`.
  VERNIER_API std::vector<std::string> names() const;

  /// Modelled poses at n configurations of a station.
  /// @param station  from 0
  /// @param joints   n x joints [rad, m]
  /// @param previous joint values from which they were approached, likewise; no rows where unknown
  VERNIER_API std::vector<Isometry3> poses(int station, const ConstMatrixRef& joints,
                                           const ConstMatrixRef& previous = MatrixX()) const;
  /// Modelled poses, and the columns of unit steps of all unknowns, not whitened: writes `dense`, `factor` (of a unit
  /// error of each joint, or motor) and `functions` of n blocks.
  /// @param station       from 0
  /// @param joints        n x joints [rad, m]
  /// @param previous      joint values from which they were approached, likewise; no rows where unknown
  /// @param out           n blocks
  /// @param joint_columns whether to write `factor` also where no coefficient acts through it; else it is empty then
  /// @param warmer        temperatures of the n samples above the reference [K]; none for zero
  /// @param payloads      n x 4, see `Dataset::payloads`; no rows for the reference payload
  VERNIER_API std::vector<Isometry3> linearise(int station, const ConstMatrixRef& joints,
                                               const ConstMatrixRef& previous, RowBlock* out, bool joint_columns = true,
                                               const ConstVectorRef& warmer = VectorX(),
                                               const ConstMatrixRef& payloads = MatrixX()) const;
  /// Values of the transmissions' functions at q, in units of scales.
  VERNIER_API void transmission_values(const double* q, VectorX& out) const;
  /// Those at angles of the motors, where those err; see `JointTerms`.
  VERNIER_API void function_values(const double* motors, VectorX& out) const;

 private:
  template <class F>
  VectorX joined(const F& of_unknown, const VectorX& of_coefficients) const;

  std::vector<ArmGeometry> arms_;
  std::vector<VectorX> start_;
  std::vector<GeometricUnknown> unknowns_;
  std::vector<double> thermal_rates_{};  // of each geometric unknown; empty for zero
  JointErrors errors_;
  VectorX coefficient_scales_, coefficient_precisions_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/arm_parameterisation.ipp"
#endif
