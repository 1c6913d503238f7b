R"c(
/* Joint values are commands [rad, m], as the controller counts its joints. A pose T is base_T_tool in the frame of the measurements: the upper three rows of
 * the 4 x 4 matrix, row by row, [m]. `previous` is the command before, from which the arm comes; 0, or values that are
 * not finite, where that is unknown: then the arm is in the middle of both directions of approach. */

/* The pose that the arm takes when commanded q. */
ARM_API void arm_pose(const double q[ARM_JOINTS], const double *previous, double T[12]);

/* The pose of the arm as designed, in the same frames: where a program means the arm to be at q. */
ARM_API void arm_nominal_pose(const double q[ARM_JOINTS], double T[12]);

/* The geometric Jacobian of `arm_pose`, 6 x ARM_JOINTS, row by row: linear rows first, at the tool point. */
ARM_API void arm_jacobian(const double q[ARM_JOINTS], const double *previous, double J[6 * ARM_JOINTS]);

/* Share of what was learned over the joints that is used at q: 1 within the measured joint ranges, 0 far outside. */
ARM_API double arm_gate(const double q[ARM_JOINTS]);

/* The command q that brings the arm to the pose T, on the branch of `seed`; the best one found in any case, within the
 * joint limits.
#if !HAS_ORIENTED
 * The orientation of T is ignored: the arm has fewer than six joints.
#endif
 * `error`, unless it is 0, becomes the distance from T that is left [m]. `q` may be `seed` or `previous`.
 * Returns ARM_MET, ARM_STALLED (the iterations ran out) or ARM_LIMITS (out of reach or beyond the limits).
 * To correct the command of a program, q0: arm_nominal_pose(q0, T); arm_correct(T, q0, previous, q, &error); */
ARM_API int arm_correct(const double T[12], const double seed[ARM_JOINTS], const double *previous, double q[ARM_JOINTS],
                     double *error);
)c"
