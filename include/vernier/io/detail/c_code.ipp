#pragma once

#include <algorithm>
#include <cctype>
#include <vector>

#include "vernier/io/detail/c_code.hpp"

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

inline constexpr std::string_view c_vectors = R"C(
/* ---- vectors, rotations (nine numbers, column by column) ---- */

static inline double $_dot_(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void $_cross_(const double *a, const double *b, double *out) {
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  out[0] = x;
  out[1] = y;
  out[2] = z;
}
@if gravity

static inline double $_triple_(const double *a, const double *b, const double *c) {
  double bc[3];
  $_cross_(b, c, bc);
  return $_dot_(a, bc);
}
@end

static inline void $_rotate_(const double *R, const double *v, double *out) {
  const double x = v[0], y = v[1], z = v[2];
  int k;
  for (k = 0; k < 3; ++k) out[k] = R[k] * x + R[3 + k] * y + R[6 + k] * z;
}

static inline void $_product_(const double *A, const double *B, double *out) {
  int j;
  for (j = 0; j < 9; j += 3) $_rotate_(A, B + j, out + j);
}
@if log

/* A B' */
static inline void $_between_(const double *A, const double *B, double *out) {
  int i, j;
  for (j = 0; j < 3; ++j)
    for (i = 0; i < 3; ++i) out[3 * j + i] = A[i] * B[j] + A[3 + i] * B[3 + j] + A[6 + i] * B[6 + j];
}

static inline void $_log_(const double *R, double *r) {
  const double trace = R[0] + R[4] + R[8];
  double w, v[3], square, factor, t;
  int i;
  if (trace > 0) {
    t = sqrt(trace + 1);
    w = t / 2;
    v[0] = (R[5] - R[7]) / (2 * t);
    v[1] = (R[6] - R[2]) / (2 * t);
    v[2] = (R[1] - R[3]) / (2 * t);
  } else {
    int j, k;
    i = R[4] > R[0] ? 1 : 0;
    if (R[8] > R[4 * i]) i = 2;
    j = (i + 1) % 3;
    k = (i + 2) % 3;
    t = sqrt(R[4 * i] - R[4 * j] - R[4 * k] + 1);
    v[i] = t / 2;
    v[j] = (R[3 * i + j] + R[3 * j + i]) / (2 * t);
    v[k] = (R[3 * i + k] + R[3 * k + i]) / (2 * t);
    w = (R[3 * j + k] - R[3 * k + j]) / (2 * t);
    if (w < 0) {
      w = -w;
      for (i = 0; i < 3; ++i) v[i] = -v[i];
    }
  }
  square = $_dot_(v, v);
  if (square < 1e-8) {
    factor = 2 / w * (1 - square / (3 * w * w));
  } else {
    t = sqrt(square);
    factor = 2 * atan2(t, w) / t;
  }
  for (i = 0; i < 3; ++i) r[i] = factor * v[i];
}
@end
@if exp

/* 1 + a [r] + b [r] [r], [r] v = r x v */
static inline void $_series_(double a, double b, const double *r, double *out) {
  const double square = $_dot_(r, r);
  int i, j;
  for (j = 0; j < 3; ++j)
    for (i = 0; i < 3; ++i) out[3 * j + i] = b * (r[i] * r[j] - (i == j ? square : 0)) + (i == j ? 1 : 0);
  out[1] += a * r[2];
  out[2] -= a * r[1];
  out[3] -= a * r[2];
  out[5] += a * r[0];
  out[6] += a * r[1];
  out[7] -= a * r[0];
}

static inline void $_exp_(const double *r, double *R) {
  const double square = $_dot_(r, r);
  if (square < 1e-8) {
    $_series_(1 - square / 6 + square * square / 120, 0.5 - square / 24 + square * square / 720, r, R);
  } else {
    const double angle = sqrt(square), half = sin(angle / 2);
    $_series_(sin(angle) / angle, 2 * half * half / square, r, R);
  }
}

/* From the rate of a rotation vector to the angular velocity. */
static inline void $_left_(const double *r, double *out) {
  const double square = $_dot_(r, r);
  if (square < 1e-4) {
    $_series_(0.5 - square / 24 + square * square / 720, 1.0 / 6 - square / 120 + square * square / 5040, r, out);
  } else {
    const double angle = sqrt(square), half = sin(angle / 2);
    $_series_(2 * half * half / square, (angle - sin(angle)) / (square * angle), r, out);
  }
}
@end
@if fallback

/* And back. */
static inline void $_left_inverse_(const double *r, double *out) {
  const double square = $_dot_(r, r);
  if (square < 1e-4) {
    $_series_(-0.5, 1.0 / 12 + square / 720 + square * square / 30240, r, out);
  } else {
    const double half = sqrt(square) / 2;
    $_series_(-0.5, (1 - half * cos(half) / sin(half)) / square, r, out);
  }
}
@end
)C";

inline constexpr std::string_view c_chain = R"C(
/* ---- the chain ---- */

/* Where the links are; three coordinates a joint. */
typedef struct {
  double axis[3 * $$_JOINTS], point[3 * $$_JOINTS]; /* of the joint */
@if links
  double end[3 * $$_JOINTS];                        /* of the link */
  double x[3 * $$_JOINTS], y[3 * $$_JOINTS], origin[3 * $$_JOINTS]; /* of the frame behind the joint */
@end
} $_links_;

/* Turns one axis towards another. */
static inline void $_turn_(double *from, double *towards, double c, double s) {
  int k;
  for (k = 0; k < 3; ++k) {
    const double turned = c * from[k] + s * towards[k];
    towards[k] = c * towards[k] - s * from[k];
    from[k] = turned;
  }
}

static inline void $_move_(double *origin, const double *axis, double length) {
  int k;
  for (k = 0; k < 3; ++k) origin[k] += length * axis[k];
}

static inline void $_store_(double *out, int joint, const double *v) {
  int k;
  for (k = 0; k < 3; ++k) out[3 * joint + k] = v[k];
}

/* Carries a frame along a chain from where it begins. */
static inline void $_walk_(const double *rows, const double *q, double *frame, $_links_ *links) {
  double *x = frame, *y = frame + 3, *z = frame + 6, *origin = frame + 9, c[$$_JOINTS], s[$$_JOINTS];
  int i;
  for (i = 0; i < $$_JOINTS; ++i) {
@if prismatic
    const double angle = rows[7 * i] + ($_prismatic_[i] ? 0 : q[i]);
@end
@if !prismatic
    const double angle = rows[7 * i] + q[i];
@end
    c[i] = cos(angle);
    s[i] = sin(angle);
  }
  for (i = 0; i < $$_JOINTS; ++i) {
    const double *row = rows + 7 * i;
@if prismatic
    const double d = row[1] + ($_prismatic_[i] ? q[i] : 0);
@end
@if !prismatic
    const double d = row[1];
@end
@if modified
    $_turn_(y, z, row[4], row[3]);
    $_move_(origin, x, row[2]);
    $_turn_(z, x, row[6], row[5]);
@end
    $_store_(links->axis, i, z);
    $_store_(links->point, i, origin);
    $_turn_(x, y, c[i], s[i]);
    $_move_(origin, z, d);
@if links
    $_store_(links->x, i, x);
    $_store_(links->y, i, y);
    $_store_(links->origin, i, origin);
@end
@if !modified
    $_move_(origin, x, row[2]);
    $_turn_(y, z, row[4], row[3]);
    $_turn_(z, x, row[6], row[5]);
@end
@if links
    $_store_(links->end, i, origin);
@end
  }
}

static inline void $_identity_(double *frame) {
  int k;
  for (k = 0; k < 12; ++k) frame[k] = k == 0 || k == 4 || k == 8 ? 1 : 0;
}

/* From the end of a chain to base_T_tool. */
static inline void $_into_frames_(const double *base, const double *tool, const double *end, double *out) {
  double flange[12], tip[3];
  int k;
  $_product_(base, end, flange);
  $_rotate_(base, end + 9, flange + 9);
  $_rotate_(flange, tool + 9, tip);
  for (k = 0; k < 3; ++k) out[9 + k] = base[9 + k] + flange[9 + k] + tip[k];
  $_product_(flange, tool, out);
}

/* From columns to the upper three rows, and back. */
static inline void $_to_rows_(const double *frame, double *T) {
  int i, j;
  for (i = 0; i < 3; ++i)
    for (j = 0; j < 4; ++j) T[4 * i + j] = frame[3 * j + i];
}

static inline void $_to_columns_(const double *T, double *frame) {
  int i, j;
  for (i = 0; i < 3; ++i)
    for (j = 0; j < 4; ++j) frame[3 * j + i] = T[4 * i + j];
}
)C";

inline constexpr std::string_view c_joint_errors = R"C(
/* ---- errors of the joints. Derivatives `rate` are $$_JOINTS x $$_JOINTS, a column a commanded joint; 0 for none ---- */
@if linear

static inline double $_linear_(const $_arm_ *arm, int joint, double q) {
  const double *range = arm->linear_ranges;
  if (!range) return q;
  range += 2 * joint;
  return q < range[0] ? range[0] : q > range[1] ? range[1] : q;
}

/* Gear ratios and coupling. */
static inline void $_add_linear_(const $_arm_ *arm, const double *q, double *joints, double *rate) {
  int i, from;
  for (i = 0; i < $$_JOINTS; ++i)
    for (from = i; from >= 0 && from >= i - 1; --from) {
      const double *of = from == i ? arm->gear : arm->coupling;
      const double linear = $_linear_(arm, from, q[from]);
      if (!of) continue;
      joints[i] += of[i] * linear;
      if (rate && linear == q[from]) rate[from * $$_JOINTS + i] += of[i];
    }
}
@end
@if gravity

/* Torques of the links' weights. */
static inline void $_add_gravity_(const $_arm_ *arm, const $_links_ *links, double *joints, double *rate) {
  const double *down = arm->gravity_down, *weight = arm->gravity;
  int i, j, k;
  for (i = 0; i < $$_JOINTS; ++i) {
    const double *axis = links->axis + 3 * i;
    double sum[3] = {0, 0, 0}, lever[3], turned[3], total = 0;
    for (k = $$_JOINTS - 1; k >= i; --k) { /* the links from k on */
      total += weight[k - i];
      for (j = 0; j < 3; ++j) {
        sum[j] += weight[k - i] * links->end[3 * k + j];
        lever[j] = sum[j] - total * links->point[3 * k + j];
      }
@if prismatic
      if ($_prismatic_[i]) continue;
      if ($_prismatic_[k]) {
        if (rate) rate[k * $$_JOINTS + i] += total * $_triple_(axis, links->axis + 3 * k, down);
        continue;
      }
@end
      $_cross_(links->axis + 3 * k, lever, turned);
      if (rate) rate[k * $$_JOINTS + i] += $_triple_(axis, turned, down);
    }
    weight += $$_JOINTS - i;
@if prismatic
    if ($_prismatic_[i]) {
      joints[i] += total * $_dot_(axis, down);
      for (k = 0; rate && k < i; ++k) {
        if ($_prismatic_[k]) continue;
        $_cross_(links->axis + 3 * k, axis, turned);
        rate[k * $$_JOINTS + i] += total * $_dot_(turned, down);
      }
      continue;
    }
@end
    joints[i] += $_triple_(axis, lever, down);
    for (k = 0; rate && k < i; ++k) {
      const double *turn = links->axis + 3 * k;
@if prismatic
      if ($_prismatic_[k]) continue;
@end
      $_cross_(turn, axis, turned);
      rate[k * $$_JOINTS + i] += $_triple_(turned, lever, down);
      $_cross_(turn, lever, turned);
      rate[k * $$_JOINTS + i] += $_triple_(axis, turned, down);
    }
  }
}
@end
@if hysteresis

static inline void $_add_hysteresis_(const $_arm_ *arm, const double *q, const double *previous, double *joints,
                                     double *rate) {
  int i, w;
  if (!previous) return;
  for (w = 0; w < arm->widths; ++w) {
    const double *of = arm->hysteresis + w * ($$_JOINTS + 1), width = of[0];
    for (i = 0; i < $$_JOINTS; ++i) {
      double step;
      if (!(previous[i] - previous[i] == 0)) continue; /* unknown */
      step = tanh((q[i] - previous[i]) / width);
      joints[i] += of[i + 1] * step;
      if (rate && step != 0) rate[i * $$_JOINTS + i] += of[i + 1] * (1 - step * step) / width;
    }
  }
}
@end
@if harmonics

/* Turns unit vectors on by others, or by themselves. */
static inline void $_turn_all_(double *c, double *s, const double *by_c, const double *by_s) {
  int i;
  for (i = 0; i < $$_LANES_; ++i) {
    const double next = c[i] * by_c[i] - s[i] * by_s[i];
    s[i] = s[i] * by_c[i] + c[i] * by_s[i];
    c[i] = next;
  }
}

/* Functions of single joints, all joints side by side: the unit vector of each angle is turned from order to order. */
static inline void $_add_harmonics_(const $_arm_ *arm, const double *q, double *joints, double *rate) {
  double c1[$$_LANES_], s1[$$_LANES_], c[$$_LANES_], s[$$_LANES_], value[$$_LANES_], slope[$$_LANES_];
  const double *of = arm->harmonics;
  int i, k, order = 0;
  for (i = 0; i < $$_LANES_; ++i) {
    const double angle = i < $$_JOINTS ? q[i] : 0;
    c1[i] = cos(angle);
    s1[i] = sin(angle);
    c[i] = 1;
    s[i] = value[i] = slope[i] = 0;
  }
  for (k = 0; k < arm->orders; ++k, of += 2 * $$_LANES_) {
    const double at = arm->order[k];
    int gap = arm->order[k] - order; /* c and s are those of `order` */
    if (gap > 0) {
      double cp[$$_LANES_], sp[$$_LANES_];
      for (i = 0; i < $$_LANES_; ++i) {
        cp[i] = c1[i];
        sp[i] = s1[i];
      }
      for (; gap > 0; gap >>= 1) { /* powers of two */
        if (gap & 1) $_turn_all_(c, s, cp, sp);
        if (gap > 1) $_turn_all_(cp, sp, cp, sp);
      }
    }
    order = arm->order[k] + 1;
    for (i = 0; i < $$_LANES_; ++i) {
      const double a = of[i], b = of[$$_LANES_ + i], cosine = c[i], sine = s[i];
      value[i] += a * cosine + b * sine;
      slope[i] += at * (b * cosine - a * sine);
      c[i] = cosine * c1[i] - sine * s1[i];
      s[i] = sine * c1[i] + cosine * s1[i];
    }
  }
  for (i = 0; i < $$_JOINTS; ++i) {
    joints[i] += value[i];
    if (rate) rate[i * $$_JOINTS + i] += slope[i];
  }
}
@end
@if tilt

/* Tilts of the joints' frames under gravity: a motion of the arm's end in the base frame of the chain. */
static inline void $_add_tilt_(const $_arm_ *arm, const $_links_ *links, double *end, double *J) {
  double shift[3] = {0, 0, 0}, turn[3] = {0, 0, 0}, rates[6 * $$_JOINTS], R[9], left[9], rotated[9], v[3], w[3];
  int i, j, k;
  for (i = 0; i < $$_JOINTS; ++i) {
    const double *c = arm->tilt + 6 * i, *x = links->x + 3 * i, *y = links->y + 3 * i, *origin = links->origin + 3 * i;
    double z[3], tilted[3];
    $_cross_(x, y, z);
    for (k = -1; k <= (J ? i : -1); ++k) { /* -1: the motion itself, else its change by joint k */
      double gravity[3], g[3], lever[3], about_x, about_y;
      if (k < 0) {
        for (j = 0; j < 3; ++j) gravity[j] = arm->tilt_down[j];
      } else {
        $_cross_(arm->tilt_down, links->axis + 3 * k, gravity);
      }
      g[0] = $_dot_(x, gravity);
      g[1] = $_dot_(y, gravity);
      g[2] = $_dot_(z, gravity);
      about_x = $_dot_(c, g);
      about_y = $_dot_(c + 3, g);
      for (j = 0; j < 3; ++j) v[j] = about_x * x[j] + about_y * y[j];
      if (k < 0) {
        $_cross_(origin, v, w);
        for (j = 0; j < 3; ++j) {
          tilted[j] = v[j];
          turn[j] += v[j];
          shift[j] += w[j];
        }
        continue;
      }
      $_cross_(links->axis + 3 * k, tilted, w);
@if prismatic
      if ($_prismatic_[k]) {
        for (j = 0; j < 3; ++j) {
          rates[6 * k + j] = (k == i ? 0 : rates[6 * k + j]) + w[j];
          rates[6 * k + 3 + j] = k == i ? 0 : rates[6 * k + 3 + j];
        }
        continue;
      }
@end
      for (j = 0; j < 3; ++j) {
        v[j] += w[j];
        rates[6 * k + 3 + j] = (k == i ? 0 : rates[6 * k + 3 + j]) + v[j];
        lever[j] = origin[j] - links->point[3 * k + j];
      }
      $_cross_(origin, v, w);
      $_cross_(links->axis + 3 * k, lever, v);
      $_cross_(v, tilted, v);
      for (j = 0; j < 3; ++j) rates[6 * k + j] = (k == i ? 0 : rates[6 * k + j]) + w[j] + v[j];
    }
  }
  $_exp_(turn, R);
  $_product_(R, end, rotated);
  for (k = 0; k < 9; ++k) end[k] = rotated[k];
  $_rotate_(R, end + 9, v); /* the end, turned */
  for (j = 0; j < 3; ++j) end[9 + j] = v[j] + shift[j];
  if (!J) return;
  $_left_(turn, left);
  for (k = 0; k < $$_JOINTS; ++k) {
    double *linear = J + 6 * k, *angular = linear + 3, omega[3];
    $_rotate_(left, rates + 6 * k + 3, omega);
    $_rotate_(R, linear, linear);
    $_rotate_(R, angular, angular);
    $_cross_(omega, v, w);
    for (j = 0; j < 3; ++j) {
      linear[j] += w[j] + rates[6 * k + j];
      angular[j] += omega[j];
    }
  }
}
@end
)C";

inline constexpr std::string_view c_arm = R"C(
/* ---- the arm ---- */

/* base_T_tool as columns, and its Jacobian as columns of six; 0 for none. */
static inline void $_arm_at_(const $_arm_ *arm, const double *q, const double *previous, double *frame, double *J) {
  double joints[$$_JOINTS], rate[$$_JOINTS * $$_JOINTS], end[12];
  $_links_ links;
@if links
  $_links_ nominal;
@end
  int i, j, k;
  (void)previous;
  for (k = 0; k < $$_JOINTS; ++k) {
    joints[k] = q[k];
    for (i = 0; i < $$_JOINTS; ++i) rate[k * $$_JOINTS + i] = i == k ? 1 : 0;
  }
@if links
  if (arm->gravity || arm->tilt) {
    $_identity_(end);
    $_walk_($_nominal_rows_, q, end, &nominal);
  }
@end
@if linear
  $_add_linear_(arm, q, joints, J ? rate : 0);
@end
@if gravity
  if (arm->gravity) $_add_gravity_(arm, &nominal, joints, J ? rate : 0);
@end
@if hysteresis
  $_add_hysteresis_(arm, q, previous, joints, J ? rate : 0);
@end
@if harmonics
  if (arm->orders) $_add_harmonics_(arm, q, joints, J ? rate : 0);
@end
  $_identity_(end);
  $_walk_(arm->rows, joints, end, &links);
  if (J) {
    double columns[6 * $$_JOINTS], lever[3];
    for (k = 0; k < $$_JOINTS; ++k) {
      double *column = columns + 6 * k;
      const double *axis = links.axis + 3 * k;
@if prismatic
      if ($_prismatic_[k]) {
        for (j = 0; j < 3; ++j) {
          column[j] = axis[j];
          column[3 + j] = 0;
        }
        continue;
      }
@end
      for (j = 0; j < 3; ++j) {
        lever[j] = end[9 + j] - links.point[3 * k + j];
        column[3 + j] = axis[j];
      }
      $_cross_(axis, lever, column);
    }
    for (k = 0; k < $$_JOINTS; ++k)
      for (j = 0; j < 6; ++j) {
        double sum = 0;
        for (i = 0; i < $$_JOINTS; ++i) sum += columns[6 * i + j] * rate[k * $$_JOINTS + i];
        J[6 * k + j] = sum;
      }
  }
@if tilt
  if (arm->tilt) $_add_tilt_(arm, &nominal, end, J);
@end
  if (J) { /* from the flange to the tool point, from the chain's base to the base */
    double lever[3], moved[3];
    $_rotate_(end, arm->tool + 9, lever);
    for (k = 0; k < $$_JOINTS; ++k) {
      double *linear = J + 6 * k, *angular = linear + 3;
      $_cross_(angular, lever, moved);
      for (j = 0; j < 3; ++j) linear[j] += moved[j];
      $_rotate_(arm->base, linear, linear);
      $_rotate_(arm->base, angular, angular);
    }
  }
  $_into_frames_(arm->base, arm->tool, end, frame);
}
@if gates

/* The gate of one joint, and its slope. */
static inline double $_gate_of_joint_(const double *ranges, int count, double margin, int periodic, double q,
                                      double *slope) {
  const double turn = 6.2831853071795864769;
  double above = HUGE_VAL, below = HUGE_VAL, outside; /* distances to the nearest range on either side */
  int k;
  *slope = 0;
  if (count == 0) return 1;
  for (k = 0; k < count; ++k) {
    const double length = ranges[2 * k + 1] - ranges[2 * k], from_lower = q - ranges[2 * k];
    const double turned = periodic ? from_lower - turn * floor(from_lower / turn) : from_lower;
    const double up = periodic ? turn - turned : -turned;
    if (turned >= 0 && turned <= length) return 1;
    if ((periodic || turned > length) && turned - length < below) below = turned - length;
    if ((periodic || turned < 0) && up < above) above = up;
  }
  if (above + below <= 2 * margin) return 1;
  outside = (below < above ? below : above) / margin;
  if (!(outside < 1)) return 0;
  *slope = 6 * outside * (1 - outside) * (above < below ? 1 : -1) / margin;
  return 1 - outside * outside * (3 - 2 * outside);
}

/* The product of all, and where wanted its gradient. */
static inline double $_gate_at_(const $_coverage_ *coverage, const double *q, double *gradient) {
  double value[$$_JOINTS], slope[$$_JOINTS], product = 1;
  const double *ranges = coverage->ranges;
  int i, k;
  for (i = 0; i < $$_JOINTS; ++i) {
    value[i] =
        $_gate_of_joint_(ranges, coverage->count[i], coverage->margin[i], coverage->periodic[i], q[i], slope + i);
    ranges += 2 * coverage->count[i];
    product *= value[i];
  }
  for (k = 0; gradient && k < $$_JOINTS; ++k) {
    gradient[k] = slope[k];
    for (i = 0; i < $$_JOINTS; ++i)
      if (i != k) gradient[k] *= value[i];
  }
  return product;
}
@end
@if fallback

/* From `far` to `near` by the gate, the rotation along the geodesic; `far` and its Jacobian are overwritten. */
static inline void $_blend_(double gate, const double *slope, const double *near_frame, const double *near_J,
                            double *far_frame, double *far_J) {
  double between[9], phi[3], part[3], turn[9], inverse[9], left[9], apart[3], v[3], rotated[9];
  int j, k;
  $_between_(near_frame, far_frame, between);
  $_log_(between, phi);
  for (j = 0; j < 3; ++j) {
    part[j] = gate * phi[j];
    apart[j] = near_frame[9 + j] - far_frame[9 + j];
  }
  $_exp_(part, turn);
  if (near_J && far_J) {
    $_left_inverse_(phi, inverse);
    $_left_(part, left);
    for (k = 0; k < $$_JOINTS; ++k) {
      double *linear = far_J + 6 * k, *angular = linear + 3;
      for (j = 0; j < 3; ++j) linear[j] += gate * (near_J[6 * k + j] - linear[j]) + apart[j] * slope[k];
      $_rotate_(between, angular, v);
      for (j = 0; j < 3; ++j) v[j] = near_J[6 * k + 3 + j] - v[j];
      $_rotate_(inverse, v, v);
      for (j = 0; j < 3; ++j) v[j] = gate * v[j] + phi[j] * slope[k];
      $_rotate_(left, v, v);
      $_rotate_(turn, angular, angular);
      for (j = 0; j < 3; ++j) angular[j] += v[j];
    }
  }
  $_product_(turn, far_frame, rotated);
  for (j = 0; j < 9; ++j) far_frame[j] = rotated[j];
  for (j = 0; j < 3; ++j) far_frame[9 + j] += gate * apart[j];
}
@end
@if learned

static inline void $_accumulate_(int first, double factor, const double *terms, double *sums) {
  int j;
  if (first)
    for (j = 0; j < $$_FEATURES_; ++j) sums[j] = factor * terms[j];
  else
    for (j = 0; j < $$_FEATURES_; ++j) sums[j] += factor * terms[j];
}

/* The learned position error, and its derivative as columns of three; 0 for none. */
static inline void $_learned_(const double *q, double *y, double *slope) {
  double x[$$_FEATURES_], gradient[3 * $$_FEATURES_];
  int i, j, k, o;
@if sines
  double c[$$_JOINTS], s[$$_JOINTS];
  for (i = 0; i < $$_JOINTS; ++i) {
    c[i] = cos(q[i]);
    s[i] = sin(q[i]);
  }
@end
@if map_raw
  for (i = 0; i < $$_JOINTS; ++i) x[i] = q[i];
@end
@if map_sines_and_cosines
  for (i = 0; i < $$_JOINTS; ++i) {
    x[i] = s[i];
    x[$$_JOINTS + i] = c[i];
  }
@end
@if map_products
  for (i = $$_JOINTS - 1, k = 0; i >= 0; --i)
    for (o = 0; o < 2; ++o) {
      const double factor = o ? c[i] : s[i];
      x[k++] = factor;
      for (j = $$_JOINTS - 1; j > i; --j) {
        x[k++] = factor * s[j];
        x[k++] = factor * c[j];
      }
    }
@end
  for (j = 0; j < $$_FEATURES_; ++j) x[j] = (x[j] - $_feature_offset_[j]) * $_feature_factor_[j];
  for (o = 0; o < 3; ++o) y[o] = $_output_offset_[o];
  for (k = 0; k < $$_NODES_; ++k) { /* weights, bias, three output weights */
    const double *w = $_nodes_ + k * ($$_FEATURES_ + 4), bias = w[$$_FEATURES_], *beta = w + $$_FEATURES_ + 1;
    double z = 0, dz;
@if radial_basis
    double apart[$$_FEATURES_];
    for (j = 0; j < $$_FEATURES_; ++j) {
      apart[j] = x[j] - w[j];
      z += apart[j] * apart[j];
    }
    z = exp(-bias * bias * z);
    dz = -2 * bias * bias * z;
    w = apart;
@end
@if !radial_basis
    for (j = 0; j < $$_FEATURES_; ++j) z += w[j] * x[j];
    z += bias;
@end
@if sigmoid
    z = 1 / (1 + exp(-z));
    dz = z * (1 - z);
@end
@if tanh
    z = tanh(z);
    dz = 1 - z * z;
@end
@if sine
    dz = cos(z);
    z = sin(z);
@end
    for (o = 0; o < 3; ++o) {
      y[o] += beta[o] * z;
      if (slope) $_accumulate_(k == 0, beta[o] * dz, w, gradient + o * $$_FEATURES_);
    }
  }
  if (!slope) return;
  for (o = 0; o < 3; ++o) {
    double *g = gradient + o * $$_FEATURES_;
    for (j = 0; j < $$_FEATURES_; ++j) g[j] *= $_feature_factor_[j];
@if map_raw
    for (i = 0; i < $$_JOINTS; ++i) slope[3 * i + o] = g[i];
@end
@if map_sines_and_cosines
    for (i = 0; i < $$_JOINTS; ++i) slope[3 * i + o] = g[i] * c[i] - g[$$_JOINTS + i] * s[i];
@end
@if map_products
    for (i = $$_JOINTS - 1; i >= 0; --i) {
      double sum = 0;
      for (k = 0; k < 2; ++k) {
        const double factor = k ? c[i] : s[i], rate = k ? -s[i] : c[i];
        double of_rate = *g++;
        for (j = $$_JOINTS - 1; j > i; --j, g += 2) {
          of_rate += g[0] * s[j] + g[1] * c[j];
          slope[3 * j + o] += factor * (g[0] * c[j] - g[1] * s[j]);
        }
        sum += of_rate * rate;
      }
      slope[3 * i + o] = sum;
    }
@end
  }
}
@end

/* The arm with everything. */
static inline void $_at_(const double *q, const double *previous, double *frame, double *J) {
@if fallback
  double slope[$$_JOINTS], near_frame[12], columns[6 * $$_JOINTS], *near_J = J ? columns : 0;
  const double gate = $_gate_at_(&$_coverage_of_model_, q, slope);
  if (gate >= 1) {
    $_arm_at_(&$_identified_, q, previous, frame, J);
  } else {
    $_arm_at_(&$_outside_, q, previous, frame, J);
    if (!(gate <= 0)) {
      $_arm_at_(&$_identified_, q, previous, near_frame, near_J);
      $_blend_(gate, slope, near_frame, near_J, frame, J);
    }
  }
@end
@if !fallback
  $_arm_at_(&$_identified_, q, previous, frame, J);
@end
@if learned
  {
    double gradient[$$_JOINTS], error[3], rate[3 * $$_JOINTS];
    const double share = $_gate_at_(&$_coverage_of_learned_, q, gradient);
    int i, j;
    if (share == 0) return;
    $_learned_(q, error, J ? rate : 0);
    for (j = 0; j < 3; ++j) frame[9 + j] -= share * error[j];
    for (i = 0; J && i < $$_JOINTS; ++i)
      for (j = 0; j < 3; ++j) J[6 * i + j] -= share * rate[3 * i + j] + error[j] * gradient[i];
  }
@end
}

$$_API void $_pose(const double q[$$_JOINTS], const double *previous, double T[12]) {
  double frame[12];
  $_at_(q, previous, frame, 0);
  $_to_rows_(frame, T);
}

$$_API void $_nominal_pose(const double q[$$_JOINTS], double T[12]) {
  double end[12], frame[12];
  $_links_ links;
  $_identity_(end);
  $_walk_($_nominal_rows_, q, end, &links);
  $_into_frames_($_identified_.base, $_identified_.tool, end, frame);
  $_to_rows_(frame, T);
}

$$_API void $_jacobian(const double q[$$_JOINTS], const double *previous, double J[6 * $$_JOINTS]) {
  double frame[12], columns[6 * $$_JOINTS];
  int i, k;
  $_at_(q, previous, frame, columns);
  for (i = 0; i < 6; ++i)
    for (k = 0; k < $$_JOINTS; ++k) J[i * $$_JOINTS + k] = columns[6 * k + i];
}

$$_API double $_gate(const double q[$$_JOINTS]) {
  double gate = 1;
@if fallback
  const double of_model = $_gate_at_(&$_coverage_of_model_, q, 0);
  if (of_model < gate) gate = of_model;
@end
@if learned
  {
    const double of_learned = $_gate_at_(&$_coverage_of_learned_, q, 0);
    if (of_learned < gate) gate = of_learned;
  }
@end
@if !gates
  (void)q;
@end
  return gate;
}
)C";

inline constexpr std::string_view c_correction = R"C(
/* ---- correction: Levenberg-Marquardt whose damping is proportional to the squared error ---- */

typedef struct {
  double q[$$_JOINTS], J[6 * $$_JOINTS], error[6]; /* rotations in units of length */
  double position, rotation, cost;
} $_iterate_;

static inline double $_dot6_(const double *a, const double *b) {
  return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5]);
}

static inline double $_within_(double q, int joint) {
  const double *limit = $_limits_ + 2 * joint;
  const double above = q < limit[0] ? limit[0] : q;
  return limit[1] < above ? limit[1] : above;
}

static inline void $_evaluate_(const double *target, const double *previous, $_iterate_ *at) {
  double frame[12], rotation[3] = {0, 0, 0};
  int j, k;
  $_at_(at->q, previous, frame, at->J);
@if oriented
  {
    double between[9];
    $_between_(target, frame, between);
    $_log_(between, rotation);
  }
@end
  for (j = 0; j < 3; ++j) {
    at->error[j] = target[9 + j] - frame[9 + j];
    at->error[3 + j] = $$_ROTATION_LENGTH_ * rotation[j];
  }
  at->position = sqrt($_dot_(at->error, at->error));
  at->rotation = sqrt($_dot_(rotation, rotation));
  at->cost = $_dot6_(at->error, at->error);
  for (k = 0; k < $$_JOINTS; ++k)
    for (j = 3; j < 6; ++j) at->J[6 * k + j] *= $$_ROTATION_LENGTH_;
}

/* Solves a x = b, a symmetric, its lower triangle by columns; x replaces b, a is lost. */
static inline void $_solve_(double *a, double *b) {
  int i, j, k;
  for (j = 0; j < $$_JOINTS; ++j) {
    double *column = a + j * $$_JOINTS, inverse;
    for (k = 0; k < j; ++k) {
      const double *before = a + k * $$_JOINTS;
      const double factor = before[j] * before[k];
      for (i = j; i < $$_JOINTS; ++i) column[i] -= factor * before[i];
    }
    inverse = 1 / column[j];
    for (i = j + 1; i < $$_JOINTS; ++i) column[i] *= inverse;
    for (i = j + 1; i < $$_JOINTS; ++i) b[i] -= column[i] * b[j];
  }
  for (j = $$_JOINTS - 1; j >= 0; --j) {
    const double *column = a + j * $$_JOINTS;
    double sum = b[j] / column[j];
    for (i = j + 1; i < $$_JOINTS; ++i) sum -= column[i] * b[i];
    b[j] = sum;
  }
}

static inline int $_search_(const double *target, const double *previous, $_iterate_ **best, $_iterate_ *next) {
  double normal[$$_JOINTS * $$_JOINTS], damped[$$_JOINTS * $$_JOINTS], gradient[$$_JOINTS], step[$$_JOINTS];
  double damping = 1e-3;
  int i, j, k, evaluations = 1;
  $_evaluate_(target, previous, *best);
  if (!((*best)->cost - (*best)->cost == 0)) return $$_STALLED; /* not finite */
  while (!((*best)->position <= $$_POSITION_TOLERANCE && (*best)->rotation <= $$_ROTATION_TOLERANCE)) {
    double trace = 0, scale, square = 0, least;
    for (j = 0; j < $$_JOINTS; ++j) {
      const double *of_j = (*best)->J + 6 * j;
      for (i = j; i < $$_JOINTS; ++i) normal[j * $$_JOINTS + i] = $_dot6_((*best)->J + 6 * i, of_j);
      gradient[j] = $_dot6_(of_j, (*best)->error);
      trace += normal[j * $$_JOINTS + j];
    }
    scale = trace > 1e-12 ? trace : 1e-12;
    for (i = 0; i < $$_JOINTS; ++i) {
      const double *limit = $_limits_ + 2 * i, q = (*best)->q[i];
      if ((q <= limit[0] && gradient[i] < 0) || (q >= limit[1] && gradient[i] > 0)) { /* held by its limit */
        gradient[i] = 0;
        for (k = 0; k < i; ++k) normal[k * $$_JOINTS + i] = 0;
        for (k = i; k < $$_JOINTS; ++k) normal[i * $$_JOINTS + k] = k == i ? 1 : 0;
      }
      square += gradient[i] * gradient[i];
    }
    least = 1e-3 * sqrt(scale * (*best)->cost);
    if (0.1 * (*best)->cost < least) least = 0.1 * (*best)->cost;
    if (sqrt(square) <= least) return $$_LIMITS; /* nothing to gain in any direction */
    for (;;) {
      double shorten = 1;
      if (evaluations >= $$_EVALUATIONS_ || damping > 1e12) return $$_STALLED;
      for (j = 0; j < $$_JOINTS; ++j) {
        for (i = j; i < $$_JOINTS; ++i) damped[j * $$_JOINTS + i] = normal[j * $$_JOINTS + i];
        damped[j * $$_JOINTS + j] += damping * (*best)->cost + 1e-14 * scale;
        step[j] = gradient[j];
      }
      $_solve_(damped, step);
      square = 0;
      for (i = 0; i < $$_JOINTS; ++i) square += step[i] * step[i];
      if (1.5 / sqrt(square) < 1) shorten = 1.5 / sqrt(square); /* no needless turns near a singularity */
      for (i = 0; i < $$_JOINTS; ++i) next->q[i] = $_within_((*best)->q[i] + shorten * step[i], i);
      $_evaluate_(target, previous, next);
      ++evaluations;
      if (next->cost < (*best)->cost) {
        $_iterate_ *better = next;
        next = *best;
        *best = better;
        damping = damping / 8 > 1e-9 ? damping / 8 : 1e-9;
        break;
      }
      damping = damping * 8 > 1e-9 ? damping * 8 : 1e-9;
    }
  }
  return $$_MET;
}

$$_API int $_correct(const double T[12], const double seed[$$_JOINTS], const double *previous, double q[$$_JOINTS],
                     double *error) {
  double target[12];
  $_iterate_ one, other, *best = &one;
  int i, status;
  $_to_columns_(T, target);
  for (i = 0; i < $$_JOINTS; ++i) one.q[i] = $_within_(seed[i], i);
  status = $_search_(target, previous, &best, &other);
  for (i = 0; i < $$_JOINTS; ++i) q[i] = best->q[i];
  if (error) *error = best->position;
  return status;
}
)C";

VERNIER_IMPL std::string c_functions() {
  std::string out;
  for (const std::string_view part : {c_vectors, c_chain, c_joint_errors, c_arm, c_correction}) out += part;
  return out;
}

}  // namespace vernier::detail
