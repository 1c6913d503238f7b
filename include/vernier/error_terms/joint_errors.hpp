// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Errors of the joints of a real arm: one sum, linear in its coefficients.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_terms/detail/harmonic_table.hpp"
#include "vernier/error_terms/fourier.hpp"
#include "vernier/error_terms/gravity_compliance.hpp"
#include "vernier/error_terms/gravity_tilt.hpp"
#include "vernier/error_terms/payload_compliance.hpp"
#include "vernier/error_terms/straightness.hpp"

namespace vernier {

/// Coefficients of joint errors that belong together.
struct JointTermBlock {
  /// What they are coefficients of.
  enum class Kind { gear_ratio, coupling, gravity, payload, hysteresis, tilt, straightness, transmission };
  Kind kind;    ///< see `JointTerms`
  int joint;    ///< of a transmission, from 0; else -1
  Index begin;  ///< first coefficient
  Index count;  ///< number of coefficients
};

/// What is known of a kind of joint errors, beside its formula. Model files and C source follow this table.
struct JointTermTraits {
  /// Some parameters of a block: their key in model files, and their number; 0: all that follow.
  struct Parameter {
    const char* key = nullptr;  ///< in model files; null: there is none
    int count = 0;              ///< number of values; 0: all that follow
  };
  JointTermBlock::Kind kind;              ///< itself
  const char* key;                        ///< of the block in model files; also its name in C
  bool links = false;                     ///< whether its C text walks along the nominal chain
  std::array<Parameter, 3> parameters{};  ///< of the block, in the order of `JointTerms::parameters`
  const char* coefficients = nullptr;     ///< key of its coefficients beside parameters

  /// Whether the block has parameters.
  constexpr bool has_parameters() const { return parameters[0].key != nullptr; }
};

/// All kinds, by their number, in the order of the coefficients.
inline constexpr std::array<JointTermTraits, 8> joint_term_rows{{
    {JointTermBlock::Kind::gear_ratio, "gear_ratio"},
    {JointTermBlock::Kind::coupling, "coupling"},
    {JointTermBlock::Kind::gravity, "gravity", true, {{{"down", 3}}}, "products_rad_per_m"},
    {JointTermBlock::Kind::payload,
     "payload",
     true,
     {{{"down", 3}, {"reference_kg", 1}, {"reference_centre_m", 3}}},
     "compliances_rad_per_nm"},
    {JointTermBlock::Kind::hysteresis, "hysteresis", false, {{{"widths_rad", 0}}}, "coefficients_rad"},
    {JointTermBlock::Kind::tilt, "tilt", true, {{{"down", 3}}}, "coefficients_rad"},
    {JointTermBlock::Kind::straightness, "straightness", true, {{{"orders", 1}, {"ranges_m", 0}}}, "coefficients"},
    {JointTermBlock::Kind::transmission, "transmission", false, {{{"orders", 0}}}, "coefficients_rad"},
}};

static_assert(
    [] {
      for (std::size_t k = 0; k < joint_term_rows.size(); ++k)
        if (static_cast<std::size_t>(joint_term_rows[k].kind) != k) return false;
      return true;
    }(),
    "each row has the number of its place");

/// What is known of a kind of joint errors.
constexpr const JointTermTraits& traits_of(JointTermBlock::Kind kind) {
  return joint_term_rows[static_cast<std::size_t>(kind)];
}

/// Which joint errors there are: `dq(q) = Phi(q) beta`, Phi one column a coefficient. Blocks, in the order of the
/// coefficients; each may be absent:
/// - gear ratio: `dq_i = rho_i q_i`; outside `linear_ranges` as at their nearest end
/// - coupling: `dq_i = kappa_i q_(i-1)`, i >= 2; likewise
/// - gravity compliance: see `GravityCompliance`
/// - compliance to payload: see `PayloadCompliance`
/// - hysteresis: `dq_i = sum_w h_iw tanh((q_i - p_i) / w)`, p the configuration from which q was approached; 0 where
///   that is unknown, which is the mean of both directions
/// - tilt of the joints' frames: no error of joint values but a motion of the arm's end, see `GravityTilt`
/// - straightness of prismatic joints: likewise, see `Straightness`
/// - transmission: `dq_i = sum_k beta_ik h_k(q_i)`, harmonics of each joint, joint by joint
/// @cite Whitney, Lozinski and Rourke 1986; Ruderman, Hoffmann and Bertram 2009 (hysteresis)
struct JointTerms {
  int joints = 0;                              ///< number of joints
  bool gear_ratio = false;                     ///< present?
  bool coupling = false;                       ///< present?
  std::optional<GravityCompliance> gravity{};  ///< present?
  std::optional<PayloadCompliance> payload{};  ///< present?
  /// Ranges of each joint in which gear ratios and couplings were estimated [rad, m]; empty: no bounds.
  std::vector<JointRange> linear_ranges{};
  std::vector<double> hysteresis{};            ///< widths w [rad, m], the same for every joint; none: absent
  std::optional<GravityTilt> tilt{};           ///< present?
  std::optional<Straightness> straightness{};  ///< present?
  std::vector<Fourier> transmission{};         ///< of each joint; may have no functions

  /// No terms.
  JointTerms() = default;
  /// No terms yet, for an arm of some joints.
  VERNIER_API explicit JointTerms(int number_of_joints)
      : joints(number_of_joints), transmission(static_cast<std::size_t>(number_of_joints), Fourier{}) {}

  /// Number of coefficients before the transmission's, each with a column of its own in a linearised pose.
  Index num_dense_terms() const {
    return (gear_ratio ? joints : 0) + (coupling ? joints - 1 : 0) + (gravity ? gravity->size() : 0) +
           (payload ? joints : 0) + joints * static_cast<Index>(hysteresis.size()) + num_end_terms();
  }
  /// Number of coefficients that move the arm's end: of tilts, then of straightness.
  Index num_end_terms() const { return (tilt ? tilt->size() : 0) + (straightness ? straightness->size() : 0); }
  /// First of them, which are the last before the transmission's.
  Index end_begin() const { return num_dense_terms() - num_end_terms(); }
  /// Translation [m] and rotation vector [rad] of the arm's end by one unit of each, 6 x num_end_terms().
  VERNIER_API void end_basis(const double* q, MatrixRef out) const noexcept;
  /// The motion of the arm's end by the coefficients from `end_begin()` on, see `GravityTilt::motion`.
  VERNIER_API Vector6 end_motion(const double* q, const double* coefficients, double* rates = nullptr) const noexcept;
  /// First coefficient of a joint's transmission; that of joint N is the number of all.
  Index transmission_begin(int joint) const {
    Index begin = num_dense_terms();
    for (int i = 0; i < joint; ++i) begin += transmission[static_cast<std::size_t>(i)].size();
    return begin;
  }
  /// Number of coefficients.
  Index size() const { return transmission_begin(joints); }
  /// The joint value that gear ratio and coupling are multiplied by: the nearest within `linear_ranges`.
  double linear_value(int joint, double q) const noexcept {
    if (linear_ranges.empty()) return q;
    const JointRange& range = linear_ranges[static_cast<std::size_t>(joint)];
    return q < range.lower ? range.lower : q > range.upper ? range.upper : q;
  }
  /// Makes a block present that has one column a coefficient.
  /// @param kind       any but transmission, which has functions of its own for each joint
  /// @param nominal    the chain whose torques gravity compliance needs, and whose frames tilt
  /// @param parameters as `joint_term_rows` lists them
  /// @throws std::invalid_argument on parameters that the block cannot have
  VERNIER_API void add(JointTermBlock::Kind kind, const detail::ChainTable& nominal,
                       std::span<const double> parameters);
  /// The parameters with which `add` makes a present block.
  VERNIER_API std::vector<double> parameters(JointTermBlock::Kind kind) const;
  /// The blocks that are present, in the order of their coefficients.
  VERNIER_API std::vector<JointTermBlock> blocks() const;

  /// The columns of Phi before the transmission's; those of the arm's end are zero.
  /// @param q        joint values [rad, m]
  /// @param previous those from which q was approached; null, or not finite, where unknown
  /// @param out      joints x num_dense_terms()
  /// @param load     what the arm carries beyond the reference payload
  VERNIER_API void dense_basis(const double* q, const double* previous, MatrixRef out,
                               const PayloadLoad& load = {}) const noexcept;

  /// Names: `gear3`, `coupling3` (of joint 2 into 3), `sag2_5` (joint 2 under link 5), `payload2`, `hysteresis3_1`
  /// (joint 3, first width), `straight1_rx2` (joint 1, about x, order 2), `tilt3_xz` (joint 3, about x by gravity along
  /// z), `cos3_12`, `sin3_12` (joint 3, order 12).
  VERNIER_API std::vector<std::string> names() const;
};

namespace detail {

/// Calls `f(a, b)` for the coefficients that two sets of terms have in common: a of the first, b of the second.
VERNIER_API void visit_common_terms(const JointTerms& first, const JointTerms& second,
                                    FunctionRef<void(Index a, Index b)> f);

/// Chain rule: the product of a Jacobian, 6 x n, and the derivative of its joint values, n x n, by columns.
VERNIER_API void compose_jacobian(const double* jacobian, const double* derivative, int n, double* out) noexcept;

}  // namespace detail

/// Joint errors with their coefficients: the map from commanded to effective joint values, and the tilts of the joints'
/// frames.
class JointErrors {
 public:
  /// None.
  JointErrors() = default;
  /// @throws std::invalid_argument when the number of coefficients is not that of the terms, a coefficient is not
  ///         finite, or the terms are not consistent
  VERNIER_API JointErrors(JointTerms terms, VectorX coefficients);

  /// Which errors there are.
  const JointTerms& terms() const { return terms_; }
  /// The coefficients: rad, or m at prismatic joints; gravity's rad/m.
  const VectorX& coefficients() const { return coefficients_; }
  /// These errors under a payload, in place of the reference payload.
  VERNIER_API JointErrors carrying(const Payload& payload) const;
  /// What the arm carries beyond the reference payload.
  const PayloadLoad& load() const { return load_; }
  /// These errors under a load beyond the reference payload.
  JointErrors under(const PayloadLoad& load) const {
    JointErrors out = *this;
    out.load_ = load;
    return out;
  }
  /// Whether there is none.
  bool empty() const { return coefficients_.size() == 0; }

  /// Effective joint values `q + dq(q)`, and their derivative `I + d dq/dq` with respect to the commanded ones. Does
  /// not allocate.
  /// @param q          commanded joint values
  /// @param n          number of joints
  /// @param effective  n values
  /// @param derivative n x n, by columns
  /// @param previous   joint values from which q was approached; null, or not finite, where unknown
  /// @param load       what the arm carries; null: `load()`
  VERNIER_API void evaluate(const double* q, int n, double* effective, double* derivative,
                            const double* previous = nullptr, const PayloadLoad* load = nullptr) const noexcept;

  /// Effective joint values of N joints, and their derivative.
  template <int N>
  struct Effective {
    JointVector<N> joints;                   ///< q + dq(q)
    Eigen::Matrix<double, N, N> derivative;  ///< I + d dq/dq
  };
  /// Evaluates joint errors at q. Does not allocate.
  template <int N>
  Effective<N> effective(const JointVector<N>& q, const double* previous = nullptr) const noexcept {
    Effective<N> out;
    evaluate(q.data(), N, out.joints.data(), out.derivative.data(), previous);
    return out;
  }
  /// Effective values of n configurations, n x joints.
  /// @param joints   commanded values, n x joints [rad, m]
  /// @param previous joint values from which they were approached, likewise; no rows where unknown
  /// @param loads    what the arm carries at each; none: `load()`
  VERNIER_API MatrixX effective_rows(const ConstMatrixRef& joints, const ConstMatrixRef& previous = MatrixX(),
                                     std::span<const PayloadLoad> loads = {}) const;
  /// Half the width of joint i's (from 0) hysteresis loop [rad, m], that of motions much longer than its widths.
  VERNIER_API double half_loop(int i) const noexcept;

  /// Whether the arm's end moves beyond its joints: frames of joints tilt, or a guide is not straight.
  bool tilts() const { return terms_.tilt || terms_.straightness; }
  /// Moves a pose of the arm's end by these motions, and extends its derivative by theirs. Does not
  /// allocate.
  /// @param q        commanded joint values
  /// @param pose     in the base frame of the chain
  /// @param jacobian of that pose with respect to commanded joint values, 6 x joints by columns; null for none
  VERNIER_API void tilt(const double* q, Isometry3& pose, double* jacobian = nullptr) const noexcept;

  /// What the transmission of joint i (from 0) adds at an angle [rad].
  VERNIER_API double transmission(int i, double q) const noexcept;

 private:
  JointTerms terms_{};
  VectorX coefficients_{};
  detail::HarmonicTable harmonics_{};
  PayloadLoad load_{};
};

/// A chain with joint errors: `pose(q) = chain.pose(q + dq(q))`, moved by tilts of the joints' frames where there are
/// any; the approach unknown.
template <class C>
class WithJointErrors : public ChecksJoints<WithJointErrors<C>> {
  using Checks = ChecksJoints<WithJointErrors>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::poses;
  using Checks::position;
  using Checks::positions;

  /// Number of joints.
  static constexpr int dof = C::dof;
  /// The chain inside.
  using Chain = C;

  /// A chain alone, or with joint errors.
  /// @throws std::invalid_argument for joint errors of another number of joints
  WithJointErrors(const Chain& chain, JointErrors errors = {})  // NOLINT(google-explicit-constructor)
      : chain_(chain), errors_(std::move(errors)) {
    demand(errors_.empty() || errors_.terms().joints == dof, "WithJointErrors: errors of ", errors_.terms().joints,
           " joints for a chain of ", dof);
  }

  /// The chain.
  const Chain& chain() const { return chain_; }
  /// The joint errors.
  const JointErrors& joint_errors() const { return errors_; }

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return pose_from(nullptr, q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return pose(q).translation(); }
  /// Positions [m], base frame, of a point [m] fixed in the tool frame, at n configurations.
  PointRows positions(const JointRows<dof>& joints, const Vector3& point = Vector3::Zero()) const {
    if (!errors_.tilts()) return chain_.positions(errors_.effective_rows(joints), point);
    const std::vector<Isometry3> ends = poses(joints);
    PointRows out(joints.rows(), 3);
    for (Index i = 0; i < out.rows(); ++i) set_point(out, i, ends[static_cast<std::size_t>(i)] * point);
    return out;
  }
  /// base_T_tool at n configurations.
  std::vector<Isometry3> poses(const JointRows<dof>& joints) const {
    std::vector<Isometry3> out = chain_.poses(errors_.effective_rows(joints));
    for (std::size_t i = 0; errors_.tilts() && i < out.size(); ++i) {
      const JointVector<dof> q = configuration(joints, static_cast<Index>(i));
      errors_.tilt(q.data(), out[i]);
    }
    return out;
  }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return pose_and_jacobian_from(nullptr, q);
  }

  /// base_T_tool, approached from given joint values.
  /// @param previous dof values; null, or not finite, where unknown
  /// @param q        joint values [rad, m]
  Isometry3 pose_from(const double* previous, const JointVector<dof>& q) const noexcept {
    Isometry3 out = chain_.pose(errors_.effective<dof>(q, previous).joints);
    if (errors_.tilts()) errors_.tilt(q.data(), out);
    return out;
  }
  /// Pose and geometric Jacobian, approached from given joint values (see `pose_from`).
  PoseAndJacobian<dof> pose_and_jacobian_from(const double* previous, const JointVector<dof>& q) const noexcept {
    const auto effective = errors_.effective<dof>(q, previous);
    const PoseAndJacobian<dof> inner = chain_.pose_and_jacobian(effective.joints);
    PoseAndJacobian<dof> out;
    out.pose = inner.pose;
    detail::compose_jacobian(inner.jacobian.data(), effective.derivative.data(), dof, out.jacobian.data());
    if (errors_.tilts()) errors_.tilt(q.data(), out.pose, out.jacobian.data());
    return out;
  }

 private:
  Chain chain_;
  JointErrors errors_;
};

/// An arm with joint errors that came from known joint values: a view of a `WithJointErrors`, which must outlive it.
template <class C>
class ApproachedArm : public ChecksJoints<ApproachedArm<C>> {
  using Checks = ChecksJoints<ApproachedArm>;

 public:
  using Checks::jacobian;
  using Checks::pose;
  using Checks::pose_and_jacobian;
  using Checks::position;

  /// Number of joints.
  static constexpr int dof = C::dof;
  /// The chain inside.
  using Chain = C;

  /// @param arm      seen through this; must outlive it
  /// @param previous joint values from which it moves to the next configuration [rad, m]
  ApproachedArm(const WithJointErrors<Chain>& arm, const JointVector<dof>& previous) noexcept
      : arm_(&arm), previous_(previous) {}

  /// base_T_tool.
  Isometry3 pose(const JointVector<dof>& q) const noexcept { return arm_->pose_from(previous_.data(), q); }
  /// Tool position [m], base frame.
  Vector3 position(const JointVector<dof>& q) const noexcept { return pose(q).translation(); }
  /// Geometric Jacobian, 6 x N, see `Jacobian`.
  Jacobian<dof> jacobian(const JointVector<dof>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  /// Both in one pass.
  PoseAndJacobian<dof> pose_and_jacobian(const JointVector<dof>& q) const noexcept {
    return arm_->pose_and_jacobian_from(previous_.data(), q);
  }

 private:
  const WithJointErrors<Chain>* arm_;
  JointVector<dof> previous_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/joint_errors.ipp"
#endif
