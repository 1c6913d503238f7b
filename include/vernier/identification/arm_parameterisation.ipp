#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/arm_parameterisation.hpp"

namespace vernier {

VERNIER_IMPL ArmParameterisation::ArmParameterisation(std::vector<ArmGeometry> arms,
                                                      std::vector<GeometricUnknown> unknowns)
    : arms_(std::move(arms)), unknowns_(std::move(unknowns)) {
  require(!arms_.empty(), "ArmParameterisation: no stations");
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
  require(precisions.size() == size(), "ArmParameterisation: ", precisions.size(), " precisions of ", size(),
          " unknowns");
  for (std::size_t k = 0; k < unknowns_.size(); ++k) unknowns_[k].precision = precisions(static_cast<Index>(k));
  coefficient_precisions_ = precisions.tail(terms().size());
}

VERNIER_IMPL VectorX ArmParameterisation::thermal_rates(int station) const {
  VectorX out;
  for (std::size_t k = 0; k < thermal_rates_.size(); ++k) {
    if (!unknowns_[k].thermal || (unknowns_[k].station >= 0 && unknowns_[k].station != station)) continue;
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
        const auto s = static_cast<std::size_t>(std::max(0, u.station));
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
      if (!unknowns_[k].thermal && (unknowns_[k].station < 0 || unknowns_[k].station == s))
        p(unknowns_[k].parameter) += unknowns_[k].scale * steps(static_cast<Index>(k));
    arm = arm.with_parameters(p);
  }
  if (!errors_.empty())
    errors_ =
        JointErrors(terms(), errors_.coefficients() + coefficient_scales_.cwiseProduct(steps.tail(terms().size())));
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
  for (std::size_t i = 0; errors_.tilts() && i < out.size(); ++i) {
    const VectorX q = joints.row(static_cast<Index>(i)).transpose();
    Isometry3 motion = Isometry3::Identity();
    errors_.tilt(q.data(), motion);
    out[i] = arm.base().isometry() * motion * arm.base().isometry().inverse() * out[i];
  }
  return out;
}

namespace detail {

/// Moves a pose and its columns by the tilts of joint frames, and writes the columns of their coefficients.
/// @param of_base whether each of the first columns turns the arm about its base, and not about a point of the arm
VERNIER_API void tilt_columns(const JointErrors& errors, const VectorX& q, const Isometry3& base,
                              const std::vector<bool>& of_base, Index first, const ConstVectorRef& scales,
                              Isometry3& pose, RowBlock& rows) {
  const GravityTilt& tilt = *errors.terms().tilt;
  const Index begin = errors.terms().tilt_begin();
  const Vector6 at = tilt.motion(q.data(), errors.coefficients().data() + begin);
  const Vector3 turn = at.tail<3>(), before = pose.translation();
  Isometry3 motion = Isometry3::Identity();
  motion.linear() = exp_so3(turn);
  const Vector3 turned = base.linear() * motion.linear() * (base.inverse() * before);  // about the base's origin
  motion.translation() = at.head<3>();
  motion = base * motion * base.inverse();
  pose = motion * pose;
  for (Rows6* columns : {&rows.dense, &rows.factor})
    for (Index k = 0; k < columns->cols(); ++k) {
      auto linear = columns->col(k).head<3>(), angular = columns->col(k).tail<3>();
      if (columns == &rows.dense && k < static_cast<Index>(of_base.size()) && of_base[static_cast<std::size_t>(k)]) {
        linear += Vector3(angular).cross(pose.translation() - before);
        continue;
      }
      linear = (motion.linear() * linear).eval();
      angular = (motion.linear() * angular).eval();
    }
  MatrixX basis(6, tilt.size());
  tilt.basis(q.data(), basis);
  const Matrix3 rate = base.linear() * left_jacobian_so3(turn);
  for (Index k = 0; k < tilt.size(); ++k) {
    const Vector3 omega = rate * basis.col(k).tail<3>();
    rows.dense.col(first + k) << omega.cross(turned) + base.linear() * basis.col(k).head<3>(), omega;
    rows.dense.col(first + k) *= scales(begin + k);
  }
}

}  // namespace detail

VERNIER_IMPL std::vector<Isometry3> ArmParameterisation::linearise(int station, const ConstMatrixRef& joints,
                                                                   const ConstMatrixRef& previous, RowBlock* out,
                                                                   bool joint_columns,
                                                                   const ConstVectorRef& warmer) const {
  const ArmGeometry& arm = geometry(station);
  const int n = arm.joints();
  const Index few = terms().num_dense_terms(), of_geometry = static_cast<Index>(unknowns_.size());
  PosesAndJacobians at;
  if (errors_.empty())
    arm.poses_and_parameter_jacobians(joints, at);
  else
    arm.poses_and_parameter_jacobians(errors_.effective_rows(joints, previous), at);
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
      copy(6 + 5 * j + static_cast<int>(arm.chain().revolute(j) ? DhParameter::theta : DhParameter::d), 1,
           rows.factor.col(j).data());
    rows.dense.resize(6, num_dense());
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      double* column = rows.dense.col(static_cast<Index>(k)).data();
      const double share = unknowns_[k].thermal ? warmer.size() > 0 ? warmer(i) : 0 : 1;
      if (unknowns_[k].station < 0 || unknowns_[k].station == station)
        copy(unknowns_[k].parameter, share * unknowns_[k].scale, column);
      else
        std::fill_n(column, 6, 0.0);
    }
    if (warmer.size() > 0 && !thermal_rates_.empty()) {  // tiny, so it adds up
      Vector6 shift = Vector6::Zero();
      for (std::size_t k = 0; k < unknowns_.size(); ++k)
        if (unknowns_[k].thermal)
          shift += thermal_rates_[k] / unknowns_[k].scale * rows.dense.col(static_cast<Index>(k));
      at.poses[static_cast<std::size_t>(i)].translation() += shift.head<3>();
      at.poses[static_cast<std::size_t>(i)].linear() =
          exp_so3(Vector3(shift.tail<3>())) * at.poses[static_cast<std::size_t>(i)].linear();
    }
    rows.local = {};
    rows.functions.resize(0);
    if (!factored) continue;
    q = joints.row(i).transpose();
    if (few > 0) {
      if (previous.rows() > 0) before = previous.row(i).transpose();
      terms().dense_basis(q.data(), previous.rows() > 0 ? before.data() : nullptr, basis);
      for (Index k = 0; k < few; ++k)
        rows.dense.col(of_geometry + k) = rows.factor.lazyProduct(basis.col(k) * coefficient_scales_(k));
    }
    transmission_values(q.data(), rows.functions);
    if (errors_.tilts())
      detail::tilt_columns(errors_, q, arm.base().isometry(), of_base, of_geometry + terms().tilt_begin(),
                           coefficient_scales_, at.poses[static_cast<std::size_t>(i)], rows);
  }
  return std::move(at.poses);
}

VERNIER_IMPL void ArmParameterisation::transmission_values(const double* q, VectorX& out) const {
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
