#pragma once

/// @file
/// Which blocks of unknowns a calibration has: sizes of their priors by evidence, inclusion by leave-one-pose-out
/// errors.

#include <optional>
#include <vector>

#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/error_model/error_model_options.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/least_squares/evidence.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

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

  /// Number of poses from which every band of orders has a prior size of its own, and leave-one-pose-out errors alone
  /// decide on blocks.
  static constexpr Index many_poses = 500;

  /// The problem, linearised at its present values.
  struct Linearised {
    BlockSystem system;
    NormalEquations normal;
    VectorX steps, local_steps;
  };
  /// Computed again only after a change.
  VERNIER_API const Linearised& linearised() const;
  VERNIER_API void changed() { linearised_.reset(); }

  /// Solves the problem as it is.
  VERNIER_API void solve();
  /// Steps towards the solution: enough where the unknowns change again soon.
  VERNIER_API void steps(int count);

  /// Poses left out one at a time, under some priors.
  VERNIER_API LeftOutBlocks left_out(const Linearised& at, const VectorX& precisions) const;
  /// Norms of their position errors as the problem is [m].
  VERNIER_API VectorX left_out_errors() const;
  /// The position errors [m], 3 x poses, from equations that are factorised.
  VERNIER_API Eigen::Matrix3Xd left_out_errors(const FactorisedEquations& solved) const;

  /// Replaces the terms by more, if leave-one-pose-out errors support the additional ones.
  /// @param by_evidence whether the sizes of their priors follow from evidence, or from these errors
  /// @return            whether they do
  VERNIER_API bool add(Block block, const JointTerms& terms, bool by_evidence);
  /// The terms of the problem and more orders of transmissions, whose expected sizes are in `spectra`; other priors
  /// stay.
  VERNIER_API void extend_terms(const JointTerms& terms);
  /// Includes some unknowns with sizes by evidence, if leave-one-pose-out errors support them; else suppresses them.
  /// @return whether they do
  VERNIER_API bool choose_by_evidence(Block block, const UnknownGroup& group);
  /// A block of unknowns, by the errors with it and without; of few poses also by log predictive densities.
  VERNIER_API BlockChoice choice_between(Block block, const LeftOutBlocks& with, const LeftOutBlocks& without,
                                         double precision) const;

  /// Sizes of some coefficients by evidence, unless they are suppressed.
  VERNIER_API void size_by_evidence(const UnknownGroup& group);
  /// Sizes of the harmonics by evidence, at the solution: one common factor on the expected sizes; one for every band
  /// where there are poses enough, or where evidence speaks clearly against the expected spectrum.
  VERNIER_API void learn_spectrum(int iterations);

  /// Unknowns of gravity compliance.
  VERNIER_API UnknownGroup gravity() const;
  /// Unknowns of the transmissions, of orders first .. last.
  VERNIER_API UnknownGroup harmonics(int first, int last) const;

 private:
  VERNIER_API BlockChoice choose_by_errors(Block block, Index first, Index count);
  VERNIER_API UnknownGroup unknowns(Index first, Index count) const;

  const ErrorModelOptions& options_;
  ChainTable nominal_;
  mutable std::optional<Linearised> linearised_{};
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/model_selection.ipp"
#endif
