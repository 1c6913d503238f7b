// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Three joints whose axes meet in a point, and what else closed forms of whole arms share.

#include <algorithm>

#include "vernier/core/types.hpp"

namespace vernier::detail {

struct AnglePair;

inline constexpr double most_margin = 0.05;  // a target so far outside the nominal arm may be inside the real one
inline constexpr double negligible_length = 1e-10;
inline constexpr int angle_samples = 8;         // of a joint whose value hardly matters
inline constexpr double sampled_margin = 1e-3;  // marks them

/// Three joints whose axes meet in a point, as one rotation `R(k4, q4) R(k5, q5) R(k6, q6)`.
struct Wrist {
  Vector3 k4, k5, k6;
  double alpha, beta;  ///< angles between k4 and k5, and k5 and k6 [rad]
  double centre;       ///< joint 5 where k6 is nearest to k4 [rad]
  Vector3 e6, f6;      ///< at right angles to k6, and to each other
};

/// @param k4, k5, k6 unit vectors, no two neighbours parallel
VERNIER_API Wrist wrist_of(const Vector3& k4, const Vector3& k5, const Vector3& k6);

/// The point nearest to lines.
struct MeetingPoint {
  Vector3 point;
  double miss;  ///< largest distance from one of them; 1e300 where they are parallel
};
/// Finds where lines meet, in the sense of least squares.
/// @param directions, points of the lines
VERNIER_API MeetingPoint meeting_point(const Vector3* directions, const Vector3* points, int lines) noexcept;

/// The one or two angles of a pair that are no further outside than allowed; next to a singularity samples all around.
struct Candidates {
  double angles[2 + angle_samples];
  int count;
  int exact;      ///< number of exact ones, which come first; the others are samples
  double margin;  ///< of the exact ones
  bool any;

  /// @param widest circle that counts as next to a singularity [m]
  VERNIER_API Candidates(const AnglePair& pair, double close_to, double widest = 0);
  double margin_of(int k) const { return k < exact ? margin : std::clamp(margin, sampled_margin, most_margin); }
};

/// Angles of a wrist whose rotation is given.
struct WristAngles {
  double q4[2 + angle_samples], q5[2 + angle_samples], q6[2 + angle_samples];
  int count;
  int exact;      ///< number of exact ones, which come first; the others are samples
  double margin;  ///< of the exact ones
  bool any;

  double margin_of(int k) const { return k < exact ? margin : (std::max)(margin, sampled_margin); }
};

/// The angles of a wrist for a rotation.
/// @param near4  value that the first joint takes where it is arbitrary [rad]
/// @param widest angle from the straight wrist that counts as next to a singularity [rad]: then samples of joint 4, too
VERNIER_API WristAngles solve_wrist(const Wrist& wrist, const Matrix3& rotation, double near4, double widest) noexcept;

/// An angle brought into (-pi, pi] by whole turns [rad].
VERNIER_API double wrapped_angle(double angle) noexcept;

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/wrist.ipp"
#endif
