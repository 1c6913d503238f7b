// SPDX-License-Identifier: BSD-3-Clause
// The contract of docs/architecture.md, word for word, on a file of simulated poses: it compiles, and does what it
// says.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vernier/ceres.hpp>
#include <vernier/vernier.hpp>

#include "allocation_counter.hpp"

namespace vn = vernier;
using namespace vernier::literals;

namespace {

// A robot is a table. N is a compile-time constant, the convention a type.
constexpr vn::DhChain<6> arm{{{
    {.a = 0_mm, .alpha = -90_deg, .d = 290_mm, .theta = 0_deg},
    {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
    {.a = 70_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = 90_deg, .d = 302_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg},
}}};

/// The arm as built: geometric errors, and two joints that sag by an amount no geometry explains.
struct ActualArm {
  static constexpr int dof = 6;
  static constexpr double sag = 2e-3;  // [rad]
  vn::DhChain<6> chain = vn::with_geometric_errors(arm, {}, 7);

  static vn::JointVector<6> effective(vn::JointVector<6> q) noexcept {
    for (const int j : {1, 2}) q(j) += sag * std::sin(2 * q(j));
    return q;
  }
  vn::Isometry3 pose(const vn::JointVector<6>& q) const noexcept { return chain.pose(effective(q)); }
  vn::Vector3 position(const vn::JointVector<6>& q) const noexcept { return chain.position(effective(q)); }
  vn::Jacobian<6> jacobian(const vn::JointVector<6>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
  vn::PoseAndJacobian<6> pose_and_jacobian(const vn::JointVector<6>& q) const noexcept {
    auto out = chain.pose_and_jacobian(effective(q));
    for (const int j : {1, 2}) out.jacobian.col(j) *= 1 + 2 * sag * std::cos(2 * q(j));
    return out;
  }
};

/// A folder with poses.csv in it, the working directory for as long as this lives.
class MeasuredPoses {
 public:
  MeasuredPoses()
      : back_(std::filesystem::current_path()),
        folder_(std::filesystem::temp_directory_path() / ("vernier_contract_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    std::filesystem::current_path(folder_);
    // few poses, so that the search takes seconds: half the width of the operating region, no noise
    auto region = vn::abb_irb120_operating_region();
    const vn::JointVector<6> centre = (region.limits.lower + region.limits.upper) / 2;
    region.limits.lower = (region.limits.lower + centre) / 2;
    region.limits.upper = (region.limits.upper + centre) / 2;
    vn::write_dataset<6>("poses.csv",
                         vn::measure(ActualArm{}, region.sample(arm, 150, 1), {.with_orientations = false}));
  }
  ~MeasuredPoses() {
    std::error_code ignored;
    std::filesystem::current_path(back_, ignored);
    std::filesystem::remove_all(folder_, ignored);
  }
  MeasuredPoses(const MeasuredPoses&) = delete;
  MeasuredPoses& operator=(const MeasuredPoses&) = delete;

 private:
  std::filesystem::path back_, folder_;
};

TEST(Contract, TheTableIsTheCataloguesArm) { EXPECT_TRUE(arm == vn::robots::abb_irb120().chain); }

TEST(Contract, CompilesAndDoesWhatItSays) {
  const MeasuredPoses here;

  const auto data = vn::read_dataset<6>("poses.csv");
  const auto [train, test] = vn::split(data, {.test_fraction = 0.2, .seed = 1});
  ASSERT_EQ(train.size(), 120);
  ASSERT_EQ(test.size(), 30);

  const vn::Tuned pso_elm{vn::Elm{.hidden_nodes = 65}, vn::Pso{.particles = 50, .iterations = 300}};
  const auto learned = vn::CartesianCompensation{pso_elm}.fit(arm, train, {.seed = 1});

  const auto identified = vn::identify(arm, train, {.frames = vn::Frames::base_and_tool});  // Ceres
  const auto hybrid = vn::CartesianCompensation{pso_elm}.fit(identified.model, train, {.seed = 1});

  const vn::JointVector<6> target = test.joints(0);
  const vn::JointVector<6> command = hybrid.correct(target).command;  // no allocation, noexcept
  const vn::ErrorStatistics e = vn::prediction_error(hybrid, test);   // e.mean, e.rms, e.max, e.min, e.p95 [m]

  // Each stage is better than the one before, by a margin.
  const double nominal = vn::prediction_error(arm, test).mean;
  const double cartesian = vn::prediction_error(learned, test).mean;
  const double geometry = vn::prediction_error(identified.model, test).mean;
  EXPECT_GT(nominal, 1e-3);
  EXPECT_LT(cartesian, 0.2 * nominal);
  EXPECT_LT(geometry, 0.7 * cartesian);
  EXPECT_LT(e.mean, 0.5 * geometry);
  EXPECT_LT(e.mean, 0.06e-3);
  EXPECT_EQ(e.n, test.size());
  EXPECT_LE(e.min, e.median);
  EXPECT_LE(e.median, e.p95);
  EXPECT_LE(e.p95, e.max);
  EXPECT_LE(e.mean, e.rms);
  EXPECT_TRUE(identified.converged()) << identified.summary();

  // The command brings the actual arm to where the nominal one, in the identified frames, would be.
  const vn::Vector3 wanted = identified.model.nominal().position(target);
  EXPECT_GT((ActualArm{}.position(target) - wanted).norm(), 0.5e-3);
  EXPECT_LT((ActualArm{}.position(command) - wanted).norm(), 0.15e-3);

  static_assert(noexcept(hybrid.correct(target)));
  static_assert(vn::Compensator<decltype(hybrid)> && vn::KinematicModel<decltype(hybrid)>);
  EXPECT_EQ(vernier_test::allocations([&] { vernier_test::keep(hybrid.correct(target)); }), 0);
  EXPECT_EQ(vernier_test::allocations([&] { vernier_test::keep(hybrid.predict(target)); }), 0);
  EXPECT_EQ(vernier_test::allocations([&] { vernier_test::keep(learned.pose_and_jacobian(target)); }), 0);
}

}  // namespace
