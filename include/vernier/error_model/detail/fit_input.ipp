// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/error_model/detail/fit_input.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/detail/frame_sharing.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identifiable_parameters.hpp"

namespace vernier::detail {

VERNIER_IMPL void ErrorModelInput::place() {
  arms.clear();
  for (MeasuredSet& set : sets) {
    demand(set.size() >= 1, "fit_error_model: ", set.name, " has no measurements");
    const std::size_t s = arms.size(), first = first_of_place(sets, s);
    if (first != s)
      arms.push_back(starting_frames(arms[first], set, false, set.reflector != sets[first].reflector));
    else
      arms.push_back(sets.size() == 1 ? identified : placed(identified, set));
    require_spread(arms.back(), set);
  }
}

VERNIER_IMPL std::vector<GeometricUnknown> geometric_unknowns(const ErrorModelInput& input,
                                                              const ErrorModelOptions& options) {
  const std::size_t stations = input.sets.size();
  std::size_t locating = 0;
  while (locating < stations && input.sets[locating].locates()) ++locating;
  const Index chain_end = ArmParameters::chain_end(input.identified.joints());
  std::vector<GeometricUnknown> out;
  for (const Index k : input.identification.free) {
    const ParameterEstimate& p = input.identification.parameters[static_cast<std::size_t>(k)];
    const bool of_chain = k >= ArmParameters::chain_begin && k < chain_end;
    // thirty expected sizes do not affect what is determined
    const double deviation = std::isfinite(p.prior_std) ? p.prior_std / p.scale : 30;
    const double precision = of_chain ? input.identification.residual_variance / (deviation * deviation) : 0;
    if (of_chain) {
      out.push_back({k, -1, p.scale, precision});
      continue;
    }
    const bool of_base = k < 6;
    const std::size_t last = of_base && stations > 1 ? locating : stations;  // objects have bases of another kind
    for (GeometricUnknown& one : frame_of_sets(input.sets, of_base, options.tool_per_station, last)) {
      one.parameter = k;
      one.scale = p.scale;
      one.precision = precision;
      out.push_back(std::move(one));
    }
  }
  for (std::size_t s = locating; s < stations && stations > 1; ++s)  // frames of objects and fixed points
    for (const Index k : frame_unknowns(input.sets[s]))
      out.push_back({k, static_cast<int>(s), input.identification.parameters[static_cast<std::size_t>(k)].scale, 0});
  return out;
}

VERNIER_IMPL std::vector<Index> link_unknowns(const ArmParameterisation& arm) {
  const Index chain_end = ArmParameters::chain_end(arm.geometry(0).joints());
  std::vector<Index> out;
  for (std::size_t k = 0; k < arm.geometric().size(); ++k) {
    const GeometricUnknown& u = arm.geometric()[k];
    if (u.parameter >= ArmParameters::chain_begin && u.parameter < chain_end && !u.thermal)
      out.push_back(static_cast<Index>(k));
  }
  return out;
}

VERNIER_IMPL std::vector<Index> hidden_terms(const CalibrationProblem& problem, const ChainTable& nominal) {
  JointTerms terms = problem.arm.terms();
  terms.transmission.assign(terms.transmission.size(), Fourier{});
  const Index chain_end = ArmParameters::chain_end(nominal.joints());
  std::vector<GeometricUnknown> of_frames;
  for (const GeometricUnknown& u : problem.arm.geometric())
    if ((u.parameter < ArmParameters::chain_begin || u.parameter >= chain_end) && !u.thermal) of_frames.push_back(u);
  const auto frames = static_cast<Index>(of_frames.size());
  std::vector<ArmGeometry> arms;
  for (int s = 0; s < problem.arm.stations(); ++s)
    arms.emplace_back(nominal, problem.arm.geometry(s).base(), problem.arm.geometry(s).tool());
  ArmParameterisation arm(std::move(arms), std::move(of_frames));
  const Index first = problem.arm.num_dense() - terms.size();
  arm.set_terms(terms, VERNIER_LATER(problem.arm.scales()).segment(first, terms.size()), VectorX::Ones(terms.size()));

  const IdentifiableParameters columns(
      CalibrationProblem(std::move(arm), problem.sets(), Loss::squared).stacked(true).jacobian);
  const auto of_frame = [&](Index k) { return k < frames; };
  std::vector<Index> out;
  for (const auto& [column, absorbed_by] : columns.dependent)
    if (!of_frame(column) && !absorbed_by.empty() && std::all_of(absorbed_by.begin(), absorbed_by.end(), of_frame))
      out.push_back(column - frames);
  return out;
}

}  // namespace vernier::detail
