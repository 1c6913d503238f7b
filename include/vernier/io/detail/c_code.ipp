#pragma once

#include <algorithm>
#include <cctype>
#include <vector>

#include "vernier/io/detail/c_chain.hpp"
#include "vernier/io/detail/c_code.hpp"
#include "vernier/io/detail/c_correction.hpp"
#include "vernier/io/detail/c_gates.hpp"
#include "vernier/io/detail/c_joint_errors.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string fill_in(std::string_view text, const std::string& name,
                                 const std::set<std::string>& features) {
  std::string capitals = name;
  for (char& letter : capitals) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  std::string out;
  std::vector<bool> kept{true};  // of the conditions around a line
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n') + 1, text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    if (line.starts_with("@if ")) {
      std::string feature(line.substr(4, line.size() - 5));
      const bool absent = feature.front() == '!';
      if (absent) feature.erase(0, 1);
      kept.push_back(kept.back() && features.contains(feature) != absent);
    } else if (line.starts_with("@end")) {
      kept.pop_back();
    } else if (kept.back()) {
      for (std::size_t at; (at = line.find('$')) != std::string_view::npos;) {
        const bool capital = line.substr(at, 2) == "$$";
        out.append(line.substr(0, at)).append(capital ? capitals : name);
        line.remove_prefix(at + (capital ? 2 : 1));
      }
      out += line;
    }
  }
  return out;
}

VERNIER_IMPL std::string_view c_declarations() {
  return R"C(
/* Joint values are commands [rad, m]. A pose T is base_T_tool in the frame of the measurements: the upper three rows of
 * the 4 x 4 matrix, row by row, [m]. `previous` is the command before, from which the arm comes; 0, or values that are
 * not finite, where that is unknown: then the arm is in the middle of both directions of approach. */

/* The pose that the arm takes when commanded q. */
$$_API void $_pose(const double q[$$_JOINTS], const double *previous, double T[12]);

/* The pose of the arm as designed, in the same frames: where a program means the arm to be at q. */
$$_API void $_nominal_pose(const double q[$$_JOINTS], double T[12]);

/* The geometric Jacobian of `$_pose`, 6 x $$_JOINTS, row by row: linear rows first, at the tool point. */
$$_API void $_jacobian(const double q[$$_JOINTS], const double *previous, double J[6 * $$_JOINTS]);

/* Share of what was learned over the joints that is used at q: 1 within the measured joint ranges, 0 far outside. */
$$_API double $_gate(const double q[$$_JOINTS]);

/* The command q that brings the arm to the pose T, on the branch of `seed`; the best one found in any case, within the
 * joint limits.
@if !oriented
 * The orientation of T is ignored: the arm has fewer than six joints.
@end
 * `error`, unless it is 0, becomes the distance from T that is left [m]. `q` may be `seed` or `previous`.
 * Returns $$_MET, $$_STALLED (the iterations ran out) or $$_LIMITS (out of reach or beyond the limits).
 * To correct the command of a program, q0: $_nominal_pose(q0, T); $_correct(T, q0, previous, q, &error); */
$$_API int $_correct(const double T[12], const double seed[$$_JOINTS], const double *previous, double q[$$_JOINTS],
                     double *error);
)C";
}

VERNIER_IMPL std::string_view c_types() {
  return R"C(
/* An arm; 0 for what it lacks. Frames are four columns: the axes x, y, z and the origin. */
typedef struct {
  const double *rows;          /* of each joint: theta, d, a, sin and cos of alpha, sin and cos of beta */
  const double *base, *tool;   /* frames */
  const double *gear;          /* error of the gear ratio of each joint */
  const double *coupling;      /* of each joint by the one before; the first is 0 */
  const double *linear_ranges; /* of each joint, the range of these two */
  const double *gravity;       /* of joint i under link j >= i [rad/m] */
  const double *gravity_down;  /* direction of gravity */
  const double *hysteresis;    /* of each width: the width, then a coefficient a joint */
  int widths;
  const double *tilt;      /* of each joint: about x by the three components of gravity, about y likewise */
  const double *tilt_down; /* direction of gravity */
  const double *harmonics; /* of each order: cosine coefficients of all joints, then sine coefficients */
  const int *order;
  int orders;
} $_arm_;
@if gates

/* Measured ranges of the joints. */
typedef struct {
  const double *margin; /* of each joint: width of the transition to 0 */
  const int *periodic;  /* of each joint: whether whole turns count as the same */
  const int *count;     /* of each joint: number of ranges */
  const double *ranges; /* lower and upper ends, joint by joint */
} $_coverage_;
@end
)C";
}

VERNIER_IMPL std::string c_functions() {
  std::string out;
  for (const std::string_view part : {c_vector_code(), c_chain_code(), c_joint_error_code(), c_gate_code(),
                                      c_learned_code(), c_arm_code(), c_correction_code()})
    out += part;
  return out;
}

}  // namespace vernier::detail
