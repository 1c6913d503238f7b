R"c(
/* ---- vectors, rotations (nine numbers, column by column) ---- */

static inline double arm_dot_(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void arm_cross_(const double *a, const double *b, double *out) {
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  out[0] = x;
  out[1] = y;
  out[2] = z;
}
#if HAS_TORQUES

static inline double arm_triple_(const double *a, const double *b, const double *c) {
  double bc[3];
  arm_cross_(b, c, bc);
  return arm_dot_(a, bc);
}
#endif

static inline void arm_rotate_(const double *R, const double *v, double *out) {
  const double x = v[0], y = v[1], z = v[2];
  int k;
  for (k = 0; k < 3; ++k) out[k] = R[k] * x + R[3 + k] * y + R[6 + k] * z;
}

static inline void arm_product_(const double *A, const double *B, double *out) {
  int j;
  for (j = 0; j < 9; j += 3) arm_rotate_(A, B + j, out + j);
}
#if HAS_LOG

/* A B' */
static inline void arm_between_(const double *A, const double *B, double *out) {
  int i, j;
  for (j = 0; j < 3; ++j)
    for (i = 0; i < 3; ++i) out[3 * j + i] = A[i] * B[j] + A[3 + i] * B[3 + j] + A[6 + i] * B[6 + j];
}

static inline void arm_log_(const double *R, double *r) {
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
  square = arm_dot_(v, v);
  if (square < 1e-8) {
    factor = 2 / w * (1 - square / (3 * w * w));
  } else {
    t = sqrt(square);
    factor = 2 * atan2(t, w) / t;
  }
  for (i = 0; i < 3; ++i) r[i] = factor * v[i];
}
#endif
#if HAS_EXP

/* 1 + a [r] + b [r] [r], [r] v = r x v */
static inline void arm_series_(double a, double b, const double *r, double *out) {
  const double square = arm_dot_(r, r);
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

static inline void arm_exp_(const double *r, double *R) {
  const double square = arm_dot_(r, r);
  if (square < 1e-8) {
    arm_series_(1 - square / 6 + square * square / 120, 0.5 - square / 24 + square * square / 720, r, R);
  } else {
    const double angle = sqrt(square), half = sin(angle / 2);
    arm_series_(sin(angle) / angle, 2 * half * half / square, r, R);
  }
}

/* From the rate of a rotation vector to the angular velocity. */
static inline void arm_left_(const double *r, double *out) {
  const double square = arm_dot_(r, r);
  if (square < 1e-4) {
    arm_series_(0.5 - square / 24 + square * square / 720, 1.0 / 6 - square / 120 + square * square / 5040, r, out);
  } else {
    const double angle = sqrt(square), half = sin(angle / 2);
    arm_series_(2 * half * half / square, (angle - sin(angle)) / (square * angle), r, out);
  }
}
#endif
#if HAS_FALLBACK

/* And back. */
static inline void arm_left_inverse_(const double *r, double *out) {
  const double square = arm_dot_(r, r);
  if (square < 1e-4) {
    arm_series_(-0.5, 1.0 / 12 + square / 720 + square * square / 30240, r, out);
  } else {
    const double half = sqrt(square) / 2;
    arm_series_(-0.5, (1 - half * cos(half) / sin(half)) / square, r, out);
  }
}
#endif
)c"
