R"c(
/* An arm; 0 for what it lacks. Frames are four columns: the axes x, y, z and the origin. */
typedef struct {
  const double *rows;          /* of each joint: theta, d, a, sin and cos of alpha, sin and cos of beta */
  const double *base, *tool;   /* frames */
  const double *gear;          /* error of the gear ratio of each joint */
  const double *coupling;      /* of each joint by the one before; the first is 0 */
  const double *linear_ranges; /* of each joint, the range of these two */
  const double *gravity;       /* of joint i under link j >= i [rad/m] */
  const double *gravity_down;  /* direction of gravity */
  const double *payload;       /* compliance of each joint to what is carried [rad/(N m)] */
  const double *payload_load;  /* its weight [N] and moment in the frame of the flange [N m], then down */
  const double *hysteresis;    /* of each width: the width, then a coefficient a joint */
  int widths;
  const double *tilt;      /* of each joint: about x by the three components of gravity, about y likewise */
  const double *tilt_down; /* direction of gravity */
  const double *straight;  /* of each prismatic joint: cosines of x, y, z and of the rotations about them */
  const double *guides;    /* of each prismatic joint: its range */
  int straight_orders;     /* number of cosines */
  const double *harmonics; /* of each order: cosine coefficients of all joints, then sine coefficients */
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
