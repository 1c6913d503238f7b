// SPDX-License-Identifier: BSD-3-Clause
// Whether errors of an arm identified from contacts are as large as their standard deviations, where sockets and joints
// have errors that many touches share.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "contact_consistency.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/touches.hpp"

namespace vernier::contact_uncertainty_test {
namespace {

using Actual = Framed<WithJointErrors<DhChain<6>>>;

const FrameParameters probe(Vector6{0.04, -0.02, 0.1, 0, 0, 0});

/// Touches of the two sockets of each of six bars, 32 a socket. The sockets of a bar are 50 mm apart. Each is off its
/// place by an error of its own, which all its touches share.
std::vector<Contact> bars(const Actual& arm, double socket_sigma, std::uint64_t seed) {
  const JointLimits<6>& limits = abb_irb120_operating_region().limits;
  std::vector<Contact> out;
  for (int bar = 0; bar < 6; ++bar) {
    Rng rng(child_seed(seed, 100 + static_cast<std::uint64_t>(bar)));
    const Vector3 place(0.3 + 0.08 * (bar % 2), -0.15 + 0.15 * (bar % 3), 0.3 + 0.1 * (bar % 2));
    const Vector3 along = Vector3(std::cos(bar), std::sin(bar), 0.2).normalized();
    MatrixX joints(64, 6);
    VectorX offsets(64);
    for (int socket = 0; socket < 2; ++socket) {
      const Vector3 error(rng.normal(), rng.normal(), rng.normal());
      const VirtualObject object{ContactKind::socket, place + 0.05 * socket * along + socket_sigma * error, along};
      const Contact touches = touch(arm, object, "socket", VectorX::Zero(32), limits, 0.05e-3,
                                    child_seed(seed, static_cast<std::uint64_t>(2 * bar + socket)));
      joints.middleRows(32 * socket, 32) = touches.joints();
      offsets.segment(32 * socket, 32).setConstant(0.05 * socket);
    }
    out.emplace_back("bar " + std::to_string(bar), ContactKind::socket, std::move(joints), std::move(offsets));
  }
  return out;
}

struct Found {
  vernier_test::NormalisedSquares errors;
  double object_sigma = 0, joint_sigma = 0;  // means
};

/// Errors of twenty arms, of the parameters that touches determine; the others are as designed.
Found twenty_arms(double socket_sigma, double harmonic) {
  const DhChain<6> designed = robots::abb_irb120().chain;
  const Framed<DhChain<6>> nominal(designed, {}, probe);
  const auto exact = [&](const ArmGeometry& arm, std::uint64_t seed) {
    const Framed<DhChain<6>> framed = arm.framed(designed);
    const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = harmonic, .harmonics = 3};
    return Actual({framed.model(), draw_joint_errors(framed.model(), sizes, seed)}, framed.base_frame(),
                  framed.tool_frame());
  };
  const std::vector<Index> free = identify_by_contacts(nominal, bars(exact(ArmGeometry(nominal), 1), 0, 1)).free;
  Found out;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(child_seed(seed, 5));
    VectorX actual = ArmGeometry(nominal).parameters();
    for (const Index k : free) actual(k) += (k < ArmParameters::chain_end(6) ? 0.7e-3 : 3e-3) * rng.normal();
    const Actual arm = exact(ArmGeometry(nominal).with_parameters(actual), seed);
    const auto found =
        identify_by_contacts(nominal, bars(arm, socket_sigma, seed), {.frames = Frames::tool}, {.loss = Loss::huber});
    const auto n = static_cast<Index>(found.free.size());
    VectorX error(n), prior(n);
    for (Index i = 0; i < n; ++i) {
      const Index k = found.free[static_cast<std::size_t>(i)];
      const ParameterEstimate& p = found.parameters[static_cast<std::size_t>(k)];
      error(i) = p.identified - actual(k);
      prior(i) = vernier_test::prior_of(p);
    }
    add_differences(error, found.covariance, prior, out.errors);
    out.object_sigma += found.object_sigma / 20;
    out.joint_sigma += found.joint_sigma / 20;
  }
  return out;
}

TEST(ContactUncertainty, HasTheErrorsOfSockets) {
  const Found found = twenty_arms(0.05e-3, 0);
  EXPECT_GT(found.errors.count, 200);
  EXPECT_GT(found.errors.rms(), 0.9);
  EXPECT_LT(found.errors.rms(), 1.1);
  EXPECT_NEAR(found.object_sigma, 0.05e-3, 0.015e-3);
  EXPECT_LT(found.joint_sigma, 0.04e-3);  // there are none, 0.2 mrad are expected
}

TEST(ContactUncertainty, HasTheErrorsOfJoints) {
  const Found found = twenty_arms(0.05e-3, 0.2e-3);
  EXPECT_GT(found.errors.rms(), 0.9);
  EXPECT_LT(found.errors.rms(), 1.1);
  EXPECT_NEAR(found.joint_sigma, 0.2e-3, 0.04e-3);
}

// Arms that an earlier calibration knows, with errors as its covariance says, and a few touches of two bars.
TEST(ContactUncertainty, OfAnEarlierCalibrationAndTouchesIsThatOfBoth) {
  const DhChain<6> designed = robots::abb_irb120().chain;
  const Framed<DhChain<6>> nominal(designed, {}, probe);
  KnownGeometry known{.name = "earlier"};
  const Actual exact(WithJointErrors<DhChain<6>>(designed), nominal.base_frame(), nominal.tool_frame());
  for (const Index k : identify_by_contacts(nominal, bars(exact, 0, 1)).free)
    if (k < ArmParameters::chain_end(6)) known.parameters.push_back(k);
  const auto n = static_cast<Index>(known.parameters.size());
  vernier_test::NormalisedSquares before, after;
  double change = 0;
  constexpr int arms = 8;
  for (std::uint64_t seed = 1; seed <= arms; ++seed) {
    Rng rng(child_seed(seed, 9));
    // correlated: half of each error is of a common direction
    known.covariance = MatrixX::Constant(n, n, 0.01e-6) + MatrixX(VectorX::Constant(n, 0.03e-6).asDiagonal());
    known.values = ArmGeometry(nominal).parameters();
    VectorX actual = known.values;
    const double common = rng.normal();
    for (const Index k : known.parameters) {
      known.values(k) += 1e-3 * rng.normal();
      actual(k) = known.values(k) + std::sqrt(0.01e-6) * common + std::sqrt(0.03e-6) * rng.normal();
    }
    const Framed<DhChain<6>> framed = ArmGeometry(nominal).with_parameters(actual).framed(designed);
    const Actual arm(WithJointErrors<DhChain<6>>(framed.model()), framed.base_frame(), framed.tool_frame());
    std::vector<Contact> touched = bars(arm, 0.03e-3, seed);
    touched.resize(2, touched.front());
    const auto found = identify_by_contacts(nominal, touched, {.frames = Frames::tool}, {.loss = Loss::huber}, &known);
    EXPECT_EQ(found.prior, "earlier");
    change += found.prior_change / arms;
    VectorX error(static_cast<Index>(found.free.size())), prior(error.size());
    for (Index i = 0; i < error.size(); ++i) {
      const ParameterEstimate& p = found.parameters[static_cast<std::size_t>(found.free[static_cast<std::size_t>(i)])];
      error(i) = p.identified - actual(found.free[static_cast<std::size_t>(i)]);
      prior(i) = vernier_test::prior_of(p);
    }
    add_differences(error, found.covariance, prior, after);
    for (const Index k : found.free)
      if (k < ArmParameters::chain_end(6)) {
        before.sum += std::pow(known.values(k) - actual(k), 2);
        ++before.count;
      }
  }
  EXPECT_GT(after.count, 30);
  EXPECT_GT(after.rms(), 0.8);
  EXPECT_LT(after.rms(), 1.2);
  EXPECT_NEAR(before.rms(), 0.2e-3, 0.02e-3);
  EXPECT_LT(change, 0.2);  // nothing has changed
}

}  // namespace
}  // namespace vernier::contact_uncertainty_test
