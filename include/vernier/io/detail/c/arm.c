R"c(
/* The arm with everything. */
#if HAS_CONTROLLER
static inline void arm_chain_at_(const double *q, const double *previous, double *frame, double *J) {
#else
static inline void arm_at_(const double *q, const double *previous, double *frame, double *J) {
#endif
#if HAS_FALLBACK
  double slope[ARM_CHAIN_], near_frame[12], columns[6 * ARM_CHAIN_], *near_J = J ? columns : 0;
  const double gate = arm_gate_of_model_(q, slope);
  if (gate >= 1) {
    arm_arm_at_(&arm_identified_, q, previous, frame, J);
  } else {
    arm_arm_at_(&arm_outside_, q, previous, frame, J);
    if (!(gate <= 0)) {
      arm_arm_at_(&arm_identified_, q, previous, near_frame, near_J);
      arm_blend_(gate, slope, near_frame, near_J, frame, J);
    }
  }
#else
  arm_arm_at_(&arm_identified_, q, previous, frame, J);
#endif
#if HAS_LEARNED
  {
    double gradient[ARM_CHAIN_], error[3], rate[3 * ARM_CHAIN_];
    const double share = arm_gate_at_(&arm_coverage_of_learned_, q, gradient);
    int i, j;
    if (share == 0) return;
    arm_learned_(q, error, J ? rate : 0);
    for (j = 0; j < 3; ++j) frame[9 + j] -= share * error[j];
    for (i = 0; J && i < ARM_CHAIN_; ++i)
      for (j = 0; j < 3; ++j) J[6 * i + j] -= share * rate[3 * i + j] + error[j] * gradient[i];
  }
#endif
}
#if HAS_CONTROLLER

/* Joint values of the chain from those of the controller. */
static inline void arm_to_chain_(const double *q, double *chain) {
  int i, j;
  for (i = 0; i < ARM_CHAIN_; ++i) {
    double sum = arm_zeros_[i];
    for (j = 0; j < ARM_JOINTS; ++j) sum += arm_factors_[i * ARM_JOINTS + j] * q[j];
    chain[i] = sum;
  }
}

static inline void arm_at_(const double *q, const double *previous, double *frame, double *J) {
  double chain[ARM_CHAIN_], before[ARM_CHAIN_], columns[6 * ARM_CHAIN_];
  int i, j, k;
  arm_to_chain_(q, chain);
  if (previous) arm_to_chain_(previous, before);
  arm_chain_at_(chain, previous ? before : 0, frame, J ? columns : 0);
  for (k = 0; J && k < ARM_JOINTS; ++k)
    for (i = 0; i < 6; ++i) {
      double sum = 0;
      for (j = 0; j < ARM_CHAIN_; ++j) sum += columns[6 * j + i] * arm_factors_[j * ARM_JOINTS + k];
      J[6 * k + i] = sum;
    }
}
#endif

ARM_API void arm_pose(const double q[ARM_JOINTS], const double *previous, double T[12]) {
  double frame[12];
  arm_at_(q, previous, frame, 0);
  arm_to_rows_(frame, T);
}

ARM_API void arm_nominal_pose(const double q[ARM_JOINTS], double T[12]) {
  double end[12], frame[12];
  arm_links_ links;
#if HAS_CONTROLLER
  double chain[ARM_CHAIN_];
  arm_to_chain_(q, chain);
#else
  const double *chain = q;
#endif
  arm_identity_(end);
  arm_walk_(arm_nominal_rows_, chain, end, &links);
  arm_into_frames_(arm_identified_.base, arm_identified_.tool, end, frame);
  arm_to_rows_(frame, T);
}

ARM_API void arm_jacobian(const double q[ARM_JOINTS], const double *previous, double J[6 * ARM_JOINTS]) {
  double frame[12], columns[6 * ARM_JOINTS];
  int i, k;
  arm_at_(q, previous, frame, columns);
  for (i = 0; i < 6; ++i)
    for (k = 0; k < ARM_JOINTS; ++k) J[i * ARM_JOINTS + k] = columns[6 * k + i];
}

ARM_API double arm_gate(const double q[ARM_JOINTS]) {
  double gate = 1;
#if HAS_GATES
#if HAS_CONTROLLER
  double chain[ARM_CHAIN_];
  arm_to_chain_(q, chain);
#else
  const double *chain = q;
#endif
#endif
#if HAS_FALLBACK
  {
    const double of_model = arm_gate_of_model_(chain, 0);
    if (of_model < gate) gate = of_model;
  }
#endif
#if HAS_LEARNED
  {
    const double of_learned = arm_gate_at_(&arm_coverage_of_learned_, chain, 0);
    if (of_learned < gate) gate = of_learned;
  }
#endif
#if !HAS_GATES
  (void)q;
#endif
  return gate;
}
)c"
