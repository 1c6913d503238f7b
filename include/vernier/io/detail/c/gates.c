R"c(
#if HAS_GATES
/* The gate of one joint, and its slope. */
static inline double arm_gate_of_joint_(const double *ranges, int count, double margin, int periodic, double q,
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
    if (turned > length && turned - length < below) below = turned - length;
    if ((periodic || turned < 0) && up < above) above = up;
  }
  if (above + below <= 2 * margin) return 1;
  outside = (below < above ? below : above) / margin;
  if (!(outside < 1)) return 0;
  *slope = 6 * outside * (1 - outside) * (above < below ? 1 : -1) / margin;
  return 1 - outside * outside * (3 - 2 * outside);
}

/* The product of all, and where wanted its gradient. */
static inline double arm_gate_at_(const arm_coverage_ *coverage, const double *q, double *gradient) {
  double value[ARM_CHAIN_], slope[ARM_CHAIN_], product = 1;
  const double *ranges = coverage->ranges;
  int i, k;
  for (i = 0; i < ARM_CHAIN_; ++i) {
    value[i] =
        arm_gate_of_joint_(ranges, coverage->count[i], coverage->margin[i], coverage->periodic[i], q[i], slope + i);
    ranges += 2 * coverage->count[i];
    product *= value[i];
  }
  for (k = 0; gradient && k < ARM_CHAIN_; ++k) {
    gradient[k] = slope[k];
    for (i = 0; i < ARM_CHAIN_; ++i)
      if (i != k) gradient[k] *= value[i];
  }
  return product;
}
#endif
#if HAS_FALLBACK

/* The gate of the arm with all its errors: of the ranges of the joints, or of the motors that err. */
static inline double arm_gate_of_model_(const double *q, double *gradient) {
#if HAS_MOTORS
  double angles[ARM_CHAIN_], of_motors[ARM_CHAIN_], gate;
  int i, k;
  arm_to_motors_(q, angles);
  gate = arm_gate_at_(&arm_coverage_of_model_, angles, of_motors);
  for (i = 0; gradient && i < ARM_CHAIN_; ++i) {
    gradient[i] = 0;
    for (k = 0; k < ARM_CHAIN_; ++k) gradient[i] += of_motors[k] * arm_motor_angles_[k * ARM_CHAIN_ + i];
  }
  return gate;
#else
  return arm_gate_at_(&arm_coverage_of_model_, q, gradient);
#endif
}

/* From `far` to `near` by the gate, the rotation along the geodesic; `far` and its Jacobian are overwritten. */
static inline void arm_blend_(double gate, const double *slope, const double *near_frame, const double *near_J,
                            double *far_frame, double *far_J) {
  double between[9], phi[3], part[3], turn[9], inverse[9], left[9], apart[3], v[3], rotated[9];
  int j, k;
  arm_between_(near_frame, far_frame, between);
  arm_log_(between, phi);
  for (j = 0; j < 3; ++j) {
    part[j] = gate * phi[j];
    apart[j] = near_frame[9 + j] - far_frame[9 + j];
  }
  arm_exp_(part, turn);
  if (near_J && far_J) {
    arm_left_inverse_(phi, inverse);
    arm_left_(part, left);
    for (k = 0; k < ARM_CHAIN_; ++k) {
      double *linear = far_J + 6 * k, *angular = linear + 3;
      for (j = 0; j < 3; ++j) linear[j] += gate * (near_J[6 * k + j] - linear[j]) + apart[j] * slope[k];
      arm_rotate_(between, angular, v);
      for (j = 0; j < 3; ++j) v[j] = near_J[6 * k + 3 + j] - v[j];
      arm_rotate_(inverse, v, v);
      for (j = 0; j < 3; ++j) v[j] = gate * v[j] + phi[j] * slope[k];
      arm_rotate_(left, v, v);
      arm_rotate_(turn, angular, angular);
      for (j = 0; j < 3; ++j) angular[j] += v[j];
    }
  }
  arm_product_(turn, far_frame, rotated);
  for (j = 0; j < 9; ++j) far_frame[j] = rotated[j];
  for (j = 0; j < 3; ++j) far_frame[9 + j] += gate * apart[j];
}
#endif
)c"
