// SPDX-License-Identifier: BSD-3-Clause
// Payloads on compliant joints: slopes of the potential energy, derivatives, and the reference.

#include "vernier/error_terms/payload_compliance.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_terms/joint_errors.hpp"

namespace vernier::payload_compliance_test {
namespace {

using vernier_test::difference;
using vernier_test::normals;
using vernier_test::RealMatrix;
using vernier_test::stepped;

constexpr double gravity = 9.80665;

Vector3 random_point(Rng& rng) { return {rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2)}; }

/// Potential energy of a payload at the end of an arm [N m].
template <class Chain>
double energy(const Chain& arm, const Payload& payload, const JointVector<Chain::dof>& q, const Vector3& down) {
  return -gravity * payload.mass * down.dot(arm.pose(q) * payload.centre);
}

/// Bends against the work of the load: with one compliance of 1 rad/(N m) the load sinks by torque^2 / weight, for the
/// spring takes up as much as the weight gives. Their rates are differences.
template <int N, class Convention>
void expect_bends() {
  Rng rng(200 + N);
  for (int trial = 0; trial < 10; ++trial) {
    const auto arm = vernier_test::random_chain<N, Convention>(rng, {.prismatic = 0.4});
    const Vector3 down = vernier_test::random_direction(rng);
    const Payload payload{5, random_point(rng)};
    const PayloadBend bend(detail::ChainTable(arm.view()), down, {0, Vector3::Zero()});
    const PayloadLoad load = bend.load(payload);
    const JointVector<N> q = vernier_test::random_joints<N>(rng);
    MatrixX basis(6, bend.size());
    bend.basis(q.data(), load, basis);
    const Vector3 centre = arm.pose(q) * payload.centre;
    for (Index k = 0; k < bend.size(); ++k) {
      const Vector3 shift = basis.col(k).template head<3>(), turn = basis.col(k).template tail<3>();
      const double sinks = down.dot(shift + turn.cross(centre));
      EXPECT_NEAR(gravity * payload.mass * sinks, turn.squaredNorm(), 1e-10) << k;  // |turn| is the torque
      EXPECT_GT(turn.norm(), 1e-6) << k;
    }
    const VectorX springs = normals(rng, bend.size());
    RealMatrix sum(6, 1);
    for (Index k = 0; k < bend.size(); ++k) sum = sum + springs(k) * RealMatrix(basis).col(k);
    MatrixX rates(6, N);
    const RealMatrix motion = RealMatrix::of(bend.motion(q.data(), load, springs.data(), rates.data()));
    EXPECT_LT(difference(motion, sum), 1e-10);
    for (int k = 0; k < N; ++k) {
      const auto at = [&](double h) {
        const JointVector<N> moved = stepped(q, k, h);
        return RealMatrix::of(bend.motion(moved.data(), load, springs.data()));
      };
      EXPECT_LT(difference(RealMatrix(rates).col(k), (at(1e-5) - at(-1e-5)) / 2e-5), 1e-5) << N << ", " << k;
    }
  }
}

TEST(PayloadBend, IsWhatTheWorkOfTheLoadSaysAndItsRatesAreSlopes) {
  expect_bends<1, StandardDh>();
  expect_bends<3, ModifiedDh>();
  expect_bends<6, StandardDh>();
}

// A beam along x that carries 10 N at 1 m: its end goes down by c W a^2, and only the spring about y gives way.
TEST(PayloadBend, OfABeamByHand) {
  const DhChain<1> beam{{{{.a = 1}}}};
  const PayloadBend bend(detail::ChainTable(beam.view()), Vector3(0, 0, -1), {0, Vector3::Zero()});
  const double q = 0, springs[] = {3e-4, 2e-4};
  const Vector6 motion = bend.motion(&q, {10, Vector3::Zero()}, springs);
  EXPECT_LT(difference(RealMatrix::of(motion), RealMatrix(6, 1, {0, 0, 0, 0, 2e-3, 0})), 1e-15);
}

template <int N, class Convention>
void expect_slopes() {
  Rng rng(100 + N);
  for (int trial = 0; trial < 10; ++trial) {
    const auto arm = vernier_test::random_chain<N, Convention>(rng, {.prismatic = 0.4});
    const Vector3 down = vernier_test::random_direction(rng);
    const Payload reference{trial % 2 * 3.0, random_point(rng)}, payload{5, random_point(rng)};
    const PayloadCompliance compliance(detail::ChainTable(arm.view()), down, reference);
    const PayloadLoad load = compliance.load(payload);
    const JointVector<N> q = vernier_test::random_joints<N>(rng);
    VectorX torques(N);
    compliance.torques(q.data(), load, torques.data());
    const double h = 1e-5;
    const auto beyond = [&](const JointVector<N>& at) {
      return energy(arm, payload, at, down) - energy(arm, reference, at, down);
    };
    const VectorX springs = normals(rng, N);
    const auto added = [&](const JointVector<N>& at) {
      VectorX joints = VectorX::Constant(N, 2.0);
      MatrixX derivative = MatrixX::Constant(N, N, 7.0);
      compliance.add(at.data(), load, springs.data(), joints.data(), derivative.data());
      return std::pair(joints, derivative);
    };
    const auto [joints, derivative] = added(q);
    for (int i = 0; i < N; ++i) {
      const JointVector<N> ahead = stepped(q, i, h), behind = stepped(q, i, -h);
      EXPECT_NEAR(torques(i), -(beyond(ahead) - beyond(behind)) / (2 * h), 1e-7) << N << ", joint " << i;
      EXPECT_NEAR(joints(i), 2 + springs(i) * torques(i), 1e-12);
      const VectorX slopes = (added(ahead).first - added(behind).first) / (2 * h);
      for (int k = 0; k < N; ++k) EXPECT_NEAR(derivative(k, i) - 7, slopes(k), 1e-6) << N << ": " << k << ", " << i;
    }
  }
}

TEST(PayloadCompliance, TorquesAreSlopesOfPotentialEnergyBeyondTheReference) {
  [&]<int... K>(std::integer_sequence<int, K...>) {
    (expect_slopes<K + 1, StandardDh>(), ...);
    (expect_slopes<K + 1, ModifiedDh>(), ...);
  }
  (std::make_integer_sequence<int, 4>{});
}

TEST(PayloadCompliance, TheReferenceHasNoEffect) {
  Rng rng(5);
  const auto arm = vernier_test::random_chain<6>(rng);
  JointTerms terms(6);
  const Payload reference{2.5, Vector3(0.01, -0.02, 0.15)};
  terms.payload.emplace(detail::ChainTable(arm.view()), Vector3(0, 0, -1), reference);
  EXPECT_EQ(terms.names(),
            (std::vector<std::string>{"payload1", "payload2", "payload3", "payload4", "payload5", "payload6"}));
  const JointErrors errors(terms, normals(rng, 6, 1e-4));
  const JointVector<6> q = vernier_test::random_joints<6>(rng);
  EXPECT_EQ((errors.effective<6>(q).joints - q).norm(), 0);
  EXPECT_EQ((errors.carrying(reference).effective<6>(q).joints - q).norm(), 0);
  EXPECT_EQ((errors.carrying({}).carrying({}).effective<6>(q).joints - q).norm(), 0);  // its centre is not known
  const Payload other = Payload{5}.at(Vector3(0, 0, 0.1));
  EXPECT_EQ(other.centre.z(), 0.1);
  EXPECT_GT((errors.carrying(other).effective<6>(q).joints - q).norm(), 1e-5);
  MatrixX basis(6, 6);
  terms.dense_basis(q.data(), nullptr, basis, terms.payload->load(other));
  const VectorX expected = detail::product(basis, errors.coefficients());
  EXPECT_LE(difference(VectorX(errors.carrying(other).effective<6>(q).joints - q), expected), 1e-15);
}

TEST(PayloadCompliance, RefusesWhatIsNoReference) {
  const detail::ChainTable chain(std::vector<DhRow>(2), false);
  EXPECT_NE(vernier_test::complaint([&] { PayloadCompliance(chain, Vector3(0, 0, -2), {0, Vector3::Zero()}); }), "");
  EXPECT_NE(vernier_test::complaint([&] { PayloadCompliance(chain, Vector3(0, 0, -1), {1}); }), "");
  EXPECT_NE(vernier_test::complaint([&] { PayloadCompliance(chain, Vector3(0, 0, -1), {-1, Vector3::Zero()}); }), "");
}

}  // namespace
}  // namespace vernier::payload_compliance_test
