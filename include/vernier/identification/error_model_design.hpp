#pragma once

/// @file
/// The unknowns of an error model, where they stand, and what a step in each does to a pose.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/identification/pose_system.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier::detail {

/// A geometric parameter that may move: of the chain, or of a frame.
struct GeometricUnknown {
  Index parameter;       ///< as `Framed<Chain>` counts them
  int station = -1;      ///< whose frame it belongs to; -1: shared by all stations
  double size = 1;       ///< unit in which it is solved for: the expected size of its error [m, rad]
  double precision = 0;  ///< of a prior around its start, in that unit: an inverse variance; 0 for none
};

/// Geometric unknowns and joint errors of one arm seen from one or more stations. Steps are in units of sizes:
/// geometry first, then the coefficients of the joint errors in their own order.
template <class Chain>
class ErrorModelDesign {
 public:
  static constexpr int N = Chain::dof;

  /// @param arms     where to start, one a station, all with the same chain
  /// @param unknowns geometric parameters that may move
  ErrorModelDesign(std::vector<Framed<Chain>> arms, std::vector<GeometricUnknown> unknowns)
      : arms_(std::move(arms)), unknowns_(std::move(unknowns)) {
    for (const auto& arm : arms_) start_.push_back(arm.parameters());
    set_terms({}, VectorX(), VectorX());
  }

  /// Puts joint errors in. Coefficients that were there before stay where the new terms only follow the few ones, or
  /// only go before all others; others are zero.
  /// @param sizes      units of the coefficients
  /// @param precisions of their zero-mean priors, in those units
  void set_terms(JointTerms<Chain> terms, VectorX sizes, VectorX precisions) {
    VectorX coefficients = VectorX::Zero(terms.size());
    const Index few = errors_.terms().few(), all = errors_.terms().size();
    if (!errors_.empty() && few == terms.few())
      coefficients.head(few) = errors_.coefficients().head(few);
    else if (!errors_.empty() && all - few == terms.size() - terms.few())
      coefficients.tail(all) = errors_.coefficients();
    errors_ = JointErrors<Chain>(std::move(terms), std::move(coefficients));
    coefficient_sizes_ = std::move(sizes);
    coefficient_precisions_ = std::move(precisions);
  }

  const JointTerms<Chain>& terms() const { return errors_.terms(); }
  const std::vector<GeometricUnknown>& geometric() const { return unknowns_; }
  Index dense() const { return static_cast<Index>(unknowns_.size()) + terms().few(); }  ///< before the transmissions
  Index size() const { return static_cast<Index>(unknowns_.size()) + terms().size(); }  ///< all unknowns
  int stations() const { return static_cast<int>(arms_.size()); }
  /// Chain and frames of a station, without joint errors.
  const Framed<Chain>& geometry(int station) const { return arms_[static_cast<std::size_t>(station)]; }
  /// The arm of a station, joint errors included.
  Framed<WithJointErrors<Chain>> arm(int station) const {
    return geometry(station).around(WithJointErrors<Chain>(geometry(station).model(), errors_));
  }

  /// Units of the steps.
  VectorX sizes() const {
    return joined([](const auto& u) { return u.size; }, coefficient_sizes_);
  }
  /// Precisions of the priors, around the start for geometry, around zero for coefficients.
  VectorX precisions() const {
    return joined([](const auto& u) { return u.precision; }, coefficient_precisions_);
  }
  /// Other precisions of the coefficients' priors.
  void set_precisions(VectorX of_coefficients) { coefficient_precisions_ = std::move(of_coefficients); }
  /// Present values, from where the priors pull to.
  VectorX steps() const {
    return joined(
        [&](const auto& u) {
          const auto s = static_cast<std::size_t>(std::max(0, u.station));
          return (arms_[s].parameters()(u.parameter) - start_[s](u.parameter)) / u.size;
        },
        errors_.empty() ? VectorX() : VectorX(errors_.coefficients().cwiseQuotient(coefficient_sizes_)));
  }

  /// Moves everything.
  void move(const VectorX& by) {
    for (int s = 0; s < stations(); ++s) {
      auto& arm = arms_[static_cast<std::size_t>(s)];
      auto p = arm.parameters();
      for (std::size_t k = 0; k < unknowns_.size(); ++k)
        if (concerns(unknowns_[k], s)) p(unknowns_[k].parameter) += unknowns_[k].size * by(static_cast<Index>(k));
      arm = arm.with_parameters(p);
    }
    if (!errors_.empty())
      errors_ = JointErrors<Chain>(terms(),
                                   errors_.coefficients() + coefficient_sizes_.cwiseProduct(by.tail(terms().size())));
  }

  /// Number of transmission terms of each joint.
  std::vector<Index> functions_of() const {
    std::vector<Index> out;
    for (const AngleBasis& basis : terms().transmission) out.push_back(size_of(basis));
    return out;
  }

  /// The pose at q, and what unit steps do to it; not whitened.
  [[gnu::noinline]] Isometry3 effect(int station, const JointVector<N>& q, PoseRows& out) const {
    const auto& framed = geometry(station);
    const JointVector<N> joints = errors_.effective(q).joints;
    const auto at = framed.pose_and_parameter_jacobian(joints);
    const auto& parameters = at.jacobian;
    const Index few = terms().few();
    out.joint.resize(6, N);
    for (int j = 0; j < N; ++j) {  // a joint adds to a parameter of its row
      const bool revolute = framed.model().row(j).joint == JointType::revolute;
      out.joint.col(j) = parameters.col(6 + 5 * j + static_cast<int>(revolute ? DhParameter::theta : DhParameter::d));
    }
    out.dense.setZero(6, dense());
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      if (concerns(unknowns_[k], station))
        out.dense.col(static_cast<Index>(k)) = parameters.col(unknowns_[k].parameter) * unknowns_[k].size;
    if (few > 0) {
      typename JointTerms<Chain>::Basis basis(N, few);
      terms().few_basis(q, basis);
      out.dense.rightCols(few).noalias() = out.joint * (MatrixX(basis) * coefficient_sizes_.head(few).asDiagonal());
    }
    functions(q, out.functions);
    return at.pose;
  }

  /// The rows of one pose over all unknowns, 6 x size.
  Rows6 rows(int station, const JointVector<N>& q, PoseRows& scratch) const {
    effect(station, q, scratch);
    Rows6 out(6, size());
    scratch.expand(functions_of(), out);
    return out;
  }

  /// Functions of all transmissions at q, in units of sizes.
  void functions(const JointVector<N>& q, VectorX& out) const {
    out.resize(terms().size() - terms().few());
    Index at = 0;
    for (int j = 0; j < N; ++j) {
      const AngleBasis& basis = terms().transmission[static_cast<std::size_t>(j)];
      std::visit([&](const auto& b) { b.visit(q(j), [&](Index k, double value, double) { out(at + k) = value; }); },
                 basis);
      at += size_of(basis);
    }
    out.array() *= coefficient_sizes_.tail(out.size()).array();
  }

  /// Names of all unknowns; those of a frame of station s > 0 end in `@s+1`.
  std::vector<std::string> names() const {
    const auto of_arm = Framed<Chain>::parameter_names();
    std::vector<std::string> out;
    for (const auto& u : unknowns_)
      out.push_back(of_arm[static_cast<std::size_t>(u.parameter)] +
                    (u.station > 0 ? message('@', u.station + 1) : std::string()));
    for (auto& name : terms().names()) out.push_back(std::move(name));
    return out;
  }

 private:
  static bool concerns(const GeometricUnknown& u, int station) { return u.station < 0 || u.station == station; }

  template <class F>
  VectorX joined(F&& of_unknown, const VectorX& of_coefficients) const {
    VectorX out(size());
    for (std::size_t k = 0; k < unknowns_.size(); ++k) out(static_cast<Index>(k)) = of_unknown(unknowns_[k]);
    out.tail(of_coefficients.size()) = of_coefficients;
    return out;
  }

  std::vector<Framed<Chain>> arms_;
  std::vector<typename Framed<Chain>::Parameters> start_;
  std::vector<GeometricUnknown> unknowns_;
  JointErrors<Chain> errors_;
  VectorX coefficient_sizes_, coefficient_precisions_;
};

}  // namespace vernier::detail
