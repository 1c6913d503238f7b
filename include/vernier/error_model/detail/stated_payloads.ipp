// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/error_model/detail/stated_payloads.hpp"

namespace vernier::detail {

VERNIER_IMPL std::optional<StatedPayloads> stated_payloads(const CalibrationProblem& problem) {
  const MeasuredSet* stated = nullptr;
  std::vector<Payload> all;
  for (std::size_t s = 0; s < problem.sets().size(); ++s) {
    const MatrixX& rows = problem.sets()[s].payloads;
    if (rows.rows() > 0) stated = &problem.sets()[s];
    const Vector3 tool = translation(problem.arm.geometry(static_cast<int>(s)).tool().isometry());
    for (Index i = 0; i < rows.rows(); ++i) all.push_back(Payload::of(rows, i).at(tool));
  }
  if (stated == nullptr) return {};
  for (const MeasuredSet& set : problem.sets())
    demand(!set.locates() || set.payloads.rows() > 0, "fit_error_model: ", set.name, " states no payload, but ",
           stated->name, " does");
  StatedPayloads out{{0, Vector3::Zero()}};
  Vector3 centre = Vector3::Zero();
  for (const Payload& one : all) {
    out.mean.mass += one.mass / static_cast<double>(all.size());
    out.mean.centre += one.mass / static_cast<double>(all.size()) * one.centre;
    centre += one.centre / static_cast<double>(all.size());
  }
  out.mean.centre = out.mean.mass > 0 ? Vector3(out.mean.centre / out.mean.mass) : centre;
  constexpr double grams = 1e-3, metres = 1e-3;
  for (const Payload& one : all) {
    const Vector3 moment = one.mass * one.centre - out.mean.mass * out.mean.centre;
    out.vary = out.vary || std::abs(one.mass - out.mean.mass) > grams || moment.norm() > grams + metres * out.mean.mass;
  }
  if (!out.vary) out.mean = all.front();
  return out;
}

}  // namespace vernier::detail
