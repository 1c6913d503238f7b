R"c(
/* ---- the chain ---- */

/* Where the links are; three coordinates a joint. */
typedef struct {
  double axis[3 * ARM_CHAIN_], point[3 * ARM_CHAIN_]; /* of the joint */
#if HAS_LINKS
  double end[3 * ARM_CHAIN_];                        /* of the link */
  double x[3 * ARM_CHAIN_], y[3 * ARM_CHAIN_], origin[3 * ARM_CHAIN_]; /* of the frame behind the joint */
#endif
} arm_links_;

/* Turns one axis towards another. */
static inline void arm_turn_(double *from, double *towards, double c, double s) {
  int k;
  for (k = 0; k < 3; ++k) {
    const double turned = c * from[k] + s * towards[k];
    towards[k] = c * towards[k] - s * from[k];
    from[k] = turned;
  }
}

static inline void arm_move_(double *origin, const double *axis, double length) {
  int k;
  for (k = 0; k < 3; ++k) origin[k] += length * axis[k];
}

static inline void arm_store_(double *out, int joint, const double *v) {
  int k;
  for (k = 0; k < 3; ++k) out[3 * joint + k] = v[k];
}

/* Carries a frame along a chain from where it begins. */
static inline void arm_walk_(const double *rows, const double *q, double *frame, arm_links_ *links) {
  double *x = frame, *y = frame + 3, *z = frame + 6, *origin = frame + 9, c[ARM_CHAIN_], s[ARM_CHAIN_];
  int i;
  for (i = 0; i < ARM_CHAIN_; ++i) {
#if HAS_PRISMATIC
    const double angle = rows[7 * i] + (arm_prismatic_[i] ? 0 : q[i]);
#else
    const double angle = rows[7 * i] + q[i];
#endif
    c[i] = cos(angle);
    s[i] = sin(angle);
  }
  for (i = 0; i < ARM_CHAIN_; ++i) {
    const double *row = rows + 7 * i;
#if HAS_PRISMATIC
    const double d = row[1] + (arm_prismatic_[i] ? q[i] : 0);
#else
    const double d = row[1];
#endif
#if HAS_MODIFIED
    arm_turn_(y, z, row[4], row[3]);
    arm_move_(origin, x, row[2]);
    arm_turn_(z, x, row[6], row[5]);
#endif
    arm_store_(links->axis, i, z);
    arm_store_(links->point, i, origin);
    arm_turn_(x, y, c[i], s[i]);
    arm_move_(origin, z, d);
#if HAS_LINKS
    arm_store_(links->x, i, x);
    arm_store_(links->y, i, y);
    arm_store_(links->origin, i, origin);
#endif
#if !HAS_MODIFIED
    arm_move_(origin, x, row[2]);
    arm_turn_(y, z, row[4], row[3]);
    arm_turn_(z, x, row[6], row[5]);
#endif
#if HAS_LINKS
    arm_store_(links->end, i, origin);
#endif
  }
}

static inline void arm_identity_(double *frame) {
  int k;
  for (k = 0; k < 12; ++k) frame[k] = k == 0 || k == 4 || k == 8 ? 1 : 0;
}

/* From the end of a chain to base_T_tool. */
static inline void arm_into_frames_(const double *base, const double *tool, const double *end, double *out) {
  double flange[12], tip[3];
  int k;
  arm_product_(base, end, flange);
  arm_rotate_(base, end + 9, flange + 9);
  arm_rotate_(flange, tool + 9, tip);
  for (k = 0; k < 3; ++k) out[9 + k] = base[9 + k] + flange[9 + k] + tip[k];
  arm_product_(flange, tool, out);
}

/* From columns to the upper three rows, and back. */
static inline void arm_to_rows_(const double *frame, double *T) {
  int i, j;
  for (i = 0; i < 3; ++i)
    for (j = 0; j < 4; ++j) T[4 * i + j] = frame[3 * j + i];
}

static inline void arm_to_columns_(const double *T, double *frame) {
  int i, j;
  for (i = 0; i < 3; ++i)
    for (j = 0; j < 4; ++j) frame[3 * j + i] = T[4 * i + j];
}
)c"
