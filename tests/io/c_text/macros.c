R"c(
/* Macros of an arm, as they stand in front of the text that all arms have in common. */
#include <math.h>

#define ARM_API
#if HAS_ORIENTED
#define ARM_JOINTS (6 + HAS_REDUNDANT)
#define ARM_SIZE_ 6
#else
#define ARM_JOINTS (3 + HAS_REDUNDANT)
#define ARM_SIZE_ 3
#endif
#define ARM_CHAIN_ ARM_JOINTS
#define ARM_LANES_ (ARM_JOINTS + ARM_JOINTS % 2)
#if HAS_MAP_PRODUCTS
#define ARM_FEATURES_ (2 * ARM_JOINTS * ARM_JOINTS)
#elif HAS_MAP_SINES_AND_COSINES
#define ARM_FEATURES_ (2 * ARM_JOINTS)
#else
#define ARM_FEATURES_ ARM_JOINTS
#endif
#define ARM_NODES_ 30
#define ARM_POSITION_TOLERANCE 1e-6
#define ARM_ROTATION_TOLERANCE 1e-6
#define ARM_ROTATION_LENGTH_ 0.25
#define ARM_EVALUATIONS_ 100
#define ARM_MET 0
#define ARM_STALLED 1
#define ARM_LIMITS 2
)c"
