// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which blocks of unknowns a calibration has: whether they exist by a score test, sizes of their priors by evidence,
/// inclusion by left-out errors.

#include <initializer_list>
#include <optional>
#include <vector>

#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/error_model/error_model_options.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/least_squares/evidence.hpp"
#include "vernier/least_squares/leave_one_out.hpp"
#include "vernier/least_squares/score_test.hpp"

namespace vernier::detail {

/// A calibration problem that grows by blocks of unknowns, as far as its measurements support them.
class ModelSelection {
 public:
  /// @param nominal the chain as designed
  VERNIER_API ModelSelection(CalibrationProblem start, const ErrorModelOptions& options,
                             std::vector<HarmonicSpectrum> spectra_of_joints, ChainTable nominal);

  CalibrationProblem problem;                ///< call `changed` after a change of its unknowns or their values
  std::vector<HarmonicSpectrum> spectra;     ///< of each joint, with the lines of its drive and those that were found
  std::vector<BlockChoice> blocks{};         ///< decisions so far, in order
  const Index stride;                        ///< every stride-th pose is left out
  bool converged = true;                     ///< whether every `solve` converged
  mutable double leave_one_out_seconds = 0;  ///< time that leave-one-pose-out errors took

  /// Number of poses from which every band of orders has a prior size of its own.
  static constexpr Index many_poses = 500;

  /// The problem, linearised at its present values.
  struct Linearised {
    BlockSystem system;
    NormalEquations normal;
    VectorX steps, local_steps;
  };
  /// Computed again only after a change.
  VERNIER_API const Linearised& linearised() const;
  VERNIER_API void changed() {
    linearised_.reset();
    before_.reset();
  }
  /// Call in place of `changed` after unknowns were added at zero, or such unknowns were taken back: of harmonics that
  /// stay, the sums are known.
  VERNIER_API void extended();
  /// Equations at the present values, of which those of the harmonics may be copied; null where there are none.
  const NormalEquations* of_same_functions() const { return problem.prior ? nullptr : &linearised().normal; }

  /// Solves the problem as it is.
  VERNIER_API void solve();
  /// Steps towards the solution: enough where the unknowns change again soon.
  VERNIER_API void steps(int count);

  /// Poses left out one at a time, under some priors; ten blocks of neighbouring poses, if the poses are ordered.
  VERNIER_API LeftOutBlocks left_out(const Linearised& at, const VectorX& precisions) const;
  /// The same of equations that are factorised.
  VERNIER_API LeftOutBlocks left_out(const Linearised& at, const FactorisedEquations& solved) const;
  /// Norms of their position errors as the problem is [m].
  VERNIER_API VectorX left_out_errors() const;
  /// Whether poses follow a path, and are left out in blocks of neighbours.
  bool ordered() const { return !left_together_.empty(); }
  /// The position errors [m], 3 x poses, from equations that are factorised.
  VERNIER_API Eigen::Matrix3Xd left_out_errors(const FactorisedEquations& solved) const;

  /// Replaces the terms by more, if the additional ones exist and do not predict worse.
  /// @return whether they are in the model
  VERNIER_API bool add(Block block, const JointTerms& terms);
  /// The terms of the problem and more orders of transmissions, whose expected sizes are in `spectra`; other priors
  /// stay.
  VERNIER_API void extend_terms(const JointTerms& terms);
  /// Includes some unknowns with sizes by evidence, if they exist and do not predict worse; else suppresses them.
  /// @param score of a test of them; none: they are tested beside the unknowns that there are
  /// @return      whether they are in the model
  VERNIER_API bool choose_by_evidence(Block block, const UnknownGroup& group, std::optional<ScoreTest> score = {});
  /// Relative sizes that tested unknowns may have beside equal ones: amplitudes of harmonics, over the expected ones,
  /// that fall with their order, or with its square. None of blocks without harmonics.
  VERNIER_API std::vector<VectorX> shapes_of(Block block, const ScoreTest& score) const;
  /// A block of unknowns, by its scores and by the left-out errors with it and without.
  VERNIER_API BlockChoice choice_between(Block block, ScoreTest score, const VectorX& with, const VectorX& without,
                                         double precision) const;
  /// Each block's cluster: its pose, or neighbouring poses if the poses are ordered. Errors of the model are alike
  /// within a cluster, and independent between them.
  const std::vector<Index>& clusters() const { return clusters_; }

  /// Sizes of some coefficients by evidence, unless they are suppressed.
  VERNIER_API void size_by_evidence(const UnknownGroup& group);
  /// Sizes of the harmonics by evidence, at the solution: one common factor on the expected sizes; one for every band
  /// where there are poses enough, or where evidence speaks clearly against the expected spectrum.
  VERNIER_API void learn_spectrum(int iterations);

  /// Measures an effect that was found once more, beside the unknowns that there are now.
  VERNIER_API void measure_again(Block block, const UnknownGroup& group);

  /// Unknowns of some kinds of joint errors.
  VERNIER_API UnknownGroup of_kinds(std::initializer_list<JointTermBlock::Kind> kinds) const;
  /// Unknowns of gravity compliance, and of that to payload.
  UnknownGroup gravity() const { return of_kinds({JointTermBlock::Kind::gravity, JointTermBlock::Kind::payload}); }
  /// Unknowns of the transmissions, of orders first .. last.
  VERNIER_API UnknownGroup harmonics(int first, int last) const;

 private:
  /// Whether a group of unknowns exists, beside low orders of harmonics without priors: these pull them towards zero,
  /// and if they are large, that leaves residuals that look like gears or tilt. Among `many_poses` priors pull little.
  /// Every arm bends, so deflection need not be told from such functions.
  /// @param sized          precisions of the priors
  /// @param with, without  equations solved with the group and without
  VERNIER_API ScoreTest test(Block block, const UnknownGroup& group, const VectorX& sized,
                             const FactorisedEquations& with, const FactorisedEquations& without) const;
  VERNIER_API UnknownGroup unknowns(Index first, Index count) const;

  const ErrorModelOptions& options_;
  ChainTable nominal_;
  std::vector<Index> clusters_;       // of each block
  std::vector<Index> left_together_;  // of each validation block, if poses are ordered; else empty
  mutable std::optional<Linearised> linearised_{};
  mutable std::optional<NormalEquations> before_{};  // at the same values, with `harmonics_`
  mutable std::vector<Fourier> harmonics_{};         // of what was linearised last
  mutable std::vector<double> harmonic_scales_{};    // of their coefficients
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/model_selection.ipp"
#endif
