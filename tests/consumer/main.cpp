// SPDX-License-Identifier: BSD-3-Clause
// What a user's program sees of Vernier: the headers, the namespace, the version, the libraries of what it asked for,
// and functions that are compiled here (header-only) or come from the library.

#include <vernier/core/literals.hpp>
#include <vernier/core/register_points.hpp>
#include <vernier/core/version.hpp>
#include <vernier/identification/frames.hpp>
#include <vernier/kinematics/inverse_kinematics.hpp>
#include <vernier/kinematics/robots.hpp>
#ifdef CONSUMER_IO
#include <vernier/io/robot_file.hpp>
#endif
#ifdef CONSUMER_URDF
#include <vernier/urdf.hpp>
#endif
#ifdef CONSUMER_CERES
#include <vernier/ceres/solver.hpp>
#include <vernier/identification/identify.hpp>
#include <vernier/simulation/virtual_robot.hpp>
#endif
#ifdef CONSUMER_CHOLMOD
#include <vernier/cholmod.hpp>
#endif
#ifdef CONSUMER_TBB
#include <vernier/tbb.hpp>
#endif
#ifdef CONSUMER_MPI
#include <vernier/mpi.hpp>
#endif
#ifdef CONSUMER_UMBRELLA  // all that needs Eigen alone
#include <vernier/vernier.hpp>
#endif

#include <atomic>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#ifdef VERNIER_COMPILED
#define CONSUMER_MODE "compiled"
#else
#define CONSUMER_MODE "header-only"
#endif

namespace vn = vernier;
using namespace vernier::literals;

#ifdef CONSUMER_MIXED
double reach_by_library();  // in the other translation unit, which uses vernier::compiled
#endif

int main() {
  constexpr vn::DhChain<2> arm{{{
      {.a = 300_mm, .alpha = 0_deg, .d = 0_mm, .theta = 0_deg},
      {.a = 200_mm, .alpha = 0_deg, .d = 0_mm, .theta = 0_deg},
  }}};
  vn::JointVector<2> q;
  q.setZero();
  const double reach = arm.position(q).norm();
  bool right = std::abs(reach - 0.5) < 1e-12;
  vn::PointRows points(3, 3), shifted(3, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  shifted = points.rowwise() + Eigen::RowVector3d(1, 2, 3);
  right = right && (vn::register_points(points, shifted).translation() - vn::Vector3(1, 2, 3)).norm() < 1e-12;
#ifdef CONSUMER_MIXED
  right = right && reach_by_library() == reach;
#endif
#ifdef CONSUMER_IO
  right = right && vn::RobotDescription::of(vn::robots::ur10()).dof() == 6;
#endif
#ifdef CONSUMER_URDF
  const char* urdf =
      "<robot name='one'><link name='a'/><link name='b'/><joint name='j' type='continuous'><parent link='a'/>"
      "<child link='b'/></joint></robot>";
  right = right && vn::parse_urdf(urdf, "one.urdf").robot.dof() == 1;
  right = right && vn::UrKinematics::of(vn::RobotDescription::of(vn::robots::ur10()).geometry(), "").hash.empty();
#endif
#ifdef CONSUMER_CERES
  const auto chain = vn::robots::abb_irb120().chain;
  vn::JointRows<6> joints = vn::JointRows<6>::Zero(40, 6);
  for (vn::Index i = 0; i < joints.size(); ++i) joints.data()[i] = std::sin(static_cast<double>(i * i));
  const auto found = vn::identify(chain, vn::measure(vn::with_geometric_errors(chain, {}, 1), joints));
  right = right && found.rms_after < 1e-9 && found.rms_before > 1e-4;
#endif
#ifdef CONSUMER_CHOLMOD
  vn::MatrixX one = vn::MatrixX::Constant(1, 1, 6);
  right = right && vn::CholmodSolver{}({1, {0, 1}, {0}, {2}}, one).solved && one(0, 0) == 3;
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
#ifdef CONSUMER_UMBRELLA  // an arm is calibrated with Eigen alone
  const vn::Robot<6> robot = vn::robots::ur10();
  const auto actual = vn::with_geometric_errors(robot.chain, {}, 1);
  const auto measured = [&](vn::Index n, std::uint64_t seed) {
    return vn::measure(actual, vn::sample_joints(robot.limits, n, seed));
  };
  vn::CalibrateOptions geometry;
  geometry.errors = {.compliance = false, .harmonics = 0, .hysteresis = false, .tilt = false, .drift = false};
  geometry.remainder.learners.clear();
  const auto calibration = vn::calibrate(robot.chain, measured(30, 1), geometry);
  const auto report = vn::evaluate(calibration, measured(10, 2), robot.limits);
  right = right && report.stage(vn::Stage::geometry).position.maxCoeff() < 1e-6;
#endif

  std::printf("%-11s vernier %d.%d.%d: a reach of %.1f mm\n", CONSUMER_MODE, VERNIER_VERSION_MAJOR,
              VERNIER_VERSION_MINOR, VERNIER_VERSION_PATCH, reach * 1e3);
  return right ? 0 : 1;
}
