// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The joint errors that an error model may have, and their expected sizes.

#include <vector>

#include "vernier/error_model/error_model_options.hpp"
#include "vernier/error_terms/joint_errors.hpp"

namespace vernier::detail {

/// The expected spectrum of each joint, with the lines of its drive.
VERNIER_API std::vector<HarmonicSpectrum> spectra_of(const ErrorModelOptions& options, int joints);

/// Orders of a joint's harmonics: of the expected spectrum, and, from 400 measurements on, all lines of its drive.
/// Fewer determine no order above 60, and are not predicted better with them.
VERNIER_API Fourier orders_of_joint(const ErrorModelOptions& options, const std::vector<HarmonicSpectrum>& spectra,
                                    std::size_t joint, Index measurements);

/// No terms yet, of an arm whose gears err where the controller of the options says so.
/// @throws std::invalid_argument where that is the controller of a chain of another number of joints
VERNIER_API JointTerms no_terms(const ErrorModelOptions& options, int joints);

/// All terms that the options allow a number of measurements.
VERNIER_API JointTerms allowed_terms(const ChainTable& nominal, const ErrorModelOptions& options, Index measurements);

/// Expected sizes of the coefficients of some terms.
VERNIER_API VectorX expected_sizes(const JointTerms& terms, const ErrorModelOptions& options,
                                   const std::vector<HarmonicSpectrum>& spectra);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/expected_terms.ipp"
#endif
