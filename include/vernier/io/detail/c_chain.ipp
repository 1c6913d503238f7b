#pragma once

#include "vernier/io/detail/c_chain.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string_view c_vector_code() {
  return R"C(
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
}

VERNIER_IMPL std::string_view c_chain_code() {
  return R"C(
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
}

}  // namespace vernier::detail
