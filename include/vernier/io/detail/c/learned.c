R"c(
#if HAS_LEARNED
static inline void arm_accumulate_(int first, double factor, const double *terms, double *sums) {
  int j;
  if (first)
    for (j = 0; j < ARM_FEATURES_; ++j) sums[j] = factor * terms[j];
  else
    for (j = 0; j < ARM_FEATURES_; ++j) sums[j] += factor * terms[j];
}

/* The learned position error, and its derivative as columns of three; 0 for none. */
static inline void arm_learned_(const double *q, double *y, double *slope) {
  double x[ARM_FEATURES_], gradient[3 * ARM_FEATURES_];
  int i, j, k, o;
#if HAS_SINES
  double c[ARM_CHAIN_], s[ARM_CHAIN_];
  for (i = 0; i < ARM_CHAIN_; ++i) {
    c[i] = cos(q[i]);
    s[i] = sin(q[i]);
  }
#endif
#if HAS_MAP_RAW
  for (i = 0; i < ARM_CHAIN_; ++i) x[i] = q[i];
#endif
#if HAS_MAP_SINES_AND_COSINES
  for (i = 0; i < ARM_CHAIN_; ++i) {
    x[i] = s[i];
    x[ARM_CHAIN_ + i] = c[i];
  }
#endif
#if HAS_MAP_PRODUCTS
  for (i = ARM_CHAIN_ - 1, k = 0; i >= 0; --i)
    for (o = 0; o < 2; ++o) {
      const double factor = o ? c[i] : s[i];
      x[k++] = factor;
      for (j = ARM_CHAIN_ - 1; j > i; --j) {
        x[k++] = factor * s[j];
        x[k++] = factor * c[j];
      }
    }
#endif
  for (j = 0; j < ARM_FEATURES_; ++j) x[j] = (x[j] - arm_feature_offset_[j]) * arm_feature_factor_[j];
  for (o = 0; o < 3; ++o) y[o] = arm_output_offset_[o];
  for (k = 0; k < ARM_NODES_; ++k) { /* weights, bias, three output weights */
    const double *w = arm_nodes_ + k * (ARM_FEATURES_ + 4), bias = w[ARM_FEATURES_], *beta = w + ARM_FEATURES_ + 1;
    double z = 0, dz;
#if HAS_RADIAL_BASIS
    double apart[ARM_FEATURES_];
    for (j = 0; j < ARM_FEATURES_; ++j) {
      apart[j] = x[j] - w[j];
      z += apart[j] * apart[j];
    }
    z = exp(-bias * bias * z);
    dz = -2 * bias * bias * z;
    w = apart;
#else
    for (j = 0; j < ARM_FEATURES_; ++j) z += w[j] * x[j];
    z += bias;
#endif
#if HAS_SIGMOID
    z = 1 / (1 + exp(-z));
    dz = z * (1 - z);
#endif
#if HAS_TANH
    z = tanh(z);
    dz = 1 - z * z;
#endif
#if HAS_SINE
    dz = cos(z);
    z = sin(z);
#endif
    for (o = 0; o < 3; ++o) {
      y[o] += beta[o] * z;
      if (slope) arm_accumulate_(k == 0, beta[o] * dz, w, gradient + o * ARM_FEATURES_);
    }
  }
  if (!slope) return;
  for (o = 0; o < 3; ++o) {
    double *g = gradient + o * ARM_FEATURES_;
    for (j = 0; j < ARM_FEATURES_; ++j) g[j] *= arm_feature_factor_[j];
#if HAS_MAP_RAW
    for (i = 0; i < ARM_CHAIN_; ++i) slope[3 * i + o] = g[i];
#endif
#if HAS_MAP_SINES_AND_COSINES
    for (i = 0; i < ARM_CHAIN_; ++i) slope[3 * i + o] = g[i] * c[i] - g[ARM_CHAIN_ + i] * s[i];
#endif
#if HAS_MAP_PRODUCTS
    for (i = ARM_CHAIN_ - 1; i >= 0; --i) {
      double sum = 0;
      for (k = 0; k < 2; ++k) {
        const double factor = k ? c[i] : s[i], rate = k ? -s[i] : c[i];
        double of_rate = *g++;
        for (j = ARM_CHAIN_ - 1; j > i; --j, g += 2) {
          of_rate += g[0] * s[j] + g[1] * c[j];
          slope[3 * j + o] += factor * (g[0] * c[j] - g[1] * s[j]);
        }
        sum += of_rate * rate;
      }
      slope[3 * i + o] = sum;
    }
#endif
  }
}
#endif
)c"
