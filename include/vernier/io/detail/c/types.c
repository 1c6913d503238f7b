R"c(
/* Coefficients of joint errors that belong together, and their parameters; 0 for what an arm lacks. */
typedef struct {
  const double *of, *parameters;
  int count; /* of the parameters */
} arm_terms_;

/* An arm; 0 for what it lacks. Frames are four columns: the axes x, y, z and the origin. */
typedef struct {
  const double *rows;           /* of each joint: theta, d, a, sin and cos of alpha, sin and cos of beta */
  const double *base, *tool;    /* frames */
  arm_terms_ terms[ARM_KINDS_]; /* joint errors of each kind, in a column of their own */
  const double *linear_ranges;  /* of each joint, the range of gear ratio and coupling */
  const double *harmonics;      /* of each order: cosine coefficients of all joints, then sine coefficients */
  const int *order;
  int orders;
} arm_arm_;
#if HAS_GATES

/* Measured ranges of the joints. */
typedef struct {
  const double *margin; /* of each joint: width of the transition to 0 */
  const int *periodic;  /* of each joint: whether whole turns count as the same */
  const int *count;     /* of each joint: number of ranges */
  const double *ranges; /* lower and upper ends, joint by joint */
} arm_coverage_;
#endif
)c"
