// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <utility>

#include "vernier/core/same_value.hpp"

#include "vernier/simulation/error_sources.hpp"

namespace vernier::detail {

VERNIER_IMPL JointErrors draw_joint_errors(const ChainTable& chain, const JointErrorSizes& sizes, std::uint64_t seed) {
  const int n = chain.joints();
  for (const auto& [value, name] :
       std::initializer_list<std::pair<double, const char*>>{{sizes.gear_ratio, "gear_ratio"},
                                                             {sizes.coupling, "coupling"},
                                                             {sizes.compliance, "compliance"},
                                                             {sizes.harmonic, "harmonic"},
                                                             {sizes.decay, "decay"},
                                                             {sizes.payload, "payload"},
                                                             {sizes.ripple, "ripple"}})
    demand(value >= 0 && std::isfinite(value), "JointErrorSizes: ", name, " is ", value,
           ", must be 0 or more and finite");
  demand(sizes.harmonics >= 0 && sizes.harmonics <= 500, "JointErrorSizes: harmonics is ", sizes.harmonics,
         ", must lie in 0..500");
  demand(same_value(sizes.ripple, 0) || (sizes.ripple_harmonic > sizes.harmonics && sizes.ripple_harmonic <= 500),
         "JointErrorSizes: ripple_harmonic is ", sizes.ripple_harmonic, ", must lie above harmonics (", sizes.harmonics,
         ") and in 1..500");
  demand(sizes.controller.same() || sizes.controller.chain_joints() == n, "JointErrorSizes: a controller of ",
         sizes.controller.chain_joints(), " joints of the chain for a chain of ", n);

  JointTerms terms(n);
  terms.motors = MotorAngles(sizes.controller);
  terms.gear_ratio = sizes.gear_ratio > 0;
  terms.coupling = sizes.coupling > 0;
  if (sizes.compliance > 0) terms.gravity.emplace(chain, sizes.down);
  if (sizes.payload > 0) terms.payload.emplace(chain, sizes.down, Payload{0, Vector3::Zero()});
  const int low = sizes.harmonic > 0 ? sizes.harmonics : 0;
  Fourier harmonics = Fourier::up_to(low);
  if (sizes.ripple > 0) harmonics.orders.push_back(sizes.ripple_harmonic);
  for (int i = 0; i < n; ++i)
    if (chain.revolute(terms.motors.row_of(i))) terms.transmission[static_cast<std::size_t>(i)] = harmonics;

  VectorX coefficients = VectorX::Zero(terms.size());
  Index at = 0;
  const auto draw = [&](Rng& rng, Index count, double size) {
    for (const Index end = at + count; at < end; ++at) coefficients(at) = size * rng.normal();
  };
  std::uint64_t stream = 0;  // every source and joint has its own
  Rng gear(child_seed(seed, stream++)), coupling(child_seed(seed, stream++)), compliance(child_seed(seed, stream++));
  if (terms.gear_ratio) draw(gear, n, sizes.gear_ratio);
  if (terms.coupling) draw(coupling, n - 1, sizes.coupling);
  if (terms.gravity) {
    const Index begin = at;
    draw(compliance, terms.gravity->size(), sizes.compliance);
    for (Index k = begin; k < at; ++k) coefficients(k) = std::abs(coefficients(k));
  }
  if (terms.payload) {
    Rng springs(child_seed(seed, 1'000'000));  // behind those of any joint
    for (const Index end = at + n; at < end; ++at) coefficients(at) = sizes.payload * std::abs(springs.normal());
  }
  for (int i = 0; i < n; ++i) {
    Rng low_stream(child_seed(seed, stream++)), ripple_stream(child_seed(seed, stream++));
    if (at == terms.transmission_begin(i + 1)) continue;
    for (int k = 1; k <= low; ++k) draw(low_stream, 2, sizes.harmonic / std::pow(k, sizes.decay));
    if (sizes.ripple > 0) draw(ripple_stream, 2, sizes.ripple);
  }
  return {std::move(terms), std::move(coefficients)};
}

}  // namespace vernier::detail
