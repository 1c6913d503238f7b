// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The unknowns of an arm and the measurements that determine them, as one least-squares problem: the one place where a
/// measurement meets a model.

#include <array>
#include <optional>
#include <vector>

#include "vernier/identification/arm_parameterisation.hpp"
#include "vernier/identification/session_drift.hpp"
#include "vernier/least_squares/damped_iteration.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// Residuals of all rows that were measured, and their Jacobian.
struct StackedRows {
  VectorX residuals;
  MatrixX jacobian;                  ///< rows x unknowns; empty where it is not needed
  std::vector<Index> block;          ///< of each row
  std::vector<bool> of_orientation;  ///< of each row
};

/// A parameterisation of an arm, and sets of measurements, each in a frame of its own.
class CalibrationProblem {
 public:
  /// @param start       with as many stations as there are sets
  /// @param sets        those that locate the base first
  /// @param joint_sigma standard deviation of the joint readings [rad, m]; 0: exact
  VERNIER_API CalibrationProblem(ArmParameterisation start, std::vector<MeasuredSet> sets, Loss loss,
                                 double joint_sigma = 0);

  ArmParameterisation arm;           ///< at its present values
  std::vector<SessionDrift> drift;   ///< of each set, at its present values; may be empty
  double reference_temperature = 0;  ///< at which thermal unknowns have no effect [deg C]
  std::optional<JointPrior> prior;   ///< with correlations; of unknowns that have no prior of their own
  ExecutorRef executor{};            ///< computes the normal equations
  double loss_scale = 1;             ///< multiple of the usual thresholds of the loss
  bool joint_columns = true;         ///< whether blocks have `factor` also where no coefficient acts through it

  Loss loss() const { return loss_; }
  Index num_blocks() const { return static_cast<Index>(blocks_.size()); }
  /// The first blocks, on which models are validated: measured positions where there are any, else all.
  Index num_validation_blocks() const { return validation_blocks_; }
  /// Number of different poses among them.
  Index num_validation_poses() const { return validation_poses_; }
  const MeasuredSet& set_of(Index block) const { return sets_[static_cast<std::size_t>(at(block).station)]; }
  const std::vector<MeasuredSet>& sets() const { return sets_; }
  int station_index(Index block) const { return at(block).station; }
  /// Which measurement of its set a block is.
  Index row_of(Index block) const { return at(block).row; }
  /// Measured values: three per position, six per pose, one per distance or height.
  VERNIER_API Index measured_values() const;
  /// Joint values of all samples, blocks x joints.
  VERNIER_API MatrixX joints() const;

  /// Temperatures of the poses.
  struct Temperatures {
    double mean = 0, std = 0;       ///< [deg C]; both 0 where a set has none
    std::array<double, 2> range{};  ///< lowest and highest
  };
  VERNIER_API Temperatures temperatures() const;

  /// The first set with the base of a set.
  std::size_t place_of(std::size_t set) const { return first_of_place(sets_, set); }
  /// Lets the bases of sets that locate them drift from now on, from no motion; those of one place together.
  /// @param rows_per_knot number of poses from one knot to the next, on average
  VERNIER_API void start_drift(Index rows_per_knot);
  /// Lets the joints' zeros drift along, from no change.
  VERNIER_API void start_joint_drift();
  /// No drift any more.
  VERNIER_API void stop_drift() { drift.clear(); }
  /// No drift of the joints' zeros any more.
  VERNIER_API void stop_joint_drift();
  /// Precision of the random walks of bases, relative to steps of 0.03 mm and 20 urad in 200 poses.
  double drift_precision = 1;
  /// Precision of the random walks of joints' zeros, relative to steps of 10 urad or 10 um in 200 poses.
  double joint_drift_precision = 1;
  /// The priors of the drift: random walks, held near zero, which is the stations' base.
  VERNIER_API std::vector<LocalPrior> drift_priors() const;
  /// Present values of the drift, in units of their expected sizes.
  VERNIER_API VectorX drift_steps() const;
  /// Changes of the joints' zeros at a block; empty where they rest.
  VERNIER_API VectorX drift_joint_zeros(Index block) const;
  /// Variance of the drift's change from knot to knot beyond the session: at least the expected one, because a session
  /// without drift says little about the next hours.
  /// @param noise_variance of the whitened noise, to which precisions are relative
  VERNIER_API VectorX drift_step_variance(double noise_variance) const;
  /// The motion of a block's base by drift.
  VERNIER_API Isometry3 drift_motion(Index block) const;

  /// The problem as rows; refers to this.
  VERNIER_API BlockSystem system() const;
  /// Its normal equations at the present values, with `prior`.
  /// @param same_functions see `NormalEquations`; not with `prior`
  VERNIER_API NormalEquations normal_equations(const NormalEquations* same_functions = nullptr) const;
  /// Evaluates blocks first .. first + count - 1: residuals and columns divided by the sensors' sigmas and weighted by
  /// the loss. Errors of joint readings are unknowns of each pose with a prior, eliminated here in closed form.
  VERNIER_API void operator()(Index first, Index count, RowBlock* out) const;
  /// All rows at once.
  VERNIER_API StackedRows stacked(bool with_jacobian) const;
  /// All rows at once, into rows of this problem: their memory is used again.
  VERNIER_API void stack(bool with_jacobian, StackedRows& out) const;

  /// Weights of the loss from the present residuals.
  /// @return sums of the squared norms of residuals: with the weights of before, and with the new ones
  VERNIER_API std::array<double, 2> reweight();
  /// All weights one.
  VERNIER_API void reset_weights();
  /// Thresholds of the loss at the present residuals, of unit weights: of positions, orientations, and single numbers
  /// (distances, heights); 0 where there are none.
  VERNIER_API std::array<double, 3> thresholds() const;

  /// Minimises from the present values, see `minimise`. A robust loss leaves its weights behind.
  /// @param least_gain ends where a step lowers the sum of squares by less than this share
  VERNIER_API IterationEnd solve(int max_iterations, double least_gain);
  /// Minimises to the usual precision.
  /// @return whether the iteration converged
  VERNIER_API bool solve(int max_iterations = 20);

 private:
  struct Block {
    int station;
    Index row;
    std::array<double, 2> weight;  ///< in [0, 1]: of position or distance, of orientation
  };
  const Block& at(Index block) const { return blocks_[static_cast<std::size_t>(block)]; }
  /// Adds to the drift.
  VERNIER_API void move_drift(const VectorX& steps);
  /// Moves a modelled pose by the drift, turns its columns along, and writes those of the drift.
  VERNIER_API void add_drift(const Block& block, Isometry3& pose, RowBlock& rows) const;
  /// Norms of whitened residuals, blocks x 2: of positions or distances, of orientations.
  VERNIER_API MatrixX residual_norms() const;

  std::vector<MeasuredSet> sets_;
  double joint_sigma_;
  std::vector<Block> blocks_;
  Index validation_blocks_ = 0, validation_poses_ = 0;
  std::vector<Index> poses_;                // of each validation block; empty where each is of its own
  std::vector<Index> first_state_;          // of each set
  VectorX drift_scale_ = VectorX::Ones(6);  // as the rows of knots
  Loss loss_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/calibration_problem.ipp"
#endif
