R"c(
/* ---- correction: Levenberg-Marquardt whose damping is proportional to the squared error ---- */

typedef struct {
  double q[ARM_JOINTS], J[6 * ARM_JOINTS], error[6]; /* rotations in units of length */
  double position, rotation, cost;
} arm_iterate_;

static inline double arm_dot6_(const double *a, const double *b) {
  return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5]);
}

static inline double arm_within_(double q, int joint) {
  const double *limit = arm_limits_ + 2 * joint;
  const double above = q < limit[0] ? limit[0] : q;
  return limit[1] < above ? limit[1] : above;
}

static inline void arm_evaluate_(const double *target, const double *previous, arm_iterate_ *at) {
  double frame[12], rotation[3] = {0, 0, 0};
  int j, k;
  arm_at_(at->q, previous, frame, at->J);
#if HAS_ORIENTED
  {
    double between[9];
    arm_between_(target, frame, between);
    arm_log_(between, rotation);
  }
#endif
  for (j = 0; j < 3; ++j) {
    at->error[j] = target[9 + j] - frame[9 + j];
    at->error[3 + j] = ARM_ROTATION_LENGTH_ * rotation[j];
  }
  at->position = sqrt(arm_dot_(at->error, at->error));
  at->rotation = sqrt(arm_dot_(rotation, rotation));
  at->cost = arm_dot6_(at->error, at->error);
  for (k = 0; k < ARM_JOINTS; ++k)
    for (j = 3; j < 6; ++j) at->J[6 * k + j] *= ARM_ROTATION_LENGTH_;
}

/* Solves a x = b, a symmetric, its lower triangle by columns; x replaces b, a is lost. */
static inline void arm_solve_(double *a, double *b) {
  int i, j, k;
  for (j = 0; j < ARM_SIZE_; ++j) {
    double *column = a + j * ARM_SIZE_, inverse;
    for (k = 0; k < j; ++k) {
      const double *before = a + k * ARM_SIZE_;
      const double factor = before[j] * before[k];
      for (i = j; i < ARM_SIZE_; ++i) column[i] -= factor * before[i];
    }
    inverse = 1 / column[j];
    for (i = j + 1; i < ARM_SIZE_; ++i) column[i] *= inverse;
    for (i = j + 1; i < ARM_SIZE_; ++i) b[i] -= column[i] * b[j];
  }
  for (j = ARM_SIZE_ - 1; j >= 0; --j) {
    const double *column = a + j * ARM_SIZE_;
    double sum = b[j] / column[j];
    for (i = j + 1; i < ARM_SIZE_; ++i) sum -= column[i] * b[i];
    b[j] = sum;
  }
}

static inline int arm_search_(const double *target, const double *previous, arm_iterate_ **best, arm_iterate_ *next) {
  double normal[ARM_SIZE_ * ARM_SIZE_], damped[ARM_SIZE_ * ARM_SIZE_], gradient[ARM_JOINTS], step[ARM_JOINTS], x[ARM_SIZE_];
  double damping = 1e-3;
  int held[ARM_JOINTS], i, j, evaluations = 1;
#if HAS_REDUNDANT
  int k;
#endif
  arm_evaluate_(target, previous, *best);
  if (!((*best)->cost - (*best)->cost == 0)) return ARM_STALLED; /* not finite */
  while (!((*best)->position <= ARM_POSITION_TOLERANCE && (*best)->rotation <= ARM_ROTATION_TOLERANCE)) {
    double trace = 0, scale, square = 0, least;
    for (j = 0; j < ARM_JOINTS; ++j) {
      const double *limit = arm_limits_ + 2 * j, *of_j = (*best)->J + 6 * j, q = (*best)->q[j];
      gradient[j] = arm_dot6_(of_j, (*best)->error);
      trace += arm_dot6_(of_j, of_j);
      held[j] = (q <= limit[0] && gradient[j] < 0) || (q >= limit[1] && gradient[j] > 0); /* by its limit */
      if (held[j]) gradient[j] = 0;
      square += gradient[j] * gradient[j];
    }
    scale = trace > 1e-12 ? trace : 1e-12;
#if HAS_REDUNDANT
    for (k = 0; k < ARM_SIZE_ * ARM_SIZE_; ++k) normal[k] = 0; /* J J': J' J is singular with fewer equations than joints */
    for (j = 0; j < ARM_JOINTS; ++j) {
      const double *of_j = (*best)->J + 6 * j;
      if (held[j]) continue;
      for (k = 0; k < ARM_SIZE_; ++k)
        for (i = k; i < ARM_SIZE_; ++i) normal[k * ARM_SIZE_ + i] += of_j[i] * of_j[k];
    }
#else
    for (j = 0; j < ARM_JOINTS; ++j)
      for (i = j; i < ARM_JOINTS; ++i)
        normal[j * ARM_SIZE_ + i] =
            held[i] || held[j] ? (i == j ? 1 : 0) : arm_dot6_((*best)->J + 6 * i, (*best)->J + 6 * j);
#endif
    least = 1e-3 * sqrt(scale * (*best)->cost);
    if (0.1 * (*best)->cost < least) least = 0.1 * (*best)->cost;
    if (sqrt(square) <= least) return ARM_LIMITS; /* nothing to gain in any direction */
    for (;;) {
      double shorten = 1;
      if (evaluations >= ARM_EVALUATIONS_ || damping > 1e12) return ARM_STALLED;
      for (j = 0; j < ARM_SIZE_; ++j) {
        for (i = j; i < ARM_SIZE_; ++i) damped[j * ARM_SIZE_ + i] = normal[j * ARM_SIZE_ + i];
        damped[j * ARM_SIZE_ + j] += damping * (*best)->cost + 1e-14 * scale;
#if HAS_REDUNDANT
        x[j] = (*best)->error[j];
#else
        x[j] = gradient[j];
#endif
      }
      arm_solve_(damped, x);
      for (j = 0; j < ARM_JOINTS; ++j) {
#if HAS_REDUNDANT
        step[j] = 0;
        for (k = 0; k < ARM_SIZE_ && !held[j]; ++k) step[j] += x[k] * (*best)->J[6 * j + k];
#else
        step[j] = held[j] ? 0 : x[j];
#endif
      }
      square = 0;
      for (i = 0; i < ARM_JOINTS; ++i) square += step[i] * step[i];
      if (1.5 / sqrt(square) < 1) shorten = 1.5 / sqrt(square); /* no needless turns near a singularity */
      for (i = 0; i < ARM_JOINTS; ++i) next->q[i] = arm_within_((*best)->q[i] + shorten * step[i], i);
      arm_evaluate_(target, previous, next);
      ++evaluations;
      if (next->cost < (*best)->cost) {
        arm_iterate_ *better = next;
        next = *best;
        *best = better;
        damping = damping / 8 > 1e-9 ? damping / 8 : 1e-9;
        break;
      }
      damping = damping * 8 > 1e-9 ? damping * 8 : 1e-9;
    }
  }
  return ARM_MET;
}

ARM_API int arm_correct(const double T[12], const double seed[ARM_JOINTS], const double *previous, double q[ARM_JOINTS],
                     double *error) {
  double target[12];
  arm_iterate_ one, other, *best = &one;
  int i, status;
  arm_to_columns_(T, target);
  for (i = 0; i < ARM_JOINTS; ++i) one.q[i] = arm_within_(seed[i], i);
  status = arm_search_(target, previous, &best, &other);
  for (i = 0; i < ARM_JOINTS; ++i) q[i] = best->q[i];
  if (error) *error = best->position;
  return status;
}
)c"
