#include "vernier/identification/identifiability.hpp"

#include <gtest/gtest.h>

#include "vernier/core/rng.hpp"
#include "vernier/identification/plan.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::identifiability_test {
namespace {

MatrixX random_matrix(Index rows, Index columns, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, columns);
  for (auto& x : out.reshaped()) x = rng.normal();
  return out;
}

TEST(IndependentColumns, KeepsTheFirstOfDependentOnesAndNamesWhatAbsorbsTheRest) {
  MatrixX j = random_matrix(30, 6, 1);
  j.col(3) = 2 * j.col(0) - j.col(2);
  j.col(4).setZero();
  const detail::IndependentColumns columns(j);
  EXPECT_EQ(columns.kept, (std::vector<Index>{0, 1, 2, 5}));
  ASSERT_EQ(columns.dependent.size(), 2u);
  EXPECT_EQ(columns.dependent[0].column, 3);
  EXPECT_EQ(columns.dependent[0].absorbed_by, (std::vector<Index>{0, 2}));
  EXPECT_EQ(columns.dependent[1].column, 4);
  EXPECT_TRUE(columns.dependent[1].absorbed_by.empty());
}

TEST(IndependentColumns, MoreColumnsThanRows) {
  EXPECT_EQ(detail::IndependentColumns(random_matrix(4, 9, 2)).kept.size(), 4u);
}

TEST(Precision, EqualsTheTextbookCovariance) {
  const MatrixX j = random_matrix(40, 5, 3);
  const detail::Precision p(j, VectorX::Constant(40, 0.25), VectorX::Zero(5));
  const MatrixX expected = 0.25 * (j.transpose() * j).inverse();
  EXPECT_LT((p.covariance - expected).norm() / expected.norm(), 1e-12);
  EXPECT_EQ(p.rank, 5);
  const VectorX s = Eigen::JacobiSVD<MatrixX>(j).singularValues();
  EXPECT_NEAR(p.condition, s(0) / s(4), 1e-10);
}

TEST(Precision, SaysWhenTheRankIsDeficient) {
  MatrixX j = random_matrix(40, 3, 4);
  j.col(2) = j.col(0) + j.col(1);
  const detail::Precision p(j, VectorX::Ones(40), VectorX::Zero(3));
  EXPECT_EQ(p.rank, 2);
  EXPECT_TRUE(std::isinf(p.condition));
  EXPECT_EQ(p.covariance.size(), 0);
  EXPECT_EQ(detail::Precision(j, VectorX::Ones(40), VectorX::Constant(3, 1.0)).covariance.rows(), 3);
}

TEST(LeaveOnePoseOut, EqualsBruteForceRefits) {
  const Index poses = 12, columns = 5;
  for (const Index parts : {1, 2}) {  // positions, and positions with orientations
    detail::Linearisation at;
    at.jacobian = random_matrix(3 * parts * poses, columns, 5);
    const VectorX y = random_matrix(3 * parts * poses, 1, 6);
    const VectorX prior = VectorX::Constant(columns, 0.3);
    const auto fit = [&](const MatrixX& j, const VectorX& t) {
      return VectorX((j.transpose() * j + MatrixX(prior.asDiagonal())).ldlt().solve(j.transpose() * t));
    };
    at.residuals = y - at.jacobian * fit(at.jacobian, y);
    double sum = 0;
    for (Index b = 0; b < poses; ++b) {
      MatrixX j = at.jacobian;
      VectorX t = y;
      for (Index part = 0; part < parts; ++part) {
        j.middleRows(3 * (part * poses + b), 3).setZero();
        t.segment(3 * (part * poses + b), 3).setZero();
      }
      sum += (y.segment<3>(3 * b) - at.jacobian.middleRows<3>(3 * b) * fit(j, t)).squaredNorm();
    }
    const detail::Precision precision(at.jacobian, VectorX::Ones(y.size()), prior);
    EXPECT_NEAR(detail::leave_one_pose_out(at, poses, precision.inverse), std::sqrt(sum / poses), 1e-10);
  }
}

TEST(ParallelRows, AreFoundWhereConsecutiveAxesAreParallel) {
  EXPECT_EQ(parallel_rows(robots::ur10().chain), (std::vector<int>{1, 2}));
  EXPECT_EQ(parallel_rows(robots::abb_irb120().chain), (std::vector<int>{1}));
  EXPECT_EQ(parallel_rows(robots::puma560().chain), (std::vector<int>{1}));
  EXPECT_EQ(parallel_rows(robots::puma560_modified().chain), (std::vector<int>{2}));
  EXPECT_TRUE(parallel_rows(robots::barrett_wam().chain).empty());
}

TEST(Linearisation, JacobianEqualsCentralDifferences) {
  using Arm = Framed<DhChain<6>>;
  const auto robot = robots::ur10();
  const Arm arm(robot.chain, FrameParameters(Vector6{1, 2, 3, 0.3, -0.4, 0.5}),
                FrameParameters(Vector6{0.01, 0.02, 0.1, 0.1, 0.2, -0.3}));
  const auto joints = sample_joints(robot.limits, 53, 1);
  const auto data = measure(with_geometric_errors(robot.chain, {}, 1), joints);  // far off: the logarithm is bent
  std::vector<Index> free(Arm::num_parameters);
  for (std::size_t k = 0; k < free.size(); ++k) free[k] = static_cast<Index>(k);
  const VectorX sizes = VectorX::Constant(Arm::num_parameters, 1e-2);
  const auto at = [&](const Arm& model, bool with_jacobian) {
    detail::Linearisation out;
    out.evaluate(model, data, true, 1e-3, 1e-2, free, sizes, with_jacobian);
    return out;
  };
  const detail::Linearisation exact = at(arm, true);
  const double h = 1e-6;
  for (Index k = 0; k < Arm::num_parameters; ++k) {
    auto up = arm.parameters(), down = up;
    up(k) += h;
    down(k) -= h;
    const VectorX difference =
        (at(arm.with_parameters(up), false).residuals - at(arm.with_parameters(down), false).residuals) *
        (1e-2 / (2 * h));
    EXPECT_LT((difference - exact.jacobian.col(k)).norm(), 1e-6 * (1 + exact.jacobian.col(k).norm())) << k;
  }
}

}  // namespace
}  // namespace vernier::identifiability_test
