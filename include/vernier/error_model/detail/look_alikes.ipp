// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "vernier/error_model/detail/look_alikes.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// A kind of joint errors that may look like another one.
struct LookAlike {
  BlockChoice* found = nullptr;          ///< its choice, if it was found
  std::vector<UnknownGroup> unknowns{};  ///< those whose sizes have a common factor
  /// Whether it has unknowns: options may switch it off.
  VERNIER_LOCAL bool possible() const {
    return std::any_of(unknowns.begin(), unknowns.end(), [](const UnknownGroup& group) { return !group.empty(); });
  }
};

/// The last decision on deflection, functions of joints and gears, where that says that they exist.
VERNIER_LOCAL std::vector<LookAlike> found_look_alikes(ModelSelection& model) {
  std::vector<LookAlike> out(3);
  for (BlockChoice& choice : model.blocks) {  // in order: the last one counts
    BlockChoice* found = choice.existence.answer == Answer::found ? &choice : nullptr;
    if (choice.block == Block::elastic || choice.block == Block::elastic_again) out[0].found = found;
    if (choice.block == Block::jointwise) out[1].found = found;
    if (choice.block == Block::gears) out[2].found = found;
  }
  return out;
}

VERNIER_IMPL void compare_look_alikes(ModelSelection& model, const JointTerms& all) {
  using Kind = JointTermBlock::Kind;
  std::vector<LookAlike> kinds = found_look_alikes(model);
  const bool any = std::any_of(kinds.begin(), kinds.end(), [](const LookAlike& one) { return one.found != nullptr; });
  if (!any || model.problem.num_validation_poses() >= ModelSelection::many_poses) return;

  const ArmParameterisation before = model.problem.arm;
  model.extend_terms(all);
  kinds[0].unknowns = {model.gravity()};
  kinds[1].unknowns = {model.harmonics(1, 1), model.harmonics(2, 3),
                       model.harmonics(4, (std::numeric_limits<int>::max)())};
  kinds[2].unknowns = {model.of_kinds({Kind::gear_ratio}), model.of_kinds({Kind::coupling})};
  VectorX precisions = model.problem.arm.precisions();
  for (const LookAlike& kind : kinds)
    for (const UnknownGroup& group : kind.unknowns)
      for (const Index k : group)
        if (precisions(k) >= suppressing_precision) precisions(k) = 1;

  const ModelSelection::Linearised& at = model.linearised();
  const Index values = model.problem.measured_values();
  /// Learns the sizes of all kinds but one.
  /// @return logarithm of their evidence
  const auto learn = [&](const LookAlike* absent, VectorX& sizes) {
    constexpr int iterations = 8;
    std::vector<UnknownGroup> groups;
    for (const LookAlike& kind : kinds)
      for (const UnknownGroup& group : kind.unknowns) {
        if (&kind != absent) groups.push_back(group);
        for (const Index k : group)
          if (&kind == absent) sizes(k) = suppressing_precision;
      }
    sizes = learn_priors(at.normal, sizes, at.steps, values, groups, iterations, at.local_steps);
    return log_evidence(at.normal, FactorisedEquations(at.normal, sizes, at.steps, at.local_steps), sizes, at.steps,
                        values, at.local_steps);
  };
  const bool alone = std::count_if(kinds.begin(), kinds.end(), [](const LookAlike& one) { return one.possible(); }) < 2;
  const double of_all = learn(nullptr, precisions);
  for (const LookAlike& kind : kinds) {
    if (alone || kind.found == nullptr) continue;
    VectorX others = precisions;
    constexpr double strong = 3;  // a factor of 20
    Existence& existence = kind.found->existence;
    existence.look_alike = !(of_all - learn(&kind, others) > strong);
    if (!existence.look_alike) continue;
    existence.answer = Answer::undecided;
    existence.interval[0] = 0;
    existence.poses = 0;
  }
  model.problem.arm = before;
  model.extended();
}

}  // namespace vernier::detail
