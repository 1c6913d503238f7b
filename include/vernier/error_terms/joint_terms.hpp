// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which errors the joints of a real arm may have: kinds, columns and names of their coefficients.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/motor_angles.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_terms/fourier.hpp"
#include "vernier/error_terms/gravity_compliance.hpp"
#include "vernier/error_terms/gravity_tilt.hpp"
#include "vernier/error_terms/payload_bend.hpp"
#include "vernier/error_terms/payload_compliance.hpp"
#include "vernier/error_terms/straightness.hpp"

namespace vernier {

/// Coefficients of joint errors that belong together.
struct JointTermBlock {
  /// What they are coefficients of.
  enum class Kind { gear_ratio, coupling, gravity, payload, hysteresis, tilt, bend, straightness, transmission };
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
inline constexpr std::array<JointTermTraits, 9> joint_term_rows{{
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
    {JointTermBlock::Kind::bend,
     "payload_bend",
     true,
     {{{"down", 3}, {"reference_kg", 1}, {"reference_centre_m", 3}}},
     "compliances_rad_per_nm"},
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
/// - bends across the joints' axes under a payload: likewise, see `PayloadBend`; beside a compliance to payload
/// - straightness of prismatic joints: likewise, see `Straightness`
/// - transmission: `dq_i = sum_k beta_ik h_k(q_i)`, harmonics of each joint, joint by joint
///
/// Gear ratio, coupling, hysteresis and transmission are errors of motors. Where `motors` has any, q in their formulas
/// are the motors' angles, and the joints move by S dq (`MotorAngles`).
/// @cite Whitney, Lozinski and Rourke 1986; Ruderman, Hoffmann and Bertram 2009 (hysteresis)
struct JointTerms {
  int joints = 0;                              ///< number of joints
  MotorAngles motors{};                        ///< whose gears err; none: each joint's own
  bool gear_ratio = false;                     ///< present?
  bool coupling = false;                       ///< present?
  std::optional<GravityCompliance> gravity{};  ///< present?
  std::optional<PayloadCompliance> payload{};  ///< present?
  /// Ranges of each joint, or motor, in which gear ratios and couplings were estimated [rad, m]; empty: no bounds.
  std::vector<JointRange> linear_ranges{};
  std::vector<double> hysteresis{};            ///< widths w [rad, m], the same for every joint; none: absent
  std::optional<GravityTilt> tilt{};           ///< present?
  std::optional<PayloadBend> bend{};           ///< present?
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
  /// Number of coefficients that move the arm's end: of tilts, then of bends, then of straightness.
  Index num_end_terms() const {
    return (tilt ? tilt->size() : 0) + (bend ? bend->size() : 0) + (straightness ? straightness->size() : 0);
  }
  /// First of them, which are the last before the transmission's.
  Index end_begin() const { return num_dense_terms() - num_end_terms(); }
  /// Translation [m] and rotation vector [rad] of the arm's end by one unit of each, 6 x num_end_terms().
  /// @param load what the arm carries beyond the reference payload
  VERNIER_API void end_basis(const double* q, const PayloadLoad& load, MatrixRef out) const noexcept;
  /// The motion of the arm's end by the coefficients from `end_begin()` on, see `GravityTilt::motion`.
  VERNIER_API Vector6 end_motion(const double* q, const PayloadLoad& load, const double* coefficients,
                                 double* rates = nullptr) const noexcept;
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

  /// Adds gear ratios, couplings and hysteresis to errors of motors, and their derivative, as `add_dense` does.
  /// @param q,previous angles of the motors
  VERNIER_API void add_of_motors(const double* q, const double* previous, const double* beta, double* effective,
                                 double* derivative) const noexcept;

  /// The columns of Phi before the transmission's; those of the arm's end are zero.
  /// @param q        joint values [rad, m]
  /// @param previous those from which q was approached; null, or not finite, where unknown
  /// @param out      joints x num_dense_terms()
  /// @param load     what the arm carries beyond the reference payload
  VERNIER_API void dense_basis(const double* q, const double* previous, MatrixRef out,
                               const PayloadLoad& load = {}) const noexcept;
  /// Adds `Phi(q) beta` of these columns to joint values, and its derivative with respect to q. Does not allocate.
  /// @param q          joint values [rad, m]
  /// @param previous   those from which q was approached; null, or not finite, where unknown
  /// @param load       what the arm carries beyond the reference payload
  /// @param beta       coefficients, num_dense_terms() or more
  /// @param effective  one value a joint
  /// @param derivative joints x joints, by columns
  VERNIER_API void add_dense(const double* q, const double* previous, const PayloadLoad& load, const double* beta,
                             double* effective, double* derivative) const noexcept;

  /// Names: `gear3`, `coupling3` (of joint 2 into 3), `sag2_5` (joint 2 under link 5), `payload2`, `bend2_x` (across
  /// joint 2, about x), `hysteresis3_1`
  /// (joint 3, first width), `straight1_rx2` (joint 1, about x, order 2), `tilt3_xz` (joint 3, about x by gravity along
  /// z), `cos3_12`, `sin3_12` (joint 3, order 12).
  VERNIER_API std::vector<std::string> names() const;
};

namespace detail {

/// Calls `f(a, b)` for the coefficients that two sets of terms have in common: a of the first, b of the second.
VERNIER_API void visit_common_terms(const JointTerms& first, const JointTerms& second,
                                    FunctionRef<void(Index a, Index b)> f);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/joint_terms.ipp"
#endif
