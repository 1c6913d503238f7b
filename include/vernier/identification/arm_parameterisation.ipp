// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/arm_parameterisation.hpp"
#include "vernier/identification/detail/twists.hpp"

namespace vernier {

VERNIER_IMPL ArmParameterisation::ArmParameterisation(std::vector<ArmGeometry> arms,
                                                      std::vector<GeometricUnknown> unknowns)
    : arms_(std::move(arms)), unknowns_(std::move(unknowns)) {
  demand(!arms_.empty(), "ArmParameterisation: no stations");
  for (const auto& arm : arms_) start_.push_back(arm.parameters());
  errors_ = JointErrors(JointTerms(arms_.front().joints()), VectorX());
}

VERNIER_IMPL void ArmParameterisation::set_terms(JointTerms terms, VectorX scales, VectorX precisions) {
  VectorX coefficients = VectorX::Zero(terms.size());
  detail::visit_common_terms(errors_.terms(), terms,
                             [&](Index before, Index now) { coefficients(now) = errors_.coefficients()(before); });
  errors_ = JointErrors(std::move(terms), std::move(coefficients));
  coefficient_scales_ = std::move(scales);
  coefficient_precisions_ = std::move(precisions);
}

VERNIER_IMPL void ArmParameterisation::set_precisions(const VectorX& precisions) {
  demand(precisions.size() == size(), "ArmParameterisation: ", precisions.size(), " precisions of ", size(),
         " unknowns");
  for (std::size_t k = 0; k < unknowns_.size(); ++k) unknowns_[k].precision = precisions(static_cast<Index>(k));
  coefficient_precisions_ = VERNIER_LATER(precisions).tail(terms().size());
}

VERNIER_IMPL VectorX ArmParameterisation::thermal_rates(int station) const {
  VectorX out;
  for (std::size_t k = 0; k < thermal_rates_.size(); ++k) {
    if (!unknowns_[k].thermal || !unknowns_[k].acts_on(station)) continue;
    if (out.size() == 0) out.setZero(geometry(station).num_parameters());
    out(unknowns_[k].parameter) = thermal_rates_[k];
  }
  return out;
}

VERNIER_IMPL std::vector<Index> ArmParameterisation::group_sizes() const {
  std::vector<Index> out;
  for (const Fourier& fourier : terms().transmission) out.push_back(fourier.size());
  return out;
}

template <class F>
VectorX ArmParameterisation::joined(const F& of_unknown, const VectorX& of_coefficients) const {
  VectorX out(size());
  for (std::size_t k = 0; k < unknowns_.size(); ++k) out(static_cast<Index>(k)) = of_unknown(unknowns_[k]);
  for (Index k = 0; k < of_coefficients.size(); ++k) out(static_cast<Index>(unknowns_.size()) + k) = of_coefficients(k);
  return out;
}

VERNIER_IMPL VectorX ArmParameterisation::scales() const {
  return joined([](const GeometricUnknown& u) { return u.scale; }, coefficient_scales_);
}

VERNIER_IMPL VectorX ArmParameterisation::precisions() const {
  return joined([](const GeometricUnknown& u) { return u.precision; }, coefficient_precisions_);
}

VERNIER_IMPL VectorX ArmParameterisation::steps() const {
  std::vector<VectorX> now;
  for (const ArmGeometry& arm : arms_) now.push_back(arm.parameters());
  Index k = 0;
  return joined(
      [&](const GeometricUnknown& u) {
        const auto unknown = static_cast<std::size_t>(k++);
        if (u.thermal) return thermal_rates_.empty() ? 0.0 : thermal_rates_[unknown] / u.scale;
        const auto s = static_cast<std::size_t>((std::max)(0, u.station));
        return (now[s](u.parameter) - start_[s](u.parameter)) / u.scale;
      },
      errors_.empty() ? VectorX() : VectorX(errors_.coefficients().cwiseQuotient(coefficient_scales_)));
}

VERNIER_IMPL void ArmParameterisation::move(const VectorX& steps) {
  thermal_rates_.resize(unknowns_.size(), 0);
  for (std::size_t k = 0; k < unknowns_.size(); ++k)
    if (unknowns_[k].thermal) thermal_rates_[k] += unknowns_[k].scale * steps(static_cast<Index>(k));
  for (int s = 0; s < stations(); ++s) {
    ArmGeometry& arm = arms_[static_cast<std::size_t>(s)];
    VectorX p = arm.parameters();
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      if (!unknowns_[k].thermal && unknowns_[k].acts_on(s))
        p(unknowns_[k].parameter) += unknowns_[k].scale * steps(static_cast<Index>(k));
    arm = arm.with_parameters(p);
  }
  if (errors_.empty()) return;
  VectorX coefficients = errors_.coefficients();
  const Index first = steps.size() - coefficients.size();
  for (Index k = 0; k < coefficients.size(); ++k) coefficients(k) += coefficient_scales_(k) * steps(first + k);
  errors_ = JointErrors(terms(), std::move(coefficients));
}

VERNIER_IMPL std::vector<std::string> ArmParameterisation::names() const {
  const auto of_arm = geometry(0).parameter_names();
  std::vector<std::string> out;
  for (const auto& u : unknowns_)
    out.push_back(of_arm[static_cast<std::size_t>(u.parameter)] +
                  (u.station > 0 ? message('@', u.station + 1) : std::string()) + (u.thermal ? "/K" : ""));
  for (auto& name : terms().names()) out.push_back(std::move(name));
  return out;
}

VERNIER_IMPL std::vector<Isometry3> ArmParameterisation::poses(int station, const ConstMatrixRef& joints,
                                                               const ConstMatrixRef& previous) const {
  const ArmGeometry& arm = geometry(station);
  std::vector<Isometry3> out = arm.poses(errors_.empty() ? MatrixX(joints) : errors_.effective_rows(joints, previous));
  const Isometry3 &base = arm.base().isometry(), out_of_base = inverse_of(base);
  for (std::size_t i = 0; errors_.tilts() && i < out.size(); ++i) {
    const VectorX q = detail::row_of(joints, static_cast<Index>(i));
    Isometry3 motion = Isometry3::Identity();
    errors_.tilt(q.data(), motion);
    out[i] = composed(composed(base, motion), composed(out_of_base, out[i]));
  }
  return out;
}

namespace detail {

/// Moves a pose and its columns by tilts of joint frames and by guides, and writes the columns of their coefficients.
/// @param of_base whether each of the first columns turns the arm about its base, and not about a point of the arm
VERNIER_LOCAL void tilt_columns(const JointErrors& errors, const VectorX& q, const Isometry3& base,
                                const std::vector<bool>& of_base, Index first, const ConstVectorRef& scales,
                                const PayloadLoad& load, Isometry3& pose, RowBlock& rows) {
  const JointTerms& terms = errors.terms();
  const Index begin = terms.end_begin();
  const Vector6 at = terms.end_motion(q.data(), load, errors.coefficients().data() + begin);
  const Vector3 shift = VERNIER_LATER(at).template head<3>(), turn = VERNIER_LATER(at).template tail<3>(),
                before = translation(pose);
  const Matrix3 to_base = rotation(base), tilted = exp_so3(turn);
  const Isometry3 in_base = rigid_motion(tilted, shift), out_of_base = inverse_of(base);
  const Isometry3 motion = composed(composed(base, in_base), out_of_base);
  const Matrix3 turning = rotation(motion), rate = to_base * left_jacobian_so3(turn);
  const Vector3 local = tilted * transformed(out_of_base, before), turned = to_base * local;  // about the base's origin
  pose = composed(motion, pose);
  const Vector3 moved = translation(pose) - before;
  for (Rows6* columns : {&rows.dense, &rows.factor})
    for (Index k = 0; k < columns->cols(); ++k) {
      double* column = columns->data() + 6 * k;
      Vector3 linear(column[0], column[1], column[2]), angular(column[3], column[4], column[5]);
      if (columns == &rows.dense && k < static_cast<Index>(of_base.size()) && of_base[static_cast<std::size_t>(k)]) {
        linear += angular.cross(moved);
      } else {
        linear = turning * linear;
        angular = turning * angular;
      }
      std::copy_n(linear.data(), 3, column);
      std::copy_n(angular.data(), 3, column + 3);
    }
  MatrixX basis(6, terms.num_end_terms());
  terms.end_basis(q.data(), load, basis);
  for (Index k = 0; k < basis.cols(); ++k) {
    const Vector3 translates = to_base * Vector3(basis(0, k), basis(1, k), basis(2, k));
    const Vector3 omega = rate * Vector3(basis(3, k), basis(4, k), basis(5, k));
    const Vector3 linear = omega.cross(turned) + translates;
    for (Index r = 0; r < 3; ++r) {
      rows.dense(r, first + k) = scales(begin + k) * linear(r);
      rows.dense(r + 3, first + k) = scales(begin + k) * omega(r);
    }
  }
}

}  // namespace detail

VERNIER_IMPL std::vector<Isometry3> ArmParameterisation::linearise(int station, const ConstMatrixRef& joints,
                                                                   const ConstMatrixRef& previous, RowBlock* out,
                                                                   bool joint_columns, const ConstVectorRef& warmer,
                                                                   const ConstMatrixRef& payloads) const {
  const ArmGeometry& arm = geometry(station);
  const int n = arm.joints();
  const Index few = terms().num_dense_terms(), of_geometry = static_cast<Index>(unknowns_.size());
  std::vector<PayloadLoad> loads;
  for (Index i = 0; i < payloads.rows() && terms().payload; ++i)
    loads.push_back(terms().payload->load(Payload::of(payloads, i).at(translation(arm.tool().isometry()))));
  PosesAndJacobians at;
  if (errors_.empty())
    arm.poses_and_parameter_jacobians(joints, at);
  else
    arm.poses_and_parameter_jacobians(errors_.effective_rows(joints, previous, loads), at);
  const Index count = joints.rows();
  const bool factored = joint_columns || !errors_.empty() || terms().size() > 0;
  VectorX q(n), before(n);
  MatrixX basis(n, few);
  std::vector<bool> of_base;
  for (const GeometricUnknown& u : unknowns_) of_base.push_back(u.parameter < 6);
  for (Index i = 0; i < count; ++i) {
    RowBlock& rows = out[i];
    // entry r of column k of configuration i
    const auto copy = [&](Index k, double scale, double* column) {
      const double* entry = at.jacobians.data() + 6 * k * count + i;
      for (int r = 0; r < 6; ++r) column[r] = entry[r * count] * scale;
    };
    rows.factor.resize(6, factored ? n : 0);
    for (int j = 0; factored && j < n; ++j)  // a joint adds to a parameter of its row
      copy(arm.joint_parameter(j), 1, rows.factor.data() + 6 * j);
    rows.dense.resize(6, num_dense());
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      double* column = rows.dense.data() + 6 * k;
      const double share = unknowns_[k].thermal ? warmer.size() > 0 ? warmer(i) : 0 : 1;
      if (unknowns_[k].acts_on(station))
        copy(unknowns_[k].parameter, share * unknowns_[k].scale, column);
      else
        std::fill_n(column, 6, 0.0);
    }
    if (warmer.size() > 0 && !thermal_rates_.empty()) {  // tiny, so it adds up
      Vector6 shift = Vector6::Zero();
      for (std::size_t k = 0; k < unknowns_.size(); ++k)
        for (Index r = 0; unknowns_[k].thermal && r < 6; ++r)
          shift(r) += thermal_rates_[k] / unknowns_[k].scale * rows.dense(r, static_cast<Index>(k));
      Isometry3& pose = at.poses[static_cast<std::size_t>(i)];
      pose = detail::shifted(pose, shift);
    }
    rows.local = {};
    rows.functions.resize(0);
    if (!factored) continue;
    for (int j = 0; j < n; ++j) {
      q(j) = joints(i, j);
      if (previous.rows() > 0) before(j) = previous(i, j);
    }
    if (few > 0) {
      terms().dense_basis(q.data(), previous.rows() > 0 ? before.data() : nullptr, basis,
                          loads.empty() ? PayloadLoad{} : loads[static_cast<std::size_t>(i)]);
      for (Index k = 0; k < few; ++k) {
        Vector6 sum = Vector6::Zero();
        for (Index j = 0; j < n; ++j)
          for (Index r = 0; r < 6; ++r) sum(r) += rows.factor(r, j) * basis(j, k);
        for (Index r = 0; r < 6; ++r) rows.dense(r, of_geometry + k) = coefficient_scales_(k) * sum(r);
      }
    }
    if (!terms().motors.none()) terms().motors.to_motors(rows.factor.data(), 6);
    transmission_values(q.data(), rows.functions);
    if (errors_.tilts())
      detail::tilt_columns(errors_, q, arm.base().isometry(), of_base, of_geometry + terms().end_begin(),
                           coefficient_scales_, loads.empty() ? PayloadLoad{} : loads[static_cast<std::size_t>(i)],
                           at.poses[static_cast<std::size_t>(i)], rows);
  }
  return std::move(at.poses);
}

VERNIER_IMPL void ArmParameterisation::transmission_values(const double* q, VectorX& out) const {
  if (terms().motors.none()) {
    function_values(q, out);
    return;
  }
  double angles[max_joints];
  terms().motors.angles(q, angles);
  function_values(angles, out);
}

VERNIER_IMPL void ArmParameterisation::function_values(const double* q, VectorX& out) const {
  out.resize(terms().size() - terms().num_dense_terms());
  if (out.size() == 0) return;
  Index at = 0;
  for (std::size_t j = 0; j < terms().transmission.size(); ++j) {
    const Fourier& fourier = terms().transmission[j];
    fourier.values(q[j], out.data() + at);
    at += fourier.size();
  }
  for (Index k = 0; k < out.size(); ++k) out(k) *= coefficient_scales_(coefficient_scales_.size() - out.size() + k);
}

}  // namespace vernier
