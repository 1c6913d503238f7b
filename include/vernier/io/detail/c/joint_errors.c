R"c(
/* ---- errors of the joints. Derivatives `rate` are ARM_CHAIN_ x ARM_CHAIN_, a column a commanded joint; 0 for none ---- */
#if HAS_MOTORS

/* Angles of the motors, whose gears err, from joint values of the chain. */
static inline void arm_to_motors_(const double *q, double *angles) {
  int i, j;
  for (j = 0; j < ARM_CHAIN_; ++j) {
    angles[j] = arm_motor_zeros_[j];
    for (i = 0; i < ARM_CHAIN_; ++i)
      if (arm_motor_angles_[j * ARM_CHAIN_ + i] != 0) angles[j] += arm_motor_angles_[j * ARM_CHAIN_ + i] * q[i];
  }
}

/* Adds what errors of the motors do to the joints. */
static inline void arm_add_motors_(const double *errors, const double *rates, double *joints, double *rate) {
  int i, j, k, m;
  for (i = 0; i < ARM_CHAIN_; ++i)
    for (j = 0; j < ARM_CHAIN_; ++j) {
      const double moved = arm_motor_effects_[i * ARM_CHAIN_ + j];
      if (moved == 0) continue;
      joints[i] += moved * errors[j];
      for (k = 0; rate && k < ARM_CHAIN_; ++k)
        for (m = 0; m < ARM_CHAIN_; ++m)
          rate[m * ARM_CHAIN_ + i] += moved * rates[k * ARM_CHAIN_ + j] * arm_motor_angles_[k * ARM_CHAIN_ + m];
    }
}
#endif
#if HAS_LINEAR

static inline double arm_linear_(const arm_arm_ *arm, int joint, double q) {
  const double *range = arm->linear_ranges;
  if (!range) return q;
  range += 2 * joint;
  return q < range[0] ? range[0] : q > range[1] ? range[1] : q;
}

/* Error of the gear ratio of each joint; coupling of each joint, from the second, by the one before. */
static inline void arm_add_linear_(const arm_arm_ *arm, const double *q, double *joints, double *rate) {
  const double *gear = arm->terms[ARM_GEAR_RATIO_].of, *coupling = arm->terms[ARM_COUPLING_].of;
  int i, from;
  for (i = 0; i < ARM_CHAIN_; ++i)
    for (from = i; from >= 0 && from >= i - 1; --from) {
      const double *of = from == i ? gear : coupling; /* its place among these is `from` */
      const double linear = arm_linear_(arm, from, q[from]);
      if (!of) continue;
      joints[i] += of[from] * linear;
      if (rate && linear == q[from]) rate[from * ARM_CHAIN_ + i] += of[from];
    }
}
#endif
#if HAS_GRAVITY

/* Torques of the links' weights: of joint i under link j >= i [rad/m], by the direction of gravity. */
static inline void arm_add_gravity_(const arm_arm_ *arm, const arm_links_ *links, double *joints, double *rate) {
  const double *down = arm->terms[ARM_GRAVITY_].parameters, *weight = arm->terms[ARM_GRAVITY_].of;
  int i, j, k;
  for (i = 0; i < ARM_CHAIN_; ++i) {
    const double *axis = links->axis + 3 * i;
    double sum[3] = {0, 0, 0}, lever[3], turned[3], total = 0;
    for (k = ARM_CHAIN_ - 1; k >= i; --k) { /* the links from k on */
      total += weight[k - i];
      for (j = 0; j < 3; ++j) {
        sum[j] += weight[k - i] * links->end[3 * k + j];
        lever[j] = sum[j] - total * links->point[3 * k + j];
      }
#if HAS_PRISMATIC
      if (arm_prismatic_[i]) continue;
      if (arm_prismatic_[k]) {
        if (rate) rate[k * ARM_CHAIN_ + i] += total * arm_triple_(axis, links->axis + 3 * k, down);
        continue;
      }
#endif
      arm_cross_(links->axis + 3 * k, lever, turned);
      if (rate) rate[k * ARM_CHAIN_ + i] += arm_triple_(axis, turned, down);
    }
    weight += ARM_CHAIN_ - i;
#if HAS_PRISMATIC
    if (arm_prismatic_[i]) {
      joints[i] += total * arm_dot_(axis, down);
      for (k = 0; rate && k < i; ++k) {
        if (arm_prismatic_[k]) continue;
        arm_cross_(links->axis + 3 * k, axis, turned);
        rate[k * ARM_CHAIN_ + i] += total * arm_dot_(turned, down);
      }
      continue;
    }
#endif
    joints[i] += arm_triple_(axis, lever, down);
    for (k = 0; rate && k < i; ++k) {
      const double *turn = links->axis + 3 * k;
#if HAS_PRISMATIC
      if (arm_prismatic_[k]) continue;
#endif
      arm_cross_(turn, axis, turned);
      rate[k * ARM_CHAIN_ + i] += arm_triple_(turned, lever, down);
      arm_cross_(turn, lever, turned);
      rate[k * ARM_CHAIN_ + i] += arm_triple_(axis, turned, down);
    }
  }
}
#endif
#if HAS_PAYLOAD

/* Torques of what is carried at the end of the nominal chain. Parameters: the direction of gravity, mass and centre of
 * the payload while measuring; then weight [N] and moment in the frame of the flange [N m] beyond that. */
static inline void arm_add_payload_(const arm_arm_ *arm, const arm_links_ *links, const double *end, double *joints,
                                  double *rate) {
  const double *down = arm->terms[ARM_PAYLOAD_].parameters, *load = down + 7;
  const double weight = load[0];
  double moment[3];
  int i, j, k;
  arm_rotate_(end, load + 1, moment);
  for (j = 0; j < 3; ++j) moment[j] += weight * end[9 + j];
  for (i = 0; i < ARM_CHAIN_; ++i) {
    const double c = arm->terms[ARM_PAYLOAD_].of[i], *axis = links->axis + 3 * i;
    double lever[3], about[3], turned[3];
    for (j = 0; j < 3; ++j) lever[j] = moment[j] - weight * links->point[3 * i + j];
#if HAS_PRISMATIC
    if (arm_prismatic_[i]) {
      joints[i] += c * weight * arm_dot_(axis, down);
      for (k = 0; rate && k < i; ++k) {
        if (arm_prismatic_[k]) continue;
        arm_cross_(links->axis + 3 * k, axis, turned);
        rate[k * ARM_CHAIN_ + i] += c * weight * arm_dot_(turned, down);
      }
      continue;
    }
#endif
    joints[i] += c * arm_triple_(axis, lever, down);
    for (k = 0; rate && k < ARM_CHAIN_; ++k) {
      const double *turn = links->axis + 3 * k;
      double *slope = rate + k * ARM_CHAIN_ + i;
#if HAS_PRISMATIC
      if (arm_prismatic_[k]) {
        if (k > i) *slope += c * weight * arm_triple_(axis, turn, down);
        continue;
      }
#endif
      for (j = 0; j < 3; ++j) about[j] = moment[j] - weight * links->point[3 * (k < i ? i : k) + j];
      arm_cross_(turn, about, turned);
      *slope += c * arm_triple_(axis, turned, down);
      if (k >= i) continue;
      arm_cross_(turn, axis, turned);
      *slope += c * arm_triple_(turned, lever, down);
    }
  }
}
#endif
#if HAS_HYSTERESIS

/* Hysteresis: of each width a coefficient a joint. */
static inline void arm_add_hysteresis_(const arm_arm_ *arm, const double *q, const double *previous, double *joints,
                                     double *rate) {
  const arm_terms_ *terms = arm->terms + ARM_HYSTERESIS_;
  int i, w;
  if (!previous) return;
  for (w = 0; w < terms->count; ++w) {
    const double *of = terms->of + w * ARM_CHAIN_, width = terms->parameters[w];
    for (i = 0; i < ARM_CHAIN_; ++i) {
      double step;
      if (!(previous[i] - previous[i] == 0)) continue; /* unknown */
      step = tanh((q[i] - previous[i]) / width);
      joints[i] += of[i] * step;
      if (rate && step != 0) rate[i * ARM_CHAIN_ + i] += of[i] * (1 - step * step) / width;
    }
  }
}
#endif
#if HAS_TRANSMISSION

/* Turns unit vectors on by others, or by themselves. */
static inline void arm_turn_all_(double *c, double *s, const double *by_c, const double *by_s) {
  int i;
  for (i = 0; i < ARM_LANES_; ++i) {
    const double next = c[i] * by_c[i] - s[i] * by_s[i];
    s[i] = s[i] * by_c[i] + c[i] * by_s[i];
    c[i] = next;
  }
}

/* Functions of single joints, all joints side by side: the unit vector of each angle is turned from order to order. */
static inline void arm_add_harmonics_(const arm_arm_ *arm, const double *q, double *joints, double *rate) {
  double c1[ARM_LANES_], s1[ARM_LANES_], c[ARM_LANES_], s[ARM_LANES_], value[ARM_LANES_], slope[ARM_LANES_];
  const double *of = arm->harmonics;
  int i, k, order = 0;
  for (i = 0; i < ARM_LANES_; ++i) {
    const double angle = i < ARM_CHAIN_ ? q[i] : 0;
    c1[i] = cos(angle);
    s1[i] = sin(angle);
    c[i] = 1;
    s[i] = value[i] = slope[i] = 0;
  }
  for (k = 0; k < arm->orders; ++k, of += 2 * ARM_LANES_) {
    const double at = arm->order[k];
    int gap = arm->order[k] - order; /* c and s are those of `order` */
    if (gap > 0) {
      double cp[ARM_LANES_], sp[ARM_LANES_];
      for (i = 0; i < ARM_LANES_; ++i) {
        cp[i] = c1[i];
        sp[i] = s1[i];
      }
      for (; gap > 0; gap >>= 1) { /* powers of two */
        if (gap & 1) arm_turn_all_(c, s, cp, sp);
        if (gap > 1) arm_turn_all_(cp, sp, cp, sp);
      }
    }
    order = arm->order[k] + 1;
    for (i = 0; i < ARM_LANES_; ++i) {
      const double a = of[i], b = of[ARM_LANES_ + i], cosine = c[i], sine = s[i];
      value[i] += a * cosine + b * sine;
      slope[i] += at * (b * cosine - a * sine);
      c[i] = cosine * c1[i] - sine * s1[i];
      s[i] = sine * c1[i] + cosine * s1[i];
    }
  }
  for (i = 0; i < ARM_CHAIN_; ++i) {
    joints[i] += value[i];
    if (rate) rate[i * ARM_CHAIN_ + i] += slope[i];
  }
}
#endif
#if HAS_MOTION

/* Adds the motion of the arm's end by a small turn about a point. */
static inline void arm_add_turn_(const double *point, const double *by, double *shift, double *turn) {
  double moved[3];
  int j;
  arm_cross_(point, by, moved);
  for (j = 0; j < 3; ++j) {
    shift[j] += moved[j];
    turn[j] += by[j];
  }
}

/* Adds how the motion by a turn of joint i's frame changes where joint k moves this frame.
 * change: of the turn within the frame, overwritten */
static inline void arm_add_moved_turn_(const arm_links_ *links, int k, int i, const double *turn, double *change,
                                     double *rates) {
  const double *axis = links->axis + 3 * k, *origin = links->origin + 3 * i;
  double lever[3], v[3];
  int j;
  arm_cross_(axis, turn, v);
#if HAS_PRISMATIC
  if (arm_prismatic_[k]) {
    for (j = 0; j < 3; ++j) rates[6 * k + j] += v[j];
    return;
  }
#endif
  for (j = 0; j < 3; ++j) {
    change[j] += v[j];
    lever[j] = origin[j] - links->point[3 * k + j];
  }
  arm_cross_(axis, lever, v);
  arm_cross_(v, turn, v);
  for (j = 0; j < 3; ++j) rates[6 * k + j] += v[j];
  arm_add_turn_(origin, change, rates + 6 * k, rates + 6 * k + 3);
}
#endif
#if HAS_STRAIGHTNESS

/* Adds how prismatic joints depart from a straight motion: of each, cosines of x, y, z and of the rotations about them.
 * Parameters: the number of cosines, then the range of each. */
static inline void arm_add_guides_(const arm_arm_ *arm, const arm_links_ *links, const double *q, double *shift,
                                 double *turn, double *rates) {
  const arm_terms_ *terms = arm->terms + ARM_STRAIGHTNESS_;
  const double *c = terms->of, *range = terms->parameters + 1;
  const int orders = (int)terms->parameters[0];
  int i, j, k, m;
  for (i = 0; i < ARM_CHAIN_; ++i) {
    const double *axes[3], *origin = links->origin + 3 * i;
    double z[3], value[6], slope[6], moved[3] = {0, 0, 0}, turned[3] = {0, 0, 0}, moving[3] = {0, 0, 0};
    double turning[3] = {0, 0, 0}, rate, angle;
    if (!arm_prismatic_[i]) continue;
    arm_cross_(links->x + 3 * i, links->y + 3 * i, z);
    axes[0] = links->x + 3 * i;
    axes[1] = links->y + 3 * i;
    axes[2] = z;
    rate = 3.14159265358979323846 / (range[1] - range[0]);
    angle = rate * (q[i] - range[0]);
    if (q[i] <= range[0]) angle = rate = 0;
    if (q[i] >= range[1]) {
      angle = 3.14159265358979323846;
      rate = 0;
    }
    range += 2;
    for (m = 0; m < 6; ++m) {
      value[m] = slope[m] = 0;
      for (k = 1; k <= orders; ++k, ++c) {
        value[m] += *c * cos(k * angle);
        slope[m] -= *c * k * rate * sin(k * angle);
      }
    }
    for (m = 0; m < 3; ++m)
      for (j = 0; j < 3; ++j) {
        moved[j] += value[m] * axes[m][j];
        turned[j] += value[3 + m] * axes[m][j];
        moving[j] += slope[m] * axes[m][j];
        turning[j] += slope[3 + m] * axes[m][j];
      }
    for (j = 0; j < 3; ++j) shift[j] += moved[j];
    arm_add_turn_(origin, turned, shift, turn);
    if (!rates) continue;
    for (j = 0; j < 3; ++j) rates[6 * i + j] += moving[j];
    arm_add_turn_(origin, turning, rates + 6 * i, rates + 6 * i + 3);
    for (k = 0; k <= i; ++k) {
      double change[3] = {0, 0, 0}, swung[3];
      arm_add_moved_turn_(links, k, i, turned, change, rates);
      if (arm_prismatic_[k]) continue;
      arm_cross_(links->axis + 3 * k, moved, swung);
      for (j = 0; j < 3; ++j) rates[6 * k + j] += swung[j];
    }
  }
}
#endif
#if HAS_PAYLOAD_BEND

/* Adds how the joints' frames bend about their x and y axes under what is carried at the end of the nominal chain.
 * Parameters: those of the payload. */
static inline void arm_add_bends_(const arm_arm_ *arm, const arm_links_ *links, const double *carried, double *shift,
                                double *turn, double *rates) {
  const double *c = arm->terms[ARM_PAYLOAD_BEND_].of, *down = arm->terms[ARM_PAYLOAD_BEND_].parameters;
  const double *load = down + 7, weight = load[0];
  double moment[3];
  int i, j, k;
  arm_rotate_(carried, load + 1, moment);
  for (j = 0; j < 3; ++j) moment[j] += weight * carried[9 + j];
  for (i = 0; i < ARM_CHAIN_; ++i, c += 2) {
    const double *x = links->x + 3 * i, *y = links->y + 3 * i, *origin = links->origin + 3 * i;
    double bent[3] = {0, 0, 0};
    for (k = -1; k < (rates ? ARM_CHAIN_ : 0); ++k) { /* -1: the motion itself, else its change by joint k */
      const double *axis = links->axis + 3 * (k < 0 ? 0 : k);
      double lever[3], torque[3], pull[3], v[3], about_x, about_y;
      int slides = 0;
#if HAS_PRISMATIC
      slides = k >= 0 && arm_prismatic_[k];
#endif
      for (j = 0; j < 3; ++j) {
        lever[j] = moment[j] - weight * (k > i ? links->point[3 * k + j] : origin[j]);
        pull[j] = down[j];
      }
      if (k > i && slides)
        for (j = 0; j < 3; ++j) lever[j] = weight * axis[j];
      else if (k > i)
        arm_cross_(axis, lever, lever);
      else if (k >= 0) /* frame and load turn alike, against gravity */
        arm_cross_(down, axis, pull);
      arm_cross_(lever, pull, torque);
      about_x = c[0] * arm_dot_(x, torque);
      about_y = c[1] * arm_dot_(y, torque);
      for (j = 0; j < 3; ++j) v[j] = about_x * x[j] + about_y * y[j];
      if (k > i) {
        arm_add_turn_(origin, v, rates + 6 * k, rates + 6 * k + 3);
      } else if (k >= 0) {
        arm_add_moved_turn_(links, k, i, bent, v, rates);
      } else {
        for (j = 0; j < 3; ++j) bent[j] = v[j];
        arm_add_turn_(origin, bent, shift, turn);
      }
    }
  }
}
#endif
#if HAS_MOTION

/* Tilts and bends of the joints' frames, and guides: a motion of the arm's end in the base frame of the chain. */
static inline void arm_add_motion_(const arm_arm_ *arm, const arm_links_ *links, const double *carried, const double *q,
                                 double *end, double *J) {
  double shift[3] = {0, 0, 0}, turn[3] = {0, 0, 0}, rates[6 * ARM_CHAIN_], R[9], left[9], rotated[9], v[3], w[3];
  const double none = 0.0 * arm->orders; /* 0 that no compiler makes a call of memset */
  int j, k;
#if HAS_TILT
  const double *down = arm->terms[ARM_TILT_].parameters;
  int i;
#endif
  (void)q;
  (void)carried;
  for (k = 0; k < 6 * ARM_CHAIN_; ++k) rates[k] = none;
#if HAS_TILT
  for (i = 0; arm->terms[ARM_TILT_].of && i < ARM_CHAIN_; ++i) {
    const double *c = arm->terms[ARM_TILT_].of + 6 * i, *x = links->x + 3 * i, *y = links->y + 3 * i;
    const double *origin = links->origin + 3 * i;
    double z[3], tilted[3];
    arm_cross_(x, y, z);
    for (k = -1; k <= (J ? i : -1); ++k) { /* -1: the motion itself, else its change by joint k */
      double gravity[3], g[3], about_x, about_y;
      if (k < 0) {
        for (j = 0; j < 3; ++j) gravity[j] = down[j];
      } else {
        arm_cross_(down, links->axis + 3 * k, gravity);
      }
      g[0] = arm_dot_(x, gravity);
      g[1] = arm_dot_(y, gravity);
      g[2] = arm_dot_(z, gravity);
      about_x = arm_dot_(c, g);
      about_y = arm_dot_(c + 3, g);
      for (j = 0; j < 3; ++j) v[j] = about_x * x[j] + about_y * y[j];
      if (k >= 0) {
        arm_add_moved_turn_(links, k, i, tilted, v, rates);
      } else {
        for (j = 0; j < 3; ++j) tilted[j] = v[j];
        arm_add_turn_(origin, tilted, shift, turn);
      }
    }
  }
#endif
#if HAS_PAYLOAD_BEND
  if (arm->terms[ARM_PAYLOAD_BEND_].of) arm_add_bends_(arm, links, carried, shift, turn, J ? rates : 0);
#endif
#if HAS_STRAIGHTNESS
  if (arm->terms[ARM_STRAIGHTNESS_].of) arm_add_guides_(arm, links, q, shift, turn, J ? rates : 0);
#endif
  arm_exp_(turn, R);
  arm_product_(R, end, rotated);
  for (k = 0; k < 9; ++k) end[k] = rotated[k];
  arm_rotate_(R, end + 9, v); /* the end, turned */
  for (j = 0; j < 3; ++j) end[9 + j] = v[j] + shift[j];
  if (!J) return;
  arm_left_(turn, left);
  for (k = 0; k < ARM_CHAIN_; ++k) {
    double *linear = J + 6 * k, *angular = linear + 3, omega[3];
    arm_rotate_(left, rates + 6 * k + 3, omega);
    arm_rotate_(R, linear, linear);
    arm_rotate_(R, angular, angular);
    arm_cross_(omega, v, w);
    for (j = 0; j < 3; ++j) {
      linear[j] += w[j] + rates[6 * k + j];
      angular[j] += omega[j];
    }
  }
}
#endif

/* ---- the arm ---- */

/* base_T_tool as columns, and its Jacobian as columns of six; 0 for none. */
static inline void arm_arm_at_(const arm_arm_ *arm, const double *q, const double *previous, double *frame, double *J) {
  double joints[ARM_CHAIN_], rate[ARM_CHAIN_ * ARM_CHAIN_], end[12];
  arm_links_ links;
#if HAS_LINKS
  arm_links_ nominal;
  double carried[12]; /* the end of the nominal chain */
#endif
#if HAS_MOTORS
  double angles[ARM_CHAIN_], before[ARM_CHAIN_], errors[ARM_CHAIN_], rates[ARM_CHAIN_ * ARM_CHAIN_];
  const double *at = angles, *from = previous ? before : 0;
  double *erring = errors, *slopes = J ? rates : 0;
#else
  const double *at = q, *from = previous;
  double *erring = joints, *slopes = J ? rate : 0;
#endif
  int i, j, k;
  (void)from;
  (void)at;
  (void)erring;
  (void)slopes;
  for (k = 0; k < ARM_CHAIN_; ++k) {
    joints[k] = q[k];
    for (i = 0; i < ARM_CHAIN_; ++i) rate[k * ARM_CHAIN_ + i] = i == k ? 1 : 0;
  }
#if HAS_MOTORS
  arm_to_motors_(q, angles);
  if (previous) arm_to_motors_(previous, before);
  for (k = 0; k < ARM_CHAIN_; ++k) {
    errors[k] = 0;
    for (i = 0; i < ARM_CHAIN_; ++i) rates[k * ARM_CHAIN_ + i] = 0;
  }
#endif
#if HAS_LINKS
  arm_identity_(carried);
  arm_walk_(arm_nominal_rows_, q, carried, &nominal);
#endif
#if HAS_LINEAR
  arm_add_linear_(arm, at, erring, slopes);
#endif
#if HAS_GRAVITY
  if (arm->terms[ARM_GRAVITY_].of) arm_add_gravity_(arm, &nominal, joints, J ? rate : 0);
#endif
#if HAS_PAYLOAD
  if (arm->terms[ARM_PAYLOAD_].of) arm_add_payload_(arm, &nominal, carried, joints, J ? rate : 0);
#endif
#if HAS_HYSTERESIS
  arm_add_hysteresis_(arm, at, from, erring, slopes);
#endif
#if HAS_TRANSMISSION
  if (arm->orders) arm_add_harmonics_(arm, at, erring, slopes);
#endif
#if HAS_MOTORS
  arm_add_motors_(errors, rates, joints, J ? rate : 0);
#endif
  arm_identity_(end);
  arm_walk_(arm->rows, joints, end, &links);
  if (J) {
    double columns[6 * ARM_CHAIN_], lever[3];
    for (k = 0; k < ARM_CHAIN_; ++k) {
      double *column = columns + 6 * k;
      const double *axis = links.axis + 3 * k;
#if HAS_PRISMATIC
      if (arm_prismatic_[k]) {
        for (j = 0; j < 3; ++j) {
          column[j] = axis[j];
          column[3 + j] = 0;
        }
        continue;
      }
#endif
      for (j = 0; j < 3; ++j) {
        lever[j] = end[9 + j] - links.point[3 * k + j];
        column[3 + j] = axis[j];
      }
      arm_cross_(axis, lever, column);
    }
    for (k = 0; k < ARM_CHAIN_; ++k)
      for (j = 0; j < 6; ++j) {
        double sum = 0;
        for (i = 0; i < ARM_CHAIN_; ++i) sum += columns[6 * i + j] * rate[k * ARM_CHAIN_ + i];
        J[6 * k + j] = sum;
      }
  }
#if HAS_MOTION
  if (arm->terms[ARM_TILT_].of || arm->terms[ARM_PAYLOAD_BEND_].of || arm->terms[ARM_STRAIGHTNESS_].of)
    arm_add_motion_(arm, &nominal, carried, q, end, J);
#endif
  if (J) { /* from the flange to the tool point, from the chain's base to the base */
    double lever[3], moved[3];
    arm_rotate_(end, arm->tool + 9, lever);
    for (k = 0; k < ARM_CHAIN_; ++k) {
      double *linear = J + 6 * k, *angular = linear + 3;
      arm_cross_(angular, lever, moved);
      for (j = 0; j < 3; ++j) linear[j] += moved[j];
      arm_rotate_(arm->base, linear, linear);
      arm_rotate_(arm->base, angular, angular);
    }
  }
  arm_into_frames_(arm->base, arm->tool, end, frame);
}
)c"
