// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <iterator>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_terms/drive_lines.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<HarmonicSpectrum> spectra_of(const ErrorModelOptions& options, int joints) {
  demand(options.drives.empty() || options.drives.size() == static_cast<std::size_t>(joints),
         "fit_error_model: drives of ", options.drives.size(), " joints for an arm of ", joints);
  std::vector<HarmonicSpectrum> out(static_cast<std::size_t>(joints), options.spectrum);
  for (std::size_t j = 0; j < options.drives.size(); ++j)
    for (const HarmonicBand& line : lines_of(options.drives[j])) out[j].push_back(line);
  return out;
}

VERNIER_IMPL Fourier orders_of_joint(const ErrorModelOptions& options, const std::vector<HarmonicSpectrum>& spectra,
                                     std::size_t joint, Index measurements) {
  constexpr Index enough = 400;
  const int highest = measurements < enough ? (std::min)(60, options.harmonics) : options.harmonics;
  Fourier out = orders_of(spectra[joint], highest);
  if (options.drives.empty() || measurements < enough) return out;
  const Fourier lines = orders_of(lines_of(options.drives[joint]), (std::numeric_limits<int>::max)());
  std::vector<int> all;
  std::set_union(out.orders.begin(), out.orders.end(), lines.orders.begin(), lines.orders.end(),
                 std::back_inserter(all));
  return {all};
}

VERNIER_IMPL JointTerms allowed_terms(const ChainTable& nominal, const ErrorModelOptions& options, Index measurements) {
  const int joints = nominal.joints();
  const std::vector<HarmonicSpectrum> spectra = spectra_of(options, joints);
  JointTerms out(joints);
  if (options.compliance) out.gravity.emplace(nominal, options.down);
  for (int j = 0; j < joints; ++j)
    if (nominal.revolute(j))
      out.transmission[static_cast<std::size_t>(j)] =
          orders_of_joint(options, spectra, static_cast<std::size_t>(j), measurements);
  const bool jointwise = out.size() > out.num_dense_terms();
  out.gear_ratio = options.gear_ratio && jointwise;
  out.coupling = options.coupling && jointwise;
  if (options.hysteresis) out.hysteresis = hysteresis_widths();
  if (options.tilt) out.tilt.emplace(nominal, options.down);
  return out;
}

VERNIER_IMPL VectorX expected_sizes(const JointTerms& terms, const ErrorModelOptions& options,
                                    const std::vector<HarmonicSpectrum>& spectra) {
  VectorX out(terms.size());
  for (const JointTermBlock& block : terms.blocks())
    for (Index k = 0; k < block.count; ++k) {
      double& std = out(block.begin + k);
      switch (block.kind) {
        case JointTermBlock::Kind::gear_ratio: std = options.gear_ratio_prior_std; break;
        case JointTermBlock::Kind::coupling: std = options.coupling_prior_std; break;
        case JointTermBlock::Kind::gravity: std = options.compliance_prior_std; break;
        case JointTermBlock::Kind::payload: std = options.payload_prior_std; break;
        case JointTermBlock::Kind::hysteresis: std = options.hysteresis_prior_std; break;
        case JointTermBlock::Kind::tilt: std = options.tilt_prior_std; break;
        case JointTermBlock::Kind::straightness: {
          const auto order = static_cast<double>(k % terms.straightness->orders() + 1);
          std = options.straightness_prior_std / (order * order);
          break;
        }
        case JointTermBlock::Kind::transmission:
          std = expected_std(spectra[static_cast<std::size_t>(block.joint)],
                             terms.transmission[static_cast<std::size_t>(block.joint)].order(k));
          break;
      }
    }
  return out;
}

}  // namespace vernier::detail
