#pragma once

/// @file
/// What a real arm's joints add to their commanded values, as one sum that is linear in its coefficients.

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/error_terms/angle_basis.hpp"
#include "vernier/error_terms/gravity_compliance.hpp"

namespace vernier {

/// Which joint errors there are: `dq(q) = Phi(q) beta`, Phi one column a coefficient. Blocks, in the order of the
/// coefficients; each may be absent:
/// - gear ratio: `dq_i = rho_i q_i`
/// - coupling: `dq_i = kappa_i q_(i-1)`, i >= 2
/// - gravity compliance: see `GravityCompliance`
/// - transmission: `dq_i = sum_k beta_ik h_k(q_i)`, a basis for each joint, joint by joint
template <class Chain>
struct JointTerms {
  /// Number of joints.
  static constexpr int N = Chain::dof;
  /// Joint errors by unit coefficients.
  using Basis = Eigen::Matrix<double, N, Eigen::Dynamic>;

  bool gear_ratio = false;                            ///< present?
  bool coupling = false;                              ///< present?
  std::optional<GravityCompliance<Chain>> gravity{};  ///< present?
  std::array<AngleBasis, N> transmission{};           ///< of each joint; may have no functions

  /// No terms at all.
  JointTerms() { transmission.fill(Fourier{0}); }

  /// Coefficients before the transmission's.
  Index few() const {
    return (gear_ratio ? N : 0) + (coupling ? N - 1 : 0) + (gravity ? GravityCompliance<Chain>::size : 0);
  }
  /// First coefficient of a joint's transmission; that of joint N is the number of all.
  Index transmission_begin(int joint) const {
    Index begin = few();
    for (int i = 0; i < joint; ++i) begin += size_of(transmission[static_cast<std::size_t>(i)]);
    return begin;
  }
  /// Number of coefficients.
  Index size() const { return transmission_begin(N); }

  /// The columns of Phi before the transmission's.
  /// @param q   joint values [rad, m]
  /// @param out N x few()
  void few_basis(const JointVector<N>& q, Basis& out) const noexcept {
    out.setZero();
    Index at = 0;
    if (gear_ratio)
      for (int i = 0; i < N; ++i) out(i, at++) = q(i);
    if (coupling)
      for (int i = 1; i < N; ++i) out(i, at++) = q(i - 1);
    if (gravity) gravity->basis(q, out.middleCols(at, GravityCompliance<Chain>::size));
  }

  /// Names: `gear3`, `coupling3` (of joint 2 into 3), `sag2_5` (joint 2 under link 5), `cos3_12`, `sin3_12` (joint 3,
  /// harmonic 12), `node3_12`.
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    if (gear_ratio)
      for (int i = 1; i <= N; ++i) out.push_back(message("gear", i));
    if (coupling)
      for (int i = 2; i <= N; ++i) out.push_back(message("coupling", i));
    if (gravity)
      for (int i = 1; i <= N; ++i)
        for (int j = i; j <= N; ++j) out.push_back(message("sag", i, '_', j));
    for (int i = 1; i <= N; ++i) {
      const AngleBasis& basis = transmission[static_cast<std::size_t>(i - 1)];
      const bool fourier = std::holds_alternative<Fourier>(basis);
      for (Index k = 0; k < size_of(basis); ++k)
        out.push_back(fourier ? message(k % 2 == 0 ? "cos" : "sin", i, '_', k / 2 + 1)
                              : message("node", i, '_', k + 1));
    }
    return out;
  }
};

/// Joint errors with their coefficients: the map from commanded to effective joints.
template <class Chain>
class JointErrors {
 public:
  /// Number of joints.
  static constexpr int N = Chain::dof;

  /// None.
  JointErrors() = default;
  /// @throws std::invalid_argument when the number of coefficients is not that of the terms, or one is not finite, or a
  ///         basis is malformed
  JointErrors(JointTerms<Chain> terms, VectorX coefficients)
      : terms_(std::move(terms)), coefficients_(std::move(coefficients)) {
    for (int i = 0; i < N; ++i) {
      const AngleBasis& basis = terms_.transmission[static_cast<std::size_t>(i)];
      if (const auto* nodes = std::get_if<JointNodes>(&basis)) {
        require(nodes->centre.size() == nodes->slope.size(), "JointErrors: joint ", i + 1, " has ",
                nodes->centre.size(), " centres of nodes, but ", nodes->slope.size(), " slopes");
        require(nodes->centre.allFinite() && nodes->slope.allFinite(), "JointErrors: a node of joint ", i + 1,
                " is not finite");
      } else {
        const int harmonics = std::get<Fourier>(basis).harmonics;
        require(harmonics >= 0, "JointErrors: joint ", i + 1, " has ", harmonics, " harmonics");
      }
    }
    require(coefficients_.size() == terms_.size(), "JointErrors: ", coefficients_.size(), " coefficients for ",
            terms_.size(), " terms");
    require(coefficients_.allFinite(), "JointErrors: a coefficient is not finite");
  }

  /// Which errors there are.
  const JointTerms<Chain>& terms() const { return terms_; }
  /// Their sizes: rad, or m at prismatic joints; gravity's rad/m.
  const VectorX& coefficients() const { return coefficients_; }
  /// Whether there is none.
  bool empty() const { return coefficients_.size() == 0; }

  /// Effective joints and their derivative with respect to the commanded ones.
  struct Effective {
    JointVector<N> joints;                   ///< q + dq(q)
    Eigen::Matrix<double, N, N> derivative;  ///< I + d dq/dq
  };

  /// Effective joints; no allocation.
  [[gnu::noinline]] Effective effective(const JointVector<N>& q) const noexcept {
    Effective out{q, Eigen::Matrix<double, N, N>::Identity()};
    if (empty()) return out;
    const double* beta = coefficients_.data();
    if (terms_.gear_ratio) {
      for (int i = 0; i < N; ++i) {
        out.joints(i) += beta[i] * q(i);
        out.derivative(i, i) += beta[i];
      }
      beta += N;
    }
    if (terms_.coupling) {
      for (int i = 1; i < N; ++i) {
        out.joints(i) += beta[i - 1] * q(i - 1);
        out.derivative(i, i - 1) += beta[i - 1];
      }
      beta += N - 1;
    }
    if (terms_.gravity) {
      terms_.gravity->add(q, beta, out.joints, out.derivative);
      beta += GravityCompliance<Chain>::size;
    }
    for (int i = 0; i < N; ++i) {
      const AngleBasis& basis = terms_.transmission[static_cast<std::size_t>(i)];
      const AngleFunction f = combine(basis, beta, q(i));
      out.joints(i) += f.value;
      out.derivative(i, i) += f.slope;
      beta += size_of(basis);
    }
    return out;
  }

  /// What the transmission of joint i (from 0) adds at an angle [rad].
  double transmission(int i, double q) const noexcept {
    if (empty()) return 0;
    return combine(terms_.transmission[static_cast<std::size_t>(i)],
                   coefficients_.data() + terms_.transmission_begin(i), q)
        .value;
  }

 private:
  JointTerms<Chain> terms_{};
  VectorX coefficients_{};
};

/// A chain whose joints are not where they were told to be: `pose(q) = chain.pose(q + dq(q))`.
template <class C>
class WithJointErrors {
 public:
  /// Number of joints.
  static constexpr int dof = C::dof;
  /// The chain inside.
  using Chain = C;

  /// A chain alone, or with joint errors.
  WithJointErrors(const Chain& chain, JointErrors<Chain> errors = {})  // NOLINT(google-explicit-constructor)
      : chain_(chain), errors_(std::move(errors)) {}

  /// The chain.
  const Chain& chain() const { return chain_; }
  /// What the joints add.
  const JointErrors<Chain>& joint_errors() const { return errors_; }

  /// base_T_tool.
  [[gnu::noinline]] Isometry3 pose(const JointVector<dof>& q) const noexcept {
    return chain_.pose(errors_.effective(q).joints);
  }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return chain_.position(errors_.effective(q).joints); }
  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n joint combinations.
  PointRows positions(const JointRows<dof>& joints, const Vector3& point = Vector3::Zero()) const {
    return chain_.positions(effective(joints), point);
  }
  /// base_T_tool at n joint combinations.
  std::vector<Isometry3> poses(const JointRows<dof>& joints) const { return chain_.poses(effective(joints)); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  [[gnu::noinline]] PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    const auto effective = errors_.effective(q);
    PoseAndJacobian<dof> out = chain_.pose_and_jacobian(effective.joints);
    out.jacobian = (out.jacobian * effective.derivative).eval();
    return out;
  }

 private:
  JointRows<dof> effective(const JointRows<dof>& joints) const {
    JointRows<dof> out(joints.rows(), dof);
    for (Index i = 0; i < joints.rows(); ++i)
      out.row(i) = errors_.effective(joints.row(i).transpose()).joints.transpose();
    return out;
  }

  Chain chain_;
  JointErrors<Chain> errors_;
};

}  // namespace vernier
