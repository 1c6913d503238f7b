// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/error_terms/joint_terms.hpp"

namespace vernier {

namespace detail {

/// The function of a joint's hysteresis with a width, in [-1, 1]; 0 where the approach is unknown.
VERNIER_LOCAL inline double step_of(const double* q, const double* previous, int joint, double width) noexcept {
  return previous == nullptr || !std::isfinite(previous[joint]) ? 0 : std::tanh((q[joint] - previous[joint]) / width);
}

/// A direction by its components.
VERNIER_LOCAL inline Vector3 direction_of(std::span<const double> parameters) {
  demand(parameters.size() == 3, "a direction has ", parameters.size(), " components, must have 3");
  const Vector3 out(parameters[0], parameters[1], parameters[2]);
  demand(std::abs(out.norm() - 1) < 1e-6, "must have length 1");
  return out;
}

}  // namespace detail

VERNIER_IMPL void detail::visit_common_terms(const JointTerms& first, const JointTerms& second,
                                             FunctionRef<void(Index a, Index b)> f) {
  for (const JointTermBlock& a : first.blocks())
    for (const JointTermBlock& b : second.blocks()) {
      if (a.kind != b.kind || a.joint != b.joint) continue;
      if (a.joint < 0) {
        for (Index k = 0; k < (std::min)(a.count, b.count); ++k) f(a.begin + k, b.begin + k);
        continue;
      }
      const Fourier &before = first.transmission[static_cast<std::size_t>(a.joint)],
                    &now = second.transmission[static_cast<std::size_t>(a.joint)];
      for (Index k = 0, l = 0; k < a.count && l < b.count;) {
        if (before.order(k) == now.order(l))
          f(a.begin + k++, b.begin + l++);
        else if (before.order(k) < now.order(l))
          ++k;
        else
          ++l;
      }
    }
}

VERNIER_IMPL void JointTerms::dense_basis(const double* q, const double* previous, MatrixRef out,
                                          const PayloadLoad& load) const noexcept {
  out.setZero();
  Index at = 0;
  double angles[max_joints], from[max_joints];
  const double *u = q, *before = previous;
  if (!motors.none()) {
    motors.angles(q, angles);
    u = angles;
    if (previous != nullptr) motors.angles(previous, from);
    before = previous != nullptr ? from : nullptr;
  }
  // the joints move by an error of motor i
  const auto set = [&](int i, double error) {
    for (int r = 0; r < joints; ++r) out(r, at) = motors.none() ? (r == i ? error : 0) : error * motors.moved(r, i);
    ++at;
  };
  if (gear_ratio)
    for (int i = 0; i < joints; ++i) set(i, linear_value(i, u[i]));
  if (coupling)
    for (int i = 1; i < joints; ++i) set(i, linear_value(i - 1, u[i - 1]));
  if (gravity) {
    gravity->basis(q, VERNIER_LATER(out).middleCols(at, gravity->size()));
    at += gravity->size();
  }
  if (payload) {
    double torques[max_joints];
    payload->torques(q, load, torques);
    for (int i = 0; i < joints; ++i) out(i, at++) = torques[i];
  }
  for (const double width : hysteresis)
    for (int i = 0; i < joints; ++i) set(i, detail::step_of(u, before, i, width));
}

VERNIER_IMPL void JointTerms::add_dense(const double* q, const double* previous, const PayloadLoad& load,
                                        const double* beta, double* effective, double* derivative) const noexcept {
  if (motors.none()) {
    add_of_motors(q, previous, beta, effective, derivative);
  } else {
    double angles[max_joints], before[max_joints], errors[max_joints], rates[max_joints * max_joints];
    std::fill_n(errors, joints, 0.0);
    std::fill_n(rates, joints * joints, 0.0);
    motors.angles(q, angles);
    if (previous != nullptr) motors.angles(previous, before);
    add_of_motors(angles, previous != nullptr ? before : nullptr, beta, errors, rates);
    motors.add(errors, rates, effective, derivative);
  }
  beta += (gear_ratio ? joints : 0) + (coupling ? joints - 1 : 0);
  if (gravity) {
    gravity->add(q, beta, effective, derivative);
    beta += gravity->size();
  }
  if (payload) payload->add(q, load, beta, effective, derivative);
}

VERNIER_IMPL void JointTerms::add_of_motors(const double* q, const double* previous, const double* beta,
                                            double* effective, double* derivative) const noexcept {
  const int n = joints;
  if (gear_ratio) {
    for (int i = 0; i < n; ++i) {
      const double linear = linear_value(i, q[i]);
      effective[i] += beta[i] * linear;
      if (same_value(linear, q[i])) derivative[i * n + i] += beta[i];
    }
    beta += n;
  }
  if (coupling) {
    for (int i = 1; i < n; ++i) {
      const double linear = linear_value(i - 1, q[i - 1]);
      effective[i] += beta[i - 1] * linear;
      if (same_value(linear, q[i - 1])) derivative[(i - 1) * n + i] += beta[i - 1];
    }
    beta += n - 1;
  }
  beta += (gravity ? gravity->size() : 0) + (payload ? n : 0);
  for (const double width : hysteresis) {
    for (int i = 0; i < n; ++i) {
      const double step = detail::step_of(q, previous, i, width);
      effective[i] += beta[i] * step;
      if (!same_value(step, 0)) derivative[i * n + i] += beta[i] * (1 - step * step) / width;
    }
    beta += n;
  }
}

VERNIER_IMPL void JointTerms::add(JointTermBlock::Kind kind, const detail::ChainTable& nominal,
                                  std::span<const double> parameters) {
  using Kind = JointTermBlock::Kind;
  switch (kind) {
    case Kind::gear_ratio: gear_ratio = true; break;
    case Kind::coupling: coupling = true; break;
    case Kind::gravity: gravity.emplace(nominal, detail::direction_of(parameters)); break;
    case Kind::hysteresis:
      for (const double width : parameters)
        demand(width > 0 && std::isfinite(width), "a width is ", width, ", must be positive");
      hysteresis.assign(parameters.begin(), parameters.end());
      break;
    case Kind::tilt: tilt.emplace(nominal, detail::direction_of(parameters)); break;
    case Kind::payload:
      demand(parameters.size() == 7 && parameters[3] >= 0, "a reference payload has a mass, which is not negative");
      payload.emplace(nominal, detail::direction_of(parameters.first(3)),
                      Payload{parameters[3], Vector3(parameters[4], parameters[5], parameters[6])});
      break;
    case Kind::bend:
      demand(parameters.size() == 7 && parameters[3] >= 0, "a reference payload has a mass, which is not negative");
      bend.emplace(nominal, detail::direction_of(parameters.first(3)),
                   Payload{parameters[3], Vector3(parameters[4], parameters[5], parameters[6])});
      break;
    case Kind::straightness: {
      std::vector<JointRange> ranges(static_cast<std::size_t>(joints));
      std::size_t at = 1;
      for (int j = 0; j < joints; ++j) {
        if (nominal.revolute(j)) continue;
        demand(at + 1 < parameters.size() && parameters[at] < parameters[at + 1], "a range is empty or missing");
        ranges[static_cast<std::size_t>(j)] = {parameters[at], parameters[at + 1]};
        at += 2;
      }
      demand(at == parameters.size(), "there are more ranges than prismatic joints");
      demand(parameters[0] >= 1 && parameters[0] <= 100, "the number of orders is ", parameters[0],
             ", must lie in 1..100");
      straightness.emplace(nominal, std::move(ranges), static_cast<int>(parameters[0]));
      break;
    }
    case Kind::transmission: demand(false, "JointTerms::add: transmissions are functions of single joints");
  }
}

VERNIER_IMPL std::vector<double> JointTerms::parameters(JointTermBlock::Kind kind) const {
  using Kind = JointTermBlock::Kind;
  const auto values = [](const Vector3& direction) { return std::vector<double>(direction.begin(), direction.end()); };
  if (kind == Kind::gravity && gravity) return values(gravity->down());
  if (kind == Kind::hysteresis) return hysteresis;
  if (kind == Kind::tilt && tilt) return values(tilt->down());
  const auto loaded = [&](const auto& of) {
    std::vector<double> out = values(of.down());
    out.push_back(of.reference().mass);
    out.insert(out.end(), of.reference().centre.begin(), of.reference().centre.end());
    return out;
  };
  if (kind == Kind::payload && payload) return loaded(*payload);
  if (kind == Kind::bend && bend) return loaded(*bend);
  if (kind == Kind::straightness && straightness) {
    std::vector<double> out{static_cast<double>(straightness->orders())};
    for (const int guide : straightness->guides()) {
      const JointRange& range = straightness->ranges()[static_cast<std::size_t>(guide)];
      out.insert(out.end(), {range.lower, range.upper});
    }
    return out;
  }
  return {};
}

VERNIER_IMPL void JointTerms::end_basis(const double* q, const PayloadLoad& load, MatrixRef out) const noexcept {
  if (tilt) tilt->basis(q, VERNIER_LATER(out).leftCols(tilt->size()));
  if (bend) bend->basis(q, load, VERNIER_LATER(out).middleCols(tilt ? tilt->size() : 0, bend->size()));
  if (straightness) straightness->basis(q, VERNIER_LATER(out).rightCols(straightness->size()));
}

VERNIER_IMPL Vector6 JointTerms::end_motion(const double* q, const PayloadLoad& load, const double* coefficients,
                                            double* rates) const noexcept {
  Vector6 out = Vector6::Zero();
  double some[6 * max_joints];  // of one kind
  double* slopes = rates != nullptr ? some : nullptr;
  if (rates != nullptr) std::fill_n(rates, 6 * joints, 0.0);
  const auto add = [&](const Vector6& motion) {
    out += motion;
    for (int k = 0; rates != nullptr && k < 6 * joints; ++k) rates[k] += some[k];
  };
  if (tilt) add(tilt->motion(q, coefficients, slopes));
  if (tilt) coefficients += tilt->size();
  if (bend) add(bend->motion(q, load, coefficients, slopes));
  if (bend) coefficients += bend->size();
  if (straightness) add(straightness->motion(q, coefficients, slopes));
  return out;
}

VERNIER_IMPL std::vector<JointTermBlock> JointTerms::blocks() const {
  using Kind = JointTermBlock::Kind;
  std::vector<JointTermBlock> out;
  const auto add = [&](Kind kind, int joint, Index count) {
    const Index begin = out.empty() ? 0 : out.back().begin + out.back().count;
    if (count > 0) out.push_back({kind, joint, begin, count});
  };
  add(Kind::gear_ratio, -1, gear_ratio ? joints : 0);
  add(Kind::coupling, -1, coupling ? joints - 1 : 0);
  add(Kind::gravity, -1, gravity ? gravity->size() : 0);
  add(Kind::payload, -1, payload ? joints : 0);
  add(Kind::hysteresis, -1, joints * static_cast<Index>(hysteresis.size()));
  add(Kind::tilt, -1, tilt ? tilt->size() : 0);
  add(Kind::bend, -1, bend ? bend->size() : 0);
  add(Kind::straightness, -1, straightness ? straightness->size() : 0);
  for (int i = 0; i < joints; ++i) add(Kind::transmission, i, transmission[static_cast<std::size_t>(i)].size());
  return out;
}

VERNIER_IMPL std::vector<std::string> JointTerms::names() const {
  std::vector<std::string> out;
  if (gear_ratio)
    for (int i = 1; i <= joints; ++i) out.push_back(message("gear", i));
  if (coupling)
    for (int i = 2; i <= joints; ++i) out.push_back(message("coupling", i));
  if (gravity)
    for (int i = 1; i <= joints; ++i)
      for (int j = i; j <= joints; ++j) out.push_back(message("sag", i, '_', j));
  for (int i = 1; payload && i <= joints; ++i) out.push_back(message("payload", i));
  for (std::size_t w = 1; w <= hysteresis.size(); ++w)
    for (int i = 1; i <= joints; ++i) out.push_back(message("hysteresis", i, '_', w));
  for (int i = 1; tilt && i <= joints; ++i)
    for (const char* which : {"xx", "xy", "xz", "yx", "yy", "yz"}) out.push_back(message("tilt", i, '_', which));
  for (int i = 1; bend && i <= joints; ++i)
    for (const char* about : {"x", "y"}) out.push_back(message("bend", i, '_', about));
  if (straightness)
    for (const int p : straightness->guides())
      for (const char* component : {"x", "y", "z", "rx", "ry", "rz"})
        for (int k = 1; k <= straightness->orders(); ++k) out.push_back(message("straight", p + 1, '_', component, k));
  for (int i = 1; i <= joints; ++i)
    for (const int order : transmission[static_cast<std::size_t>(i - 1)].orders)
      for (const char* function : {"cos", "sin"}) out.push_back(message(function, i, '_', order));
  return out;
}

}  // namespace vernier
