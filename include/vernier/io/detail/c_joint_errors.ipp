#pragma once

#include "vernier/io/detail/c_joint_errors.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string_view c_joint_error_code() {
  return R"C(
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
)C";
}

}  // namespace vernier::detail
