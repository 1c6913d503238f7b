// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics, Jacobians and inverse kinematics of a six-joint arm, against KDL.

#include <array>
#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <memory>
#include <vector>

#include "opw_solver.hpp"
#include "program.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/error_model.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/general_six_axis.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vn = vernier;
using namespace vernier::literals;

namespace {

constexpr const char* about =
    R"(kinematics_benchmark: a six-joint arm (ABB IRB 120), against KDL on the same chain and the same joints

  pose                 one pose: ChainFkSolverPos_recursive
  pose and jacobian    both: ChainFkSolverPos_recursive and ChainJntToJacSolver
  jacobian             the Jacobian alone: ChainJntToJacSolver
  parameter jacobian   6 x 30, derivative of the pose with respect to the DH parameters: central differences
  10,000 positions     tool positions of 10,000 joint combinations, as a block and one by one
  10,000 poses         the same with orientations
  10,000 jacobians     poses and Jacobians of 10,000 joint combinations, 100 at a time, as a block and one by one;
                       and ChainFkSolverPos_recursive with ChainJntToJacSolver
  10,000 parameter jacobians   the same with respect to the DH parameters
  growth               pose and Jacobian of arms with 2 to 10 joints
  inverse kinematics   full pose to 1e-6 m and 1e-6 rad from a seed up to 0.05 rad off in each joint, no joint limits:
                       ChainIkSolverPos_LMA, ChainIkSolverPos_NR
  the same, cold       any pose within the joint limits from any other joints within them; joints may leave the limits,
                       as KDL has none in these solvers. Vernier starts anew up to 20 times where it does not converge.

  all joint values     every branch of the nominal arm at any pose: ClosedForm, a plain OPW solver by the published formulas,
                       GeneralSixAxis
  all branches         of an arm off by 0.5 mm and 2 mrad, from the roots of the nominal one, proven distinct:
                       ChainIkSolverPos_LMA from each of the same roots
  all branches, joint-wise   the same of an arm with 60 harmonics in every joint
  path of 10,000       correct_path: 10,000 targets in linear moves of 2 mm on that arm, without the radius of 95 %

"vernier, constexpr table" is the same chain with its table known to the compiler; "vernier" reads it at run time, as an
identified arm does. KDL is the library as installed, called through its solvers with everything allocated beforehand.
Before anything is timed, poses, Jacobians and solutions are compared; a difference stops the program.)";

constexpr vn::DhChain<6> constexpr_arm{{{
    {.a = 0_mm, .alpha = -90_deg, .d = 290_mm, .theta = 0_deg},
    {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
    {.a = 70_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = 90_deg, .d = 302_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg},
}}};

using Chain = vn::DhChain<6>;
using Joints = vn::JointVector<6>;

KDL::Chain kdl_chain(const Chain& arm) {
  KDL::Chain chain;
  for (const vn::DhRow& row : arm.rows())
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(row.a, row.alpha, row.d, row.theta)));
  return chain;
}

KDL::JntArray kdl_joints(const Joints& q) {
  KDL::JntArray out(6);
  out.data = q;
  return out;
}

double difference(const vn::Isometry3& ours, const KDL::Frame& theirs) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    worst = std::max(worst, std::abs(ours.translation()(i) - theirs.p(i)));
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(ours.linear()(i, j) - theirs.M(i, j)));
  }
  return worst;
}

/// KDL's solvers for one chain; each keeps its own workspace.
struct Kdl {
  explicit Kdl(const KDL::Chain& arm)
      : chain(arm),
        forward(chain),
        derivative(chain),
        lma(chain, vn::Vector6::Ones(), tolerance),
        velocity(chain),
        newton_forward(chain),
        newton(chain, newton_forward, velocity, 100, tolerance) {}

  static constexpr double tolerance = 1e-6;
  KDL::Chain chain;
  KDL::ChainFkSolverPos_recursive forward;
  KDL::ChainJntToJacSolver derivative;
  KDL::ChainIkSolverPos_LMA lma;
  KDL::ChainIkSolverVel_pinv velocity;
  KDL::ChainFkSolverPos_recursive newton_forward;
  KDL::ChainIkSolverPos_NR newton;
};

vn::ParameterJacobian<30> central_differences(const Chain& arm, const Joints& q) {
  constexpr double step = 1e-6;
  const Chain::Parameters parameters = arm.parameters();
  vn::ParameterJacobian<30> out;
  for (int k = 0; k < 30; ++k) {
    Chain::Parameters above = parameters, below = parameters;
    above(k) += step;
    below(k) -= step;
    const vn::Isometry3 a = arm.pose<double>(q, above), b = arm.pose<double>(q, below);
    out.col(k).head<3>() = (a.translation() - b.translation()) / (2 * step);
    out.col(k).tail<3>() = vn::log_so3(a.linear() * b.linear().transpose()) / (2 * step);
  }
  return out;
}

/// Poses and Jacobians of arms with N joints.
template <int N>
void measure_growth(bench::Program& program) {
  vn::Rng rng(N);
  std::array<vn::DhRow, N> rows;
  for (vn::DhRow& row : rows)
    row = {.a = rng.uniform(-0.5, 0.5),
           .alpha = rng.uniform(-3, 3),
           .d = rng.uniform(-0.5, 0.5),
           .theta = rng.uniform(-3, 3)};
  const auto arm = vn::DhChain<N>::from_rows(rows);
  std::vector<vn::JointVector<N>> joints(256);
  for (auto& q : joints)
    for (double& angle : q) angle = rng.uniform(-3, 3);
  program.measure("growth", std::to_string(N) + " joints",
                  [=](std::size_t i) { return arm.pose_and_jacobian(joints[i & 255]); });
}

/// All branches: of the nominal arm, of one off it, of one with joint errors; and a whole path.
void measure_branches(bench::Program& program, const Chain& arm, const std::vector<vn::Isometry3>& targets) {
  const std::size_t mask = targets.size() - 1;
  const vn::ClosedForm<6> closed_form(arm);
  const vn::GeneralSixAxis<6> general(arm);
  const bench::OpwSolver opw{0, -0.070, 0, 0.290, 0.270, 0.302, 0.072};
  double worst = 0;
  for (const vn::Isometry3& target : targets) {
    const auto ours = closed_form.roots(target);
    if (ours.count != 8) continue;  // a root fewer on a boundary
    for (const auto& theirs : opw.solve(target)) {
      double nearest = 10;
      for (const auto& root : ours) {
        const double zero[] = {0, 0, -0.5 * std::numbers::pi, 0, 0, 0};
        double difference = 0;
        for (std::size_t j = 0; j < 6; ++j)
          difference =
              std::max(difference, std::abs(std::remainder(root.joints(static_cast<vn::Index>(j)) - theirs[j] - zero[j],
                                                           2 * std::numbers::pi)));
        nearest = std::min(nearest, difference);
      }
      if (std::isfinite(theirs[1])) worst = std::max(worst, nearest);
    }
  }
  bench::require_agreement("closed forms", worst, 1e-6);
  program.measure("all joint values", "vernier", [=](std::size_t i) { return closed_form.roots(targets[i & mask]); });
  program.measure("all joint values", "OPW formulas", [=](std::size_t i) { return opw.solve(targets[i & mask]); });
  program.measure("all joint values", "vernier, any geometry",
                  [=](std::size_t i) { return general.roots(targets[i & mask]); });

  const Chain real = vn::with_geometric_errors(arm, {}, 3);
  const auto kdl = std::make_shared<Kdl>(kdl_chain(real));
  std::vector<KDL::Frame> kdl_targets;
  for (const vn::Isometry3& target : targets) {
    const vn::Matrix3 r = target.linear();
    const vn::Vector3 x = target.translation();
    kdl_targets.emplace_back(
        KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
        KDL::Vector(x(0), x(1), x(2)));
  }
  program.measure("all branches", "vernier",
                  [=](std::size_t i) { return vn::all_branches(closed_form, real, targets[i & mask]); });
  program.measure("all branches", "KDL LMA", [=, out = KDL::JntArray(6)](std::size_t i) mutable {
    for (const auto& root : closed_form.roots(targets[i & mask])) {
      kdl->lma.CartToJnt(kdl_joints(root.joints), kdl_targets[i & mask], out);
      benchmark::DoNotOptimize(out.data.data());
    }
    return 0;
  });

  vn::JointTerms terms(6);
  for (vn::Fourier& of_joint : terms.transmission) of_joint = vn::Fourier::up_to(60);
  vn::VectorX coefficients(terms.size());
  vn::Rng rng(4);
  for (double& c : coefficients) c = 5e-6 * rng.normal();
  using Model = vn::ErrorModel<Chain>;
  const Model model(arm, Model::Arm({real, vn::JointErrors(terms, coefficients)}));
  program.measure("all branches, joint-wise", "vernier",
                  [=](std::size_t i) { return vn::all_branches(closed_form, model, targets[i & mask]); });

  std::vector<vn::PathTarget<6>> path;
  const vn::Isometry3 centre = arm.pose(Joints(0.1, 0.3, 0.1, 0.2, 0.8, 0.1));
  for (int i = 0; i < 10000; ++i) {
    const double angle = 0.02 * i;
    path.push_back({.pose = centre, .motion = i == 0 ? vn::Motion::joint : vn::Motion::linear});
    path.back().pose.translation() += 0.1 * vn::Vector3(std::cos(angle) - 1, std::sin(angle), 1e-4 * i);
  }
  if (const auto solved = vn::correct_path(model, closed_form, path); solved.first_failure() != nullptr)
    throw std::runtime_error("a target of the path is not met");
  program.measure("path of 10,000", "vernier", [=](std::size_t) { return vn::correct_path(model, closed_form, path); });
}

int work(bench::Program& program, int argc, char** argv) {
  const Chain arm = vn::robots::abb_irb120().chain;
  if (!(arm == constexpr_arm)) throw std::runtime_error("the catalogue's arm is not the one in this program");
  const auto kdl = std::make_shared<Kdl>(kdl_chain(arm));

  // Joints of the region where the arm has no singularity, so that every solver has a fair target.
  constexpr std::size_t n = 1024;
  const vn::JointRows<6> many = vn::abb_irb120_operating_region().sample(arm, 10000, 1);
  vn::Rng rng(2);
  std::vector<Joints> joints(n), seeds(n);
  std::vector<vn::Isometry3> targets(n);
  std::vector<KDL::JntArray> kdl_q(n), kdl_seeds(n), kdl_many;
  std::vector<KDL::Frame> kdl_targets(n);
  for (std::size_t i = 0; i < n; ++i) {
    joints[i] = many.row(static_cast<vn::Index>(i)).transpose();
    seeds[i] = joints[i];
    for (auto& value : seeds[i]) value += rng.uniform(-0.05, 0.05);
    targets[i] = arm.pose(joints[i]);
    kdl_q[i] = kdl_joints(joints[i]);
    kdl_seeds[i] = kdl_joints(seeds[i]);
    kdl->forward.JntToCart(kdl_q[i], kdl_targets[i]);
  }
  for (vn::Index i = 0; i < many.rows(); ++i) kdl_many.push_back(kdl_joints(many.row(i).transpose()));

  vn::IkOptions<6> ik;
  ik.position_tolerance = ik.rotation_tolerance = Kdl::tolerance;

  // All compute the same?
  double pose = 0, jacobian = 0, parameters = 0;
  std::array<std::size_t, 3> solved{};
  for (std::size_t i = 0; i < n; ++i) {
    KDL::Jacobian theirs(6);
    kdl->derivative.JntToJac(kdl_q[i], theirs);
    pose = std::max(pose, difference(targets[i], kdl_targets[i]));
    jacobian = std::max(jacobian, (arm.jacobian(joints[i]) - theirs.data).cwiseAbs().maxCoeff());
    parameters = std::max(
        parameters, (arm.parameter_jacobian(joints[i]) - central_differences(arm, joints[i])).cwiseAbs().maxCoeff());
    KDL::JntArray by_lma(6), by_newton(6);
    kdl->lma.CartToJnt(kdl_seeds[i], kdl_targets[i], by_lma);
    kdl->newton.CartToJnt(kdl_seeds[i], kdl_targets[i], by_newton);
    const Joints answers[] = {vn::inverse_kinematics(arm, targets[i], seeds[i], ik).joints, by_lma.data,
                              by_newton.data};
    for (std::size_t who = 0; who < 3; ++who)
      if (difference(arm.pose(answers[who]), kdl_targets[i]) < 5 * Kdl::tolerance) ++solved[who];
  }
  // Cold starts, more of them than are timed.
  constexpr std::size_t many_colds = 10000;
  const vn::JointLimits<6> limits = vn::robots::abb_irb120().limits;
  vn::IkOptions<6> cold = ik;
  cold.restarts = 20;
  std::vector<Joints> cold_seeds(many_colds);
  std::vector<vn::Isometry3> cold_targets(many_colds);
  std::vector<KDL::JntArray> kdl_cold_seeds(many_colds);
  std::vector<KDL::Frame> kdl_cold_targets(many_colds);
  std::array<std::size_t, 3> solved_cold{};
  for (std::size_t i = 0; i < many_colds; ++i) {
    Joints q;
    for (int k = 0; k < 6; ++k) {
      q(k) = rng.uniform(limits.lower(k), limits.upper(k));
      cold_seeds[i](k) = rng.uniform(limits.lower(k), limits.upper(k));
    }
    cold_targets[i] = arm.pose(q);
    kdl_cold_seeds[i] = kdl_joints(cold_seeds[i]);
    kdl->forward.JntToCart(kdl_joints(q), kdl_cold_targets[i]);
    KDL::JntArray by_lma(6), by_newton(6);
    kdl->lma.CartToJnt(kdl_cold_seeds[i], kdl_cold_targets[i], by_lma);
    kdl->newton.CartToJnt(kdl_cold_seeds[i], kdl_cold_targets[i], by_newton);
    const Joints answers[] = {vn::inverse_kinematics(arm, cold_targets[i], cold_seeds[i], cold).joints, by_lma.data,
                              by_newton.data};
    for (std::size_t who = 0; who < 3; ++who)
      if (difference(arm.pose(answers[who]), kdl_cold_targets[i]) < 5 * Kdl::tolerance) ++solved_cold[who];
  }
  bench::require_agreement("poses", pose, 1e-12);
  bench::require_agreement("Jacobians", jacobian, 1e-12);
  bench::require_agreement("parameter Jacobians", parameters, 1e-8);

  constexpr std::size_t mask = n - 1;
  program.measure("pose", "vernier", [=](std::size_t i) { return arm.pose(joints[i & mask]); });
  program.measure("pose", "KDL", [=](std::size_t i) {
    KDL::Frame out;
    kdl->forward.JntToCart(kdl_q[i & mask], out);
    return out;
  });
  program.measure("pose", "vernier, constexpr table",
                  [=](std::size_t i) { return constexpr_arm.pose(joints[i & mask]); });

  program.measure("pose and jacobian", "vernier",
                  [=](std::size_t i) { return arm.pose_and_jacobian(joints[i & mask]); });
  program.measure("pose and jacobian", "KDL", [=, j = KDL::Jacobian(6)](std::size_t i) mutable {
    KDL::Frame out;
    kdl->forward.JntToCart(kdl_q[i & mask], out);
    kdl->derivative.JntToJac(kdl_q[i & mask], j);
    benchmark::DoNotOptimize(j.data.data());
    return out;
  });
  program.measure("pose and jacobian", "vernier, constexpr table",
                  [=](std::size_t i) { return constexpr_arm.pose_and_jacobian(joints[i & mask]); });

  program.measure("jacobian", "vernier", [=](std::size_t i) { return arm.jacobian(joints[i & mask]); });
  program.measure("jacobian", "KDL", [=, j = KDL::Jacobian(6)](std::size_t i) mutable {
    const int status = kdl->derivative.JntToJac(kdl_q[i & mask], j);
    benchmark::DoNotOptimize(j.data.data());
    return status;
  });

  program.measure("parameter jacobian", "vernier",
                  [=](std::size_t i) { return arm.parameter_jacobian(joints[i & mask]); });
  program.measure("parameter jacobian", "central differences",
                  [=](std::size_t i) { return central_differences(arm, joints[i & mask]); });

  program.measure("10,000 positions", "vernier", [=](std::size_t) { return vn::positions(arm, many); });
  program.measure("10,000 positions", "vernier, one by one", [=](std::size_t) {
    vn::PointRows out(many.rows(), 3);
    for (vn::Index i = 0; i < many.rows(); ++i) out.row(i) = arm.position(many.row(i).transpose()).transpose();
    return out;
  });
  program.measure("10,000 positions", "KDL", [=](std::size_t) {
    vn::PointRows out(many.rows(), 3);
    KDL::Frame frame;
    for (std::size_t i = 0; i < kdl_many.size(); ++i) {
      kdl->forward.JntToCart(kdl_many[i], frame);
      for (int k = 0; k < 3; ++k) out(static_cast<vn::Index>(i), k) = frame.p(k);
    }
    return out;
  });

  program.measure("10,000 poses", "vernier", [=](std::size_t) { return vn::poses(arm, many); });
  program.measure("10,000 poses", "vernier, one by one", [=](std::size_t) {
    std::vector<vn::Isometry3> out(static_cast<std::size_t>(many.rows()));
    for (vn::Index i = 0; i < many.rows(); ++i) out[static_cast<std::size_t>(i)] = arm.pose(many.row(i).transpose());
    return out;
  });

  // In blocks that stay in the cache, into storage that is used again: as identification does.
  constexpr vn::Index few = 100;
  std::vector<vn::JointRows<6>> blocks;
  for (vn::Index first = 0; first < many.rows(); first += few) blocks.emplace_back(many.middleRows(first, few));
  program.measure("10,000 jacobians", "vernier", [=, at = vn::PosesAndJacobians()](std::size_t) mutable {
    for (const auto& block : blocks) {
      at = vn::poses_and_jacobians(arm, block, std::move(at));
      benchmark::DoNotOptimize(at.jacobians.data());
    }
    return at.jacobians(0, 0);
  });
  program.measure("10,000 jacobians", "vernier, one by one", [=](std::size_t) {
    double sum = 0;
    for (vn::Index i = 0; i < many.rows(); ++i) {
      auto at = arm.pose_and_jacobian(many.row(i).transpose());
      benchmark::DoNotOptimize(at);
      sum += at.jacobian(0, 0);
    }
    return sum;
  });
  program.measure("10,000 jacobians", "KDL", [=, j = KDL::Jacobian(6)](std::size_t) mutable {
    KDL::Frame frame;
    for (const auto& q : kdl_many) {
      kdl->forward.JntToCart(q, frame);
      kdl->derivative.JntToJac(q, j);
      benchmark::DoNotOptimize(j.data.data());
    }
    return frame;
  });
  program.measure("10,000 parameter jacobians", "vernier", [=, at = vn::PosesAndJacobians()](std::size_t) mutable {
    for (const auto& block : blocks) {
      at = vn::poses_and_parameter_jacobians(arm, block, std::move(at));
      benchmark::DoNotOptimize(at.jacobians.data());
    }
    return at.jacobians(0, 0);
  });
  program.measure("10,000 parameter jacobians", "vernier, one by one", [=](std::size_t) {
    double sum = 0;
    for (vn::Index i = 0; i < many.rows(); ++i) {
      auto at = vn::pose_and_parameter_jacobian(arm, vn::JointVector<6>(many.row(i).transpose()));
      benchmark::DoNotOptimize(at);
      sum += at.jacobian(0, 0);
    }
    return sum;
  });

  measure_growth<2>(program);
  measure_growth<4>(program);
  measure_growth<6>(program);
  measure_growth<8>(program);
  measure_growth<10>(program);

  cold_targets.resize(n);
  measure_branches(program, arm, cold_targets);
  program.measure("inverse kinematics", "vernier",
                  [=](std::size_t i) { return vn::inverse_kinematics(arm, targets[i & mask], seeds[i & mask], ik); });
  program.measure("inverse kinematics", "KDL LMA", [=, out = KDL::JntArray(6)](std::size_t i) mutable {
    const int status = kdl->lma.CartToJnt(kdl_seeds[i & mask], kdl_targets[i & mask], out);
    benchmark::DoNotOptimize(out.data.data());
    return status;
  });
  program.measure("inverse kinematics", "KDL NR", [=, out = KDL::JntArray(6)](std::size_t i) mutable {
    const int status = kdl->newton.CartToJnt(kdl_seeds[i & mask], kdl_targets[i & mask], out);
    benchmark::DoNotOptimize(out.data.data());
    return status;
  });

  const char* from_anywhere = "inverse kinematics, cold";
  program.measure(from_anywhere, "vernier", [=](std::size_t i) {
    return vn::inverse_kinematics(arm, cold_targets[i & mask], cold_seeds[i & mask], cold);
  });
  program.measure(from_anywhere, "KDL LMA", [=, out = KDL::JntArray(6)](std::size_t i) mutable {
    const int status = kdl->lma.CartToJnt(kdl_cold_seeds[i & mask], kdl_cold_targets[i & mask], out);
    benchmark::DoNotOptimize(out.data.data());
    return status;
  });
  program.measure(from_anywhere, "KDL NR", [=, out = KDL::JntArray(6)](std::size_t i) mutable {
    const int status = kdl->newton.CartToJnt(kdl_cold_seeds[i & mask], kdl_cold_targets[i & mask], out);
    benchmark::DoNotOptimize(out.data.data());
    return status;
  });

  if (const int status = program.run(argc, argv); status != 0) return status;
  std::printf("\ninverse kinematics solved, of %zu: vernier %zu, KDL LMA %zu, KDL NR %zu\n", n, solved[0], solved[1],
              solved[2]);
  std::printf("cold, of %zu: vernier %zu, KDL LMA %zu, KDL NR %zu\n", many_colds, solved_cold[0], solved_cold[1],
              solved_cold[2]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
