// Assignments of Eigen would write beyond the end.
// expect: #error "Vernier assigns matrices to those of other sizes: compile without EIGEN_NO_AUTOMATIC_RESIZING"
// flags: -DEIGEN_NO_AUTOMATIC_RESIZING
#ifdef MISTAKE
#include <vernier/core/so3.hpp>
#endif
