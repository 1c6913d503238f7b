// What a user's program sees of Vernier: the headers, the namespace, the version, and the libraries of what it asked
// for.

#include <vernier/core/literals.hpp>
#include <vernier/core/version.hpp>
#include <vernier/kinematics/dh_chain.hpp>
#ifdef CONSUMER_IO
#include <vernier/io/json.hpp>
#endif
#ifdef CONSUMER_CERES
#include <vernier/ceres/problem.hpp>
#endif
#ifdef CONSUMER_TBB
#include <vernier/tbb.hpp>
#endif
#ifdef CONSUMER_MPI
#include <vernier/mpi.hpp>
#endif
#if !defined(CONSUMER_IO) && !defined(CONSUMER_CERES) && !defined(CONSUMER_TBB)  // all that needs Eigen alone
#include <vernier/vernier.hpp>
#endif

#include <atomic>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace vn = vernier;
using namespace vernier::literals;

int main() {
  constexpr vn::DhChain<2> arm{{{
      {.a = 300_mm, .alpha = 0_deg, .d = 0_mm, .theta = 0_deg},
      {.a = 200_mm, .alpha = 0_deg, .d = 0_mm, .theta = 0_deg},
  }}};
  vn::JointVector<2> q;
  q.setZero();
  const double reach = arm.position(q).norm();
  bool right = std::abs(reach - 0.5) < 1e-12;
#ifdef CONSUMER_IO
  right = right && nlohmann::json{{"reach_m", reach}}.size() == 1;
#endif
#ifdef CONSUMER_CERES
  right = right && ceres::Problem{}.NumParameters() == 0;
#endif
#ifdef CONSUMER_TBB
  std::atomic<long> done = 0;
  vn::TbbExecutor(2).for_ranges(1000, [&](vn::Index begin, vn::Index end) { done += end - begin; });
  right = right && done == 1000;
#endif
#ifdef CONSUMER_MPI
  try {  // without MPI_Init, so that this runs without mpirun
    const vn::MpiExecutor ranks;
    right = false;
  } catch (const std::invalid_argument&) {
  }
#endif
  std::printf("vernier %d.%d.%d: a reach of %.1f mm\n", VERNIER_VERSION_MAJOR, VERNIER_VERSION_MINOR,
              VERNIER_VERSION_PATCH, reach * 1e3);
  return right ? 0 : 1;
}
