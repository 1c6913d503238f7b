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

VERNIER_IMPL JointTerms no_terms(const ErrorModelOptions& options, int joints) {
  const ControllerMap& controller = options.controller;
  demand(controller.same() || controller.chain_joints() == joints, "fit_error_model: a controller of ",
         controller.chain_joints(), " joints of the chain for an arm of ", joints);
  JointTerms out(joints);
  out.motors = MotorAngles(controller);
  return out;
}

VERNIER_IMPL JointTerms allowed_terms(const ChainTable& nominal, const ErrorModelOptions& options, Index measurements) {
  const int joints = nominal.joints();
  const std::vector<HarmonicSpectrum> spectra = spectra_of(options, joints);
  JointTerms out = no_terms(options, joints);
  for (int j = 0; j < joints; ++j)
    if (nominal.revolute(out.motors.row_of(j)))
      out.transmission[static_cast<std::size_t>(j)] =
          orders_of_joint(options, spectra, static_cast<std::size_t>(j), measurements);
  const bool jointwise = out.size() > 0;
  for (const JointTermTraits& row : joint_term_rows) {
    const bool of_joint_values =
        row.kind == JointTermBlock::Kind::gear_ratio || row.kind == JointTermBlock::Kind::coupling;
    const auto parameters = options.parameters(row.kind, options.down);
    if (parameters && (jointwise || !of_joint_values)) out.add(row.kind, nominal, *parameters);
  }
  return out;
}

VERNIER_IMPL VectorX expected_sizes(const JointTerms& terms, const ErrorModelOptions& options,
                                    const std::vector<HarmonicSpectrum>& spectra) {
  VectorX out(terms.size());
  for (const JointTermBlock& block : terms.blocks())
    for (Index k = 0; k < block.count; ++k) {
      const auto joint = static_cast<std::size_t>(block.joint);
      out(block.begin + k) = block.kind == JointTermBlock::Kind::transmission
                                 ? expected_std(spectra[joint], terms.transmission[joint].order(k))
                                 : options.expected_size(terms, block, k);
    }
  return out;
}

}  // namespace vernier::detail
