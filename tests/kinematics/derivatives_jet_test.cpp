// SPDX-License-Identifier: BSD-3-Clause
// Derivatives three ways: analytic, dual numbers, central differences. The last through the law suites.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dual_numbers.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/testing/kinematic_laws.hpp"

namespace vn = vernier;

namespace derivatives_jet_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

constexpr double pi = std::numbers::pi;
constexpr double tolerance = 1e-12;  // analytic against dual numbers [m, or as a ratio], arms of about 2 m

template <class Model>
void expect_three_ways(const Model& model, const vn::JointRows<Model::dof>& samples) {
  for (vn::Index s = 0; s < samples.rows(); ++s) {
    const vn::JointVector<Model::dof> q = vn::configuration<Model::dof>(samples, s);
    const vernier_test::DualDerivatives dual = vernier_test::dual_derivatives(model, q);
    EXPECT_LE(difference(dual.pose, model.pose(q)), tolerance) << "sample " << s;
    EXPECT_LE(difference(dual.joints, RealMatrix::of(model.jacobian(q))), tolerance) << "sample " << s;
    const RealMatrix analytic = RealMatrix::of(model.parameter_jacobian(q));
    EXPECT_LE(difference(dual.parameters, analytic), tolerance) << "sample " << s;
    EXPECT_TRUE(std::isfinite(analytic.largest()));
  }
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::kinematic_model_violations(model, samples)));
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::parametric_model_violations(model, samples)));
}

/// Random rows, and those where something special happens: all zero, half turns, just below and above.
template <int N>
vn::JointRows<N> samples() {
  vn::Rng rng(21);
  vn::JointRows<N> rows = vernier_test::random_joint_rows<N>(rng, 9);
  vn::Index special = 0;
  for (const double value : {0.0, pi, pi - 1e-9, -pi + 1e-9, pi / 2, 1e-12}) {
    for (int j = 0; j < N; ++j) rows(special, j) = value;
    ++special;
  }
  return rows;
}

template <class Convention>
class Derivatives : public ::testing::Test {};
using Conventions = ::testing::Types<vn::StandardDh, vn::ModifiedDh>;
TYPED_TEST_SUITE(Derivatives, Conventions);

template <class Convention>
using Arm = vn::DhChain<3, Convention>;

/// Generic arms, and those where something vanishes.
template <class Convention>
std::vector<Arm<Convention>> arms() {
  constexpr auto prismatic = vn::JointType::prismatic;
  vn::Rng rng(22);
  std::vector<Arm<Convention>> out;
  for (int i = 0; i < 10; ++i) out.push_back(vernier_test::random_chain<3, Convention>(rng));
  out.push_back({{{}, {}, {}}});                                                       // nothing at all
  out.push_back({{{.a = 0.3}, {.a = 0.2}, {.a = 0.1}}});                               // parallel axes
  out.push_back({{{.d = 0.3}, {.d = 0.2}, {.d = 0.1}}});                               // aligned axes
  out.push_back({{{.a = 0.3, .alpha = 1e-9}, {.a = 0.2, .beta = 1e-9}, {.a = 0.1}}});  // nearly parallel
  out.push_back({{{.alpha = pi}, {.alpha = pi - 1e-9}, {.a = 0.1, .alpha = -pi, .beta = pi}}});
  out.push_back({{{.alpha = pi / 2, .joint = prismatic}, {.joint = prismatic}, {.a = 0.4, .joint = prismatic}}});
  return out;
}

TYPED_TEST(Derivatives, Chains) {
  for (const auto& arm : arms<TypeParam>()) expect_three_ways(arm, samples<3>());
}

/// Rotation vectors of frames: none, tiny, generic, about and above the switch to the general formula, half a turn.
std::vector<vn::Vector3> rotations() {
  const vn::Vector3 axis = vn::Vector3(1, -2, 2) / 3;
  std::vector<vn::Vector3> out{vn::Vector3::Zero(), vn::Vector3(pi, 0, 0), vn::Vector3(0, 0, -pi)};
  for (const double angle : {1e-300, 1e-12, 0.99e-4, 1.01e-4, 0.99e-2, 1.01e-2, 1.0, pi / 2, pi - 1e-6, pi - 1e-12, pi})
    out.emplace_back(angle * axis);
  return out;
}

TYPED_TEST(Derivatives, FramedChains) {
  vn::Rng rng(23);
  const auto chain = vernier_test::random_chain<3, TypeParam>(rng);
  const vn::Vector3 place(0.5, -0.3, 0.2), grip(0.05, 0.1, 0.15);
  const auto frame = [](const vn::Vector3& position, const vn::Vector3& rotation) {
    return vn::FrameParameters(
        vn::Vector6{position(0), position(1), position(2), rotation(0), rotation(1), rotation(2)});
  };
  for (const vn::Vector3& rotation : rotations()) {
    SCOPED_TRACE(vn::message("rotation vector ", rotation.x(), " ", rotation.y(), " ", rotation.z()));
    expect_three_ways(vn::Framed(chain, frame(place, rotation), frame(grip, vn::Vector3(0.3, 0.1, -0.2))),
                      samples<3>());
    expect_three_ways(vn::Framed(chain, frame(place, vn::Vector3(-1, 0.2, 2)), frame(grip, rotation)), samples<3>());
  }
}

TYPED_TEST(Derivatives, FramesThatAreExactlyIdentity) {
  for (const auto& arm : arms<TypeParam>()) expect_three_ways(vn::Framed(arm), samples<3>());
}

TEST(DerivativesOfTheCatalogue, ThreeWays) {
  expect_three_ways(vn::robots::abb_irb120().chain, samples<6>());
  expect_three_ways(vn::robots::barrett_wam().chain, samples<7>());
  expect_three_ways(vn::Framed(vn::robots::ur10().chain), samples<6>());
  expect_three_ways(vn::robots::puma560_modified().chain, samples<6>());
}

}  // namespace
}  // namespace derivatives_jet_test
