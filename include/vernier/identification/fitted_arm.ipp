// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/identification/fitted_arm.hpp"

namespace vernier {

VERNIER_IMPL FittedArm FittedArm::with_hysteresis_of(const FittedArm& other) const {
  JointTerms terms = errors.empty() ? JointTerms(geometry.joints()) : errors.terms();
  terms.motors = other.errors.terms().motors;
  terms.hysteresis = other.errors.terms().hysteresis;
  VectorX coefficients = VectorX::Zero(terms.size());
  for (const JointTermBlock& now : terms.blocks()) {
    const JointErrors& from = now.kind == JointTermBlock::Kind::hysteresis ? other.errors : errors;
    for (const JointTermBlock& block : from.terms().blocks())
      if (block.kind == now.kind && block.joint == now.joint)
        VERNIER_LATER(coefficients).segment(now.begin, now.count) =
            VERNIER_LATER(from.coefficients()).segment(block.begin, block.count);
  }
  return {geometry, JointErrors(std::move(terms), std::move(coefficients))};
}

}  // namespace vernier
