#pragma once

#include "vernier/io/detail/c_correction.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string_view c_arm_code() {
  return R"C(
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
}

VERNIER_IMPL std::string_view c_correction_code() {
  return R"C(
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
  for (j = 0; j < $$_SIZE_; ++j) {
    double *column = a + j * $$_SIZE_, inverse;
    for (k = 0; k < j; ++k) {
      const double *before = a + k * $$_SIZE_;
      const double factor = before[j] * before[k];
      for (i = j; i < $$_SIZE_; ++i) column[i] -= factor * before[i];
    }
    inverse = 1 / column[j];
    for (i = j + 1; i < $$_SIZE_; ++i) column[i] *= inverse;
    for (i = j + 1; i < $$_SIZE_; ++i) b[i] -= column[i] * b[j];
  }
  for (j = $$_SIZE_ - 1; j >= 0; --j) {
    const double *column = a + j * $$_SIZE_;
    double sum = b[j] / column[j];
    for (i = j + 1; i < $$_SIZE_; ++i) sum -= column[i] * b[i];
    b[j] = sum;
  }
}

static inline int $_search_(const double *target, const double *previous, $_iterate_ **best, $_iterate_ *next) {
  double normal[$$_SIZE_ * $$_SIZE_], damped[$$_SIZE_ * $$_SIZE_], gradient[$$_JOINTS], step[$$_JOINTS], x[$$_SIZE_];
  double damping = 1e-3;
  int held[$$_JOINTS], i, j, evaluations = 1;
@if redundant
  int k;
@end
  $_evaluate_(target, previous, *best);
  if (!((*best)->cost - (*best)->cost == 0)) return $$_STALLED; /* not finite */
  while (!((*best)->position <= $$_POSITION_TOLERANCE && (*best)->rotation <= $$_ROTATION_TOLERANCE)) {
    double trace = 0, scale, square = 0, least;
    for (j = 0; j < $$_JOINTS; ++j) {
      const double *limit = $_limits_ + 2 * j, *of_j = (*best)->J + 6 * j, q = (*best)->q[j];
      gradient[j] = $_dot6_(of_j, (*best)->error);
      trace += $_dot6_(of_j, of_j);
      held[j] = (q <= limit[0] && gradient[j] < 0) || (q >= limit[1] && gradient[j] > 0); /* by its limit */
      if (held[j]) gradient[j] = 0;
      square += gradient[j] * gradient[j];
    }
    scale = trace > 1e-12 ? trace : 1e-12;
@if redundant
    for (k = 0; k < $$_SIZE_ * $$_SIZE_; ++k) normal[k] = 0; /* J J': J' J is singular with fewer equations than joints */
    for (j = 0; j < $$_JOINTS; ++j) {
      const double *of_j = (*best)->J + 6 * j;
      if (held[j]) continue;
      for (k = 0; k < $$_SIZE_; ++k)
        for (i = k; i < $$_SIZE_; ++i) normal[k * $$_SIZE_ + i] += of_j[i] * of_j[k];
    }
@end
@if !redundant
    for (j = 0; j < $$_JOINTS; ++j)
      for (i = j; i < $$_JOINTS; ++i)
        normal[j * $$_SIZE_ + i] =
            held[i] || held[j] ? (i == j ? 1 : 0) : $_dot6_((*best)->J + 6 * i, (*best)->J + 6 * j);
@end
    least = 1e-3 * sqrt(scale * (*best)->cost);
    if (0.1 * (*best)->cost < least) least = 0.1 * (*best)->cost;
    if (sqrt(square) <= least) return $$_LIMITS; /* nothing to gain in any direction */
    for (;;) {
      double shorten = 1;
      if (evaluations >= $$_EVALUATIONS_ || damping > 1e12) return $$_STALLED;
      for (j = 0; j < $$_SIZE_; ++j) {
        for (i = j; i < $$_SIZE_; ++i) damped[j * $$_SIZE_ + i] = normal[j * $$_SIZE_ + i];
        damped[j * $$_SIZE_ + j] += damping * (*best)->cost + 1e-14 * scale;
@if redundant
        x[j] = (*best)->error[j];
@end
@if !redundant
        x[j] = gradient[j];
@end
      }
      $_solve_(damped, x);
      for (j = 0; j < $$_JOINTS; ++j) {
@if redundant
        step[j] = 0;
        for (k = 0; k < $$_SIZE_ && !held[j]; ++k) step[j] += x[k] * (*best)->J[6 * j + k];
@end
@if !redundant
        step[j] = held[j] ? 0 : x[j];
@end
      }
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
}

}  // namespace vernier::detail
