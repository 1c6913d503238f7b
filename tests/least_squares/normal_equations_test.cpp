// The rows of an error model: their normal equations, leave-one-pose-out errors, priors and visit noise.

#include "vernier/identification/pose_system.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "vernier/identification/error_model_problem.hpp"
#include "vernier/identification/prior_objective.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

// SuiteSparse where the build has it, else Eigen's own
#if __has_include(<cholmod.h>)
#include <Eigen/CholmodSupport>
namespace {
using SparseSolver = Eigen::CholmodDecomposition<Eigen::SparseMatrix<double>, Eigen::Lower>;
}
#else
#include <Eigen/SparseCholesky>
namespace {
using SparseSolver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>;
}
#endif

namespace vernier::pose_system_test {
namespace {

using detail::FactorisedSystem;
using detail::Matrix6;
using detail::PoseNormalEquations;
using detail::PoseRows;
using detail::PoseSystem;
using detail::Rows6;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class M>
void fill(Rng& rng, M&& m, double size = 1) {
  for (Index j = 0; j < m.cols(); ++j)
    for (Index i = 0; i < m.rows(); ++i) m(i, j) = size * rng.normal();
}

VectorX random_vector(Rng& rng, Index n, double size = 1) {
  VectorX out(n);
  fill(rng, out, size);
  return out;
}

/// Poses that are nothing but random numbers.
struct RandomPoses {
  std::vector<Index> functions_of{4, 0, 6};
  Index dense = 5;
  std::vector<PoseRows> rows;

  /// @param plain whether roots and units are identities
  RandomPoses(Index poses, std::uint64_t seed, bool plain = true, Index dense_unknowns = 5) : dense(dense_unknowns) {
    Rng rng(seed);
    for (Index b = 0; b < poses; ++b) {
      PoseRows p;
      fill(rng, p.residual);
      p.dense.resize(6, dense);
      fill(rng, p.dense);
      p.joint.resize(6, 3);
      fill(rng, p.joint);
      p.functions.resize(10);
      fill(rng, p.functions);
      p.root.setIdentity();
      if (!plain) {
        fill(rng, p.root, 0.3);
        p.root.diagonal().array() += 1;
        p.unit = rng.uniform(0.01, 1);
      }
      rows.push_back(p);
    }
  }

  const PoseRows& row(Index b) const { return rows[static_cast<std::size_t>(b)]; }
  Index size() const { return static_cast<Index>(rows.size()); }
  Index unknowns() const { return dense + 10; }
  Rows6 expanded(Index b) const {
    Rows6 out(6, unknowns());
    row(b).expand(functions_of, out);
    return out;
  }
  template <class F>
  decltype(auto) with_system(F&& f) const {
    const auto get = [this](Index b, PoseRows& out) { out = row(b); };
    return f(PoseSystem{size(), size(), dense, functions_of, get});
  }
  PoseNormalEquations normal() const {
    return with_system([](const PoseSystem& s) { return PoseNormalEquations(s); });
  }
};

TEST(PoseRows, ExpandIsColumnTimesFunctions) {
  const RandomPoses poses(3, 1);
  for (Index b = 0; b < 3; ++b) {
    const PoseRows& p = poses.row(b);
    const Rows6 all = poses.expanded(b);
    EXPECT_EQ(all.leftCols(5), p.dense);
    for (Index k = 0; k < 10; ++k)  // joint 1 has four functions, joint 2 none, joint 3 six
      EXPECT_EQ(all.col(5 + k), p.joint.col(k < 4 ? 0 : 2) * p.functions(k));
  }
}

TEST(PoseNormalEquations, AreThoseOfTheExpandedRows) {
  // also more poses than are taken at once, and no dense unknowns
  for (const auto& [n, dense] : {std::pair<Index, Index>{15, 5}, {256, 5}, {600, 5}, {15, 0}}) {
    const RandomPoses poses(n, 2, true, dense);
    MatrixX jacobian(6 * n, poses.unknowns());
    VectorX residual(6 * n);
    for (Index b = 0; b < n; ++b) {
      jacobian.middleRows(6 * b, 6) = poses.expanded(b);
      residual.segment(6 * b, 6) = poses.row(b).residual;
    }
    const PoseNormalEquations normal = poses.normal();
    const MatrixX matrix = jacobian.transpose() * jacobian;
    const VectorX gradient = jacobian.transpose() * residual;
    EXPECT_LT((normal.matrix - matrix).norm(), 1e-12 * matrix.norm()) << n;
    EXPECT_LT((normal.gradient - gradient).norm(), 1e-12 * gradient.norm()) << n;
    EXPECT_NEAR(normal.cost, residual.squaredNorm(), 1e-12 * residual.squaredNorm()) << n;
    EXPECT_EQ(normal.matrix, normal.matrix.transpose());
  }
}

TEST(PoseNormalEquations, WithoutTransmissions) {
  RandomPoses poses(15, 3);
  poses.functions_of = {0, 0, 0};
  for (PoseRows& p : poses.rows) p.functions.resize(0);
  MatrixX matrix = MatrixX::Zero(5, 5);
  for (const PoseRows& p : poses.rows) matrix += p.dense.transpose() * p.dense;
  EXPECT_LT((poses.normal().matrix - matrix).norm(), 1e-12 * matrix.norm());
}

TEST(FactorisedSystem, StepEndsTheRegularisedProblem) {
  const RandomPoses poses(15, 4);
  Rng rng(5);
  const VectorX precisions = random_vector(rng, 15).cwiseAbs2(), steps = random_vector(rng, 15);
  const PoseNormalEquations normal = poses.normal();
  const FactorisedSystem solved(normal, precisions, steps);
  ASSERT_TRUE(solved.usable());
  const VectorX slope = normal.gradient + normal.matrix * solved.step + precisions.cwiseProduct(steps + solved.step);
  EXPECT_LT(slope.norm(), 1e-9 * normal.gradient.norm());
}

TEST(FactorisedSystem, WhatNothingDeterminesStays) {
  RandomPoses poses(15, 6);
  for (PoseRows& p : poses.rows) p.dense.col(2).setZero();
  const FactorisedSystem solved(poses.normal(), VectorX::Zero(15), VectorX::Zero(15));
  ASSERT_TRUE(solved.usable());
  EXPECT_EQ(solved.step(2), 0);
}

TEST(FactorisedSystem, ATightPriorHoldsItsOwnUnknownsAlone) {
  const RandomPoses poses(15, 19);
  VectorX precisions = VectorX::Zero(15);
  precisions.tail(10).setConstant(detail::nothing_left);
  const PoseNormalEquations normal = poses.normal();
  const FactorisedSystem solved(normal, precisions, VectorX::Zero(15));
  const VectorX alone = -Eigen::LLT<MatrixX>(normal.matrix.topLeftCorner(5, 5)).solve(normal.gradient.head(5));
  EXPECT_LT((solved.step.head(5) - alone).norm(), 1e-8 * alone.norm());
  EXPECT_LT(solved.step.tail(10).norm(), 1e-8);
}

/// Position error of a pose that took no part: the regularised problem solved again without it.
Vector3 left_out_by_force(const RandomPoses& poses, const VectorX& precisions, const VectorX& steps, Index without) {
  MatrixX matrix = precisions.asDiagonal();
  VectorX gradient = precisions.cwiseProduct(steps);
  for (Index b = 0; b < poses.size(); ++b) {
    if (b == without) continue;
    const MatrixX rows = poses.expanded(b);
    matrix += rows.transpose() * rows;
    gradient += rows.transpose() * poses.row(b).residual;
  }
  const VectorX step = -Eigen::LLT<MatrixX>(matrix).solve(gradient);
  const PoseRows& p = poses.row(without);
  return (p.root * (p.residual + poses.expanded(without) * step)).head<3>() * p.unit;
}

TEST(LeftOutErrors, AreThoseOfSolvingWithoutThePose) {
  // 70 poses at stride 1: more than are taken at once
  for (const auto& [n, stride] : {std::pair<Index, Index>{15, 1}, {15, 4}, {70, 1}, {70, 3}})
    for (const bool plain : {true, false}) {
      const RandomPoses poses(n, 7, plain);
      Rng rng(8);
      const VectorX precisions = VectorX::Constant(15, 0.5) + random_vector(rng, 15).cwiseAbs2();
      const VectorX steps = random_vector(rng, 15);
      const FactorisedSystem solved(poses.normal(), precisions, steps);
      const Eigen::Matrix3Xd errors =
          poses.with_system([&, every = stride](const PoseSystem& s) { return left_out_errors(s, solved, every); });
      ASSERT_EQ(errors.cols(), (n + stride - 1) / stride);
      for (Index k = 0; k < errors.cols(); ++k) {
        const Vector3 wanted = left_out_by_force(poses, precisions, steps, k * stride);
        EXPECT_LT((errors.col(k) - wanted).norm(), 1e-9 * wanted.norm()) << n << ", " << stride << ", " << k;
      }
    }
}

TEST(LeftOutErrors, AreInfiniteWhereNothingCouldBeSolved) {
  const RandomPoses poses(15, 9);
  const FactorisedSystem broken(poses.normal(), VectorX::Constant(15, nan), VectorX::Zero(15));
  EXPECT_FALSE(broken.usable());
  const Eigen::Matrix3Xd errors = poses.with_system([&](const PoseSystem& s) { return left_out_errors(s, broken, 2); });
  EXPECT_EQ(errors.cols(), 8);
  EXPECT_TRUE((errors.array() == infinity).all());
}

detail::PriorChoice chosen(const RandomPoses& poses) {
  return poses.with_system([&](const PoseSystem& s) {
    return choose_prior(s, PoseNormalEquations(s), VectorX::Constant(15, 1e-3), VectorX::Zero(15), 5, 10, 1);
  });
}

TEST(ChoosePrior, LeavesNothingOfNoise) {
  int nothing = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const detail::PriorChoice choice = chosen(RandomPoses(40, 100 + seed));
    nothing += choice.tightness == detail::nothing_left;
    EXPECT_LE(choice.best, choice.with);
    EXPECT_LE(choice.best, choice.without);
  }
  EXPECT_GE(nothing, 30);
}

TEST(ChoosePrior, KeepsASignal) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    RandomPoses poses(40, 200 + seed);
    Rng rng(seed);
    VectorX truth = random_vector(rng, 15);  // of the expected sizes, three times the noise in every row
    for (Index b = 0; b < 40; ++b) poses.rows[static_cast<std::size_t>(b)].residual -= poses.expanded(b) * truth;
    const detail::PriorChoice choice = chosen(poses);
    EXPECT_LE(choice.tightness, 10);
    EXPECT_LT(choice.with, 0.6 * choice.without);
    EXPECT_LE(choice.best, choice.with);
  }
}

TEST(ChoosePrior, ReportsTheErrorsOfItsChoice) {
  RandomPoses poses(40, 300);
  Rng rng(1);
  const VectorX truth = random_vector(rng, 15);
  for (Index b = 0; b < 40; ++b) poses.rows[static_cast<std::size_t>(b)].residual -= poses.expanded(b) * truth;
  const detail::PriorChoice choice = chosen(poses);
  const auto mean_with = [&](double tightness) {
    VectorX precisions = VectorX::Constant(15, 1e-3);
    precisions.tail(10).setConstant(tightness);
    double sum = 0;
    for (Index b = 0; b < 40; ++b) sum += left_out_by_force(poses, precisions, VectorX::Zero(15), b).norm();
    return sum / 40;
  };
  EXPECT_NEAR(choice.with, mean_with(choice.tightness), 1e-9 * choice.with);
  EXPECT_NEAR(choice.without, mean_with(1e20), 1e-6 * choice.without);  // nothing left is nearly none at all
}

TEST(ChoosePrior, SurvivesRowsThatAreNotFinite) {
  for (const double bad : {nan, infinity, -infinity})
    for (const int part : {0, 1, 2, 3}) {
      RandomPoses poses(15, 10);
      PoseRows& p = poses.rows[6];
      if (part == 0) p.residual(1) = bad;
      if (part == 1) p.dense(2, 3) = bad;
      if (part == 2) p.joint(0, 2) = bad;
      if (part == 3) p.functions(0) = bad;
      EXPECT_EQ(chosen(poses).tightness, detail::nothing_left) << bad << " in part " << part;
    }
}

/// Visits whose joints and position are off by normal errors.
std::vector<detail::LeftOutVisit> visits(double position, double joint, double model, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<detail::LeftOutVisit> out;
  for (int i = 0; i < 2000; ++i) {
    Eigen::Matrix<double, 3, 6> jacobian;
    fill(rng, jacobian, 0.4);
    Matrix3 root;
    fill(rng, root, model);
    out.push_back(
        {jacobian * random_vector(rng, 6, joint) + root * random_vector(rng, 3) + random_vector(rng, 3, position),
         root * root.transpose(), jacobian * jacobian.transpose()});
  }
  return out;
}

/// The joints with terms are the first and the last; two of the dense unknowns are elastic.
TEST(PriorObjective, IsTheErrorOfPosesLeftOutWithThePriorsItNames) {
  const RandomPoses poses(40, 21, false);
  const PoseNormalEquations normal = poses.normal();
  const VectorX before = VectorX::LinSpaced(15, 1, 2), steps = VectorX::Zero(15);
  const VectorX relative = (VectorX(10) << 1, 1, 0.5, 0.5, 1, 1, 0.5, 0.5, 0.25, 0.25).finished();
  poses.with_system([&](const PoseSystem& system) {
    const PriorObjective objective(system, normal, before, steps, 2, relative, 3);
    ASSERT_EQ(objective.dimension(), 4);  // elastic, two joints, exponent
    EXPECT_NO_THROW(objective.box().validate());
    const Eigen::Vector4d at(1, 2, -1, 1.5);
    const VectorX precisions = objective.precisions(at);
    EXPECT_EQ(precisions.head(3), before.head(3));  // of geometry
    EXPECT_DOUBLE_EQ(precisions(3), 10);
    EXPECT_DOUBLE_EQ(precisions(4), 10);
    EXPECT_DOUBLE_EQ(precisions(5), 100);          // a first harmonic
    EXPECT_DOUBLE_EQ(precisions(7), 100 / 0.5);    // the second: its amplitude falls by 2^-0.5 more than it did
    EXPECT_DOUBLE_EQ(precisions(9), 0.1);          // the last joint
    EXPECT_DOUBLE_EQ(precisions(14), 0.1 / 0.25);  // its fourth
    const FactorisedSystem solved(normal, precisions, steps);
    const double expected = left_out_errors(system, solved, 3).colwise().norm().mean();
    EXPECT_DOUBLE_EQ(objective.error(precisions), expected);
    MatrixX population(4, 2);
    population << Eigen::Vector4d::Zero(), at;
    VectorX fitness(2);
    objective(population, fitness);
    EXPECT_DOUBLE_EQ(fitness(1), expected);
    EXPECT_NE(fitness(0), expected);
  });
}

TEST(LeftOutErrors, OfThoseJudgedAlone) {
  const RandomPoses poses(20, 5, false);
  const FactorisedSystem solved(poses.normal(), VectorX::Ones(15), VectorX::Zero(15));
  poses.with_system([&](PoseSystem system) {
    const Eigen::Matrix3Xd all = left_out_errors(system, solved, 2);
    system.judged = 7;
    const Eigen::Matrix3Xd some = left_out_errors(system, solved, 2);
    ASSERT_EQ(some.cols(), 4);
    EXPECT_EQ(some, all.leftCols(4));
  });
}

TEST(VisitNoise, TellsSpaceFromJoints) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const detail::VisitNoise noise = detail::visit_noise(visits(30e-6, 40e-6, 15e-6, seed));
    EXPECT_NEAR(noise.position, 30e-6, 3e-6) << seed;
    EXPECT_NEAR(noise.joint, 40e-6, 4e-6) << seed;
  }
}

TEST(VisitNoise, FindsOneAlone) {
  const detail::VisitNoise space = detail::visit_noise(visits(30e-6, 0, 0, 4));
  EXPECT_NEAR(space.position, 30e-6, 3e-6);
  EXPECT_LT(space.joint, 10e-6);  // in space: below 10 um of 30
  const detail::VisitNoise joints = detail::visit_noise(visits(0, 40e-6, 0, 5));
  EXPECT_LT(joints.position, 4e-6);
  EXPECT_NEAR(joints.joint, 40e-6, 4e-6);
}

TEST(VisitNoise, NoneInNothing) {
  const detail::LeftOutVisit exact{Vector3::Zero(), Matrix3::Zero(), Matrix3::Identity()};
  for (const std::size_t n : {0, 2}) {
    const detail::VisitNoise none = detail::visit_noise(std::vector<detail::LeftOutVisit>(n, exact));
    EXPECT_EQ(none.position, 0);
    EXPECT_EQ(none.joint, 0);
  }
}

using Chain = DhChain<6>;
using Problem = detail::ErrorModelProblem<Chain>;

/// An arm with every kind of joint error, measured from two places of which only the first sees orientations.
struct Measured {
  Robot<6> robot = robots::abb_irb120();
  Dataset<6> first, second;

  explicit Measured(Index poses) {
    const Chain actual = with_geometric_errors(robot.chain, {}, 12);
    // orientations are far off: so is the derivative of the logarithm from the identity
    first = measure(Framed<Chain>(actual, start_base(0), tool), sample_joints(robot.limits, poses, 13),
                    {.position = 1e-3, .orientation = 0.3}, 14);
    second = measure(Framed<Chain>(actual, start_base(1), tool), sample_joints(robot.limits, poses / 2, 15),
                     {.position = 1e-3, .with_orientations = false}, 16);
  }

  FrameParameters tool{Vector6{0.02, -0.1, 0.15, 0.3, -0.2, 0.5}};
  static FrameParameters start_base(int station) {
    return FrameParameters(station == 0 ? Vector6{0.5, -1, 0.2, 0.3, -0.8, 1.5} : Vector6{-2, 0.3, 1, -1.1, 0.2, 0.7});
  }

  /// Chain, tool and both bases free, and every joint error; away from where it started.
  /// @param size of the units
  Problem problem(double joint_sigma, double size) const {
    std::vector<detail::GeometricUnknown> unknowns;
    for (int k = 0; k < 6; ++k)
      for (const int station : {0, 1}) unknowns.push_back({k, station, size, 0.5});
    for (Index k = 6; k < Framed<Chain>::num_parameters; ++k)
      unknowns.push_back({k, -1, size * (1 + 0.1 * static_cast<double>(k)), 2});
    detail::ErrorModelDesign<Chain> design(
        {Framed<Chain>(robot.chain, start_base(0), tool), Framed<Chain>(robot.chain, start_base(1), tool)}, unknowns);
    JointTerms<Chain> terms;
    terms.gear_ratio = terms.coupling = true;
    terms.gravity.emplace(robot.chain, Vector3(0.6, 0, -0.8));
    terms.transmission = {Fourier{3}, JointNodes::spread(4, -2, 2), Fourier{0}, Fourier{1}, Fourier{2}, Fourier{12}};
    Rng rng(17);
    const VectorX sizes = size * (VectorX::Ones(terms.size()) + random_vector(rng, terms.size()).cwiseAbs());
    design.set_terms(terms, sizes, VectorX::Constant(terms.size(), 3));
    design.move(random_vector(rng, design.size(), 1e-3 / size));
    return {std::move(design),
            {{&first, nullptr, true, 0.03e-3, 0.1e-3, joint_sigma},
             {&second, nullptr, false, 0.05e-3, 0.1e-3, joint_sigma}},
            Loss::squared};
  }
};

Rows6 expanded(const Problem& problem, Index pose, PoseRows& rows) {
  problem.rows_of(pose, rows);
  Rows6 out(6, problem.design.size());
  rows.expand(problem.design.functions_of(), out);
  return out;
}

TEST(ErrorModelProblem, ResidualIsModelMinusMeasuredInSigmas) {
  const Measured measured(8);
  const Problem problem = measured.problem(0, 1e-3);
  ASSERT_EQ(problem.poses(), 12);
  EXPECT_EQ(problem.measured_values(), 8 * 6 + 4 * 3);
  PoseRows rows;
  for (Index b = 0; b < 12; ++b) {
    problem.rows_of(b, rows);
    const bool first = b < 8;
    const Dataset<6>& data = first ? measured.first : measured.second;
    const Index i = first ? b : b - 8;
    const Isometry3 pose = problem.design.arm(first ? 0 : 1).pose(data.joints(i));
    const double sigma = first ? 0.03e-3 : 0.05e-3;
    EXPECT_LT((rows.residual.head<3>() - (pose.translation() - data.position(i)) / sigma).norm(), 1e-9);
    EXPECT_DOUBLE_EQ(rows.unit, sigma);
    EXPECT_EQ(rows.root, Matrix6::Identity());
    if (first)
      EXPECT_LT((rows.residual.tail<3>() - pose_difference(pose, data.pose(i)).tail<3>() / 0.1e-3).norm(), 1e-9);
    else
      EXPECT_TRUE(rows.residual.tail<3>().isZero(0) && rows.dense.bottomRows<3>().isZero(0) &&
                  rows.joint.bottomRows<3>().isZero(0));
  }
}

TEST(ErrorModelProblem, RowsAreCentralDifferences) {
  const Measured measured(8);
  const Problem problem = measured.problem(0, 1e-3);
  const Index size = problem.design.size();
  ASSERT_EQ(size, 12 + 36 + 6 + 5 + 21 + 6 + 4 + 0 + 2 + 4 + 24);
  constexpr double step = 0.03;  // of a size: rounding and curvature both stay below 1e-8
  std::vector<Rows6> analytic, numeric(12, Rows6(6, size));
  PoseRows rows;
  for (Index b = 0; b < 12; ++b) analytic.push_back(expanded(problem, b, rows));
  for (Index k = 0; k < size; ++k) {
    Problem above = problem, below = problem;
    above.design.move(step * VectorX::Unit(size, k));
    below.design.move(-step * VectorX::Unit(size, k));
    for (std::size_t b = 0; b < 12; ++b) {
      above.rows_of(static_cast<Index>(b), rows);
      const Vector6 high = rows.residual;
      below.rows_of(static_cast<Index>(b), rows);
      numeric[b].col(k) = (high - rows.residual) / (2 * step);
    }
  }
  const auto names = problem.design.names();
  for (std::size_t b = 0; b < 12; ++b)
    for (Index k = 0; k < size; ++k)
      for (const int part : {0, 3}) {
        const Vector3 a = analytic[b].col(k).segment<3>(part), n = numeric[b].col(k).segment<3>(part);
        EXPECT_LT((a - n).norm(), 1e-7 * (1 + n.norm())) << "pose " << b << ", " << names[static_cast<std::size_t>(k)];
      }
  // every geometric unknown is seen, those of a station's base from there alone
  for (Index k = 0; k < 48; ++k) {
    double first = 0, second = 0;
    for (std::size_t b = 0; b < 12; ++b) (b < 8 ? first : second) += analytic[b].col(k).norm();
    EXPECT_EQ(first > 0, k >= 12 || k % 2 == 0) << k;
    EXPECT_EQ(second > 0, k >= 12 ? k < 45 : k % 2 == 1) << k;  // positions do not see how the tool is turned
  }
}

TEST(ErrorModelProblem, JointNoiseWhitensWhatItAdds) {
  const Measured measured(8);
  constexpr double sigma = 0.2e-3;
  const Problem exact = measured.problem(0, 1e-3), noisy = measured.problem(sigma, 1e-3);
  PoseRows a, b;
  for (Index i = 0; i < exact.poses(); ++i) {
    exact.rows_of(i, a);
    noisy.rows_of(i, b);
    const Matrix6 covariance = Matrix6::Identity() + sigma * sigma * a.joint * a.joint.transpose();
    EXPECT_LT((b.root * b.root.transpose() - covariance).norm(), 1e-12 * covariance.norm());
    EXPECT_LT((b.root * b.residual - a.residual).norm(), 1e-12 * a.residual.norm());
    EXPECT_LT((b.root * b.dense - a.dense).norm(), 1e-12 * a.dense.norm());
    EXPECT_LT((b.root * b.joint - a.joint).norm(), 1e-12 * a.joint.norm());
    EXPECT_EQ(b.functions, a.functions);
    EXPECT_EQ(b.unit, a.unit);
  }
}

TEST(ErrorModelProblem, ErrorsInVariablesAreThoseOfTheFullSparseSystem) {
  const Measured measured(30);
  constexpr double sigma = 0.2e-3;  // moves a pose by as much as the sensor errs, and more
  const Problem exact = measured.problem(0, 0.1e-3), noisy = measured.problem(sigma, 0.1e-3);
  const Index p = exact.design.size(), n = exact.poses(), all = p + 6 * n;
  const VectorX steps = noisy.design.steps();
  VectorX precisions = noisy.design.precisions();
  const PoseNormalEquations normal = noisy.with_system([](const PoseSystem& s) { return PoseNormalEquations(s); });
  const FactorisedSystem reduced(normal, precisions, steps);
  ASSERT_TRUE(reduced.usable());
  const FactorisedSystem without(exact.with_system([](const PoseSystem& s) { return PoseNormalEquations(s); }),
                                 precisions, steps);
  ASSERT_GT((reduced.step - without.step).norm(), 0.1 * without.step.norm());  // joint noise matters here

  // unknowns: those of the design, then six joint errors a pose in units of sigma
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Index row, Index column, const MatrixX& block) {
    for (Index j = 0; j < block.cols(); ++j)
      for (Index i = 0; i < block.rows(); ++i)
        if (row + i >= column + j)
          entries.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
  };
  VectorX gradient = VectorX::Zero(all);
  gradient.head(p) = precisions.cwiseProduct(steps);
  const double ridge = 1e-12 * normal.matrix.diagonal().maxCoeff();  // as in the reduced system
  add(0, 0, MatrixX((precisions.array() + ridge).matrix().asDiagonal()));
  PoseRows rows;
  for (Index b = 0; b < n; ++b) {
    const MatrixX own = expanded(exact, b, rows), joint = sigma * rows.joint;
    const Index at = p + 6 * b;
    add(0, 0, own.transpose() * own);
    add(at, 0, joint.transpose() * own);
    add(at, at, MatrixX::Identity(6, 6) + joint.transpose() * joint);
    gradient.head(p) += own.transpose() * rows.residual;
    gradient.segment(at, 6) = joint.transpose() * rows.residual;
  }
  Eigen::SparseMatrix<double> matrix(static_cast<int>(all), static_cast<int>(all));
  matrix.setFromTriplets(entries.begin(), entries.end());
  const SparseSolver solver(matrix);
  ASSERT_EQ(solver.info(), Eigen::Success);
  const VectorX step = -VectorX(solver.solve(gradient)).head(p);
  EXPECT_LT((reduced.step - step).norm(), 1e-8 * step.norm());
}

}  // namespace
}  // namespace vernier::pose_system_test
