// SPDX-License-Identifier: BSD-3-Clause
// What joints add to their commanded values: functions of an angle, and the sum of all terms, each against another way
// to the same numbers; the chain with them as a kinematic model.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <vernier/error_terms/joint_errors.hpp>
#include <vernier/kinematics/framed.hpp>
#include <vernier/testing/kinematic_laws.hpp>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace vn = vernier;
using vernier_test::allocations;
using vernier_test::difference;
using vernier_test::keep;
using vernier_test::normals;
using vernier_test::RealMatrix;
using vernier_test::stepped;
using vernier_test::vector;
using vn::Index;
using vn::VectorX;

namespace joint_errors_test {
namespace {

constexpr double pi = std::numbers::pi;

/// Values and slopes of all functions of a basis.
struct Functions {
  VectorX value, slope;
};

Functions functions(const vn::Fourier& basis, double q) {
  Functions out{VectorX::Constant(basis.size(), std::nan("")), VectorX::Constant(basis.size(), std::nan(""))};
  basis.values(q, out.value.data());
  for (Index k = 0; k < basis.size(); ++k) {
    VectorX unit = VectorX::Zero(basis.size());
    unit(k) = 1;
    EXPECT_NEAR(basis.sum(q, unit.data()).value, out.value(k), 1e-15);
    out.slope(k) = basis.sum(q, unit.data()).slope;
  }
  return out;
}

/// Slopes are the central differences of values; `curvature` bounds the third derivative.
void expect_slopes_of_values(const vn::Fourier& basis, double q, double curvature) {
  const double h = 1e-6, rounding = 1e-14 / h;
  const RealMatrix ahead = functions(basis, q + h).value, behind = functions(basis, q - h).value;
  EXPECT_LE(difference(functions(basis, q).slope, (ahead - behind) / (2 * h)), rounding + h * h * curvature) << q;
}

TEST(Fourier, IsCosineAndSine) {
  vn::Rng rng(1);
  std::vector<double> angles = {0.0, pi / 2, -pi / 2, pi, -pi, 1e-9};
  for (int i = 0; i < 500; ++i) angles.push_back(rng.uniform(-2 * pi, 2 * pi));
  for (const double q : angles) {
    const Functions f = functions(vn::Fourier::up_to(60), q);
    for (int k = 1; k <= 60; ++k) {
      const long double angle = static_cast<long double>(q) * k;  // k q itself is rounded by 1e-14 in double
      const double c = static_cast<double>(std::cos(angle)), s = static_cast<double>(std::sin(angle));
      EXPECT_NEAR(f.value(2 * k - 2), c, 1e-14) << k << " " << q;
      EXPECT_NEAR(f.value(2 * k - 1), s, 1e-14) << k << " " << q;
      EXPECT_NEAR(f.slope(2 * k - 2), -k * s, 1e-14 * k);
      EXPECT_NEAR(f.slope(2 * k - 1), k * c, 1e-14 * k);
    }
    expect_slopes_of_values(vn::Fourier::up_to(60), q, 60.0 * 60 * 60 / 6);
  }
}

TEST(Fourier, OrdersMayHaveGaps) {
  const vn::Fourier lines{{1, 2, 7, 128, 404, 1010}};
  EXPECT_EQ(lines.size(), 12);
  for (const double q : {0.3, -2.0, 3.1}) {
    const Functions f = functions(lines, q);
    for (Index k = 0; k < 6; ++k) {
      const double order = lines.order(2 * k);
      EXPECT_NEAR(f.value(2 * k), std::cos(order * q), 2e-13) << order;
      EXPECT_NEAR(f.value(2 * k + 1), std::sin(order * q), 2e-13) << order;
      EXPECT_NEAR(f.slope(2 * k), -order * std::sin(order * q), 2e-10) << order;
    }
  }
  EXPECT_EQ(functions(vn::Fourier{}, 1.0).value.size(), 0);
}

TEST(HarmonicSpectrum, LaterBandsCountAndOrdersFollow) {
  const vn::HarmonicSpectrum spectrum{{1, 5, 1e-4}, {4, 6, 2e-5}, {20, 21, 3e-6}};
  const std::vector<double> wanted{0, 1e-4, 1e-4, 1e-4, 2e-5, 2e-5, 2e-5, 0};
  for (std::size_t k = 0; k < wanted.size(); ++k)
    EXPECT_EQ(vn::expected_std(spectrum, static_cast<int>(k)), wanted[k]) << k;
  EXPECT_EQ(vn::orders_of(spectrum, 500).orders, (std::vector<int>{1, 2, 3, 4, 5, 6, 20, 21}));
  EXPECT_EQ(vn::orders_of(spectrum, 20).orders, (std::vector<int>{1, 2, 3, 4, 5, 6, 20}));
  EXPECT_TRUE(vn::orders_of(spectrum, 0).orders.empty());
  EXPECT_EQ(vn::orders_of(vn::typical_spectrum(), 500).orders.size(), 140 + 5 + 9);
}

// Joints side by side are what each is alone, with different orders at each, gaps, and more joints than lanes.
template <int N>
void expect_transmissions_of_single_joints() {
  vn::Rng rng(77);
  vn::JointTerms terms(N);
  const std::vector<vn::Fourier> choices{vn::Fourier::up_to(60),
                                         vn::Fourier{},
                                         {{3, 128, 404}},
                                         {{1, 2, 3, 4, 5, 9}},
                                         vn::orders_of(vn::typical_spectrum(), 500)};
  for (int j = 0; j < N; ++j)
    terms.transmission[static_cast<std::size_t>(j)] = choices[static_cast<std::size_t>(j) % 5];
  const vn::JointErrors errors(terms, normals(rng, terms.size()));
  for (int i = 0; i < 20; ++i) {
    const vn::JointVector<N> q = vernier_test::random_joints<N>(rng);
    const auto at = errors.template effective<N>(q);
    for (int j = 0; j < N; ++j) {
      const vn::Fourier::Sum alone = terms.transmission[static_cast<std::size_t>(j)].sum(
          q(j), errors.coefficients().data() + terms.transmission_begin(j));
      EXPECT_NEAR(at.joints(j) - q(j), alone.value, 1e-11) << j;
      EXPECT_NEAR(at.derivative(j, j) - 1, alone.slope, 1e-9) << j;
    }
  }
}

TEST(JointErrors, JointsSideBySideAreSingleOnes) {
  expect_transmissions_of_single_joints<1>();
  expect_transmissions_of_single_joints<6>();
  expect_transmissions_of_single_joints<9>();
}

// Orders without gaps are summed four at a time: runs of every length, before and behind gaps, and an order alone.
TEST(JointErrors, RunsOfOrdersOfAnyLengthAreSumsOfSines) {
  vn::Rng rng(79);
  for (const int first : {1, 2, 7})
    for (int run = 1; run <= 13; ++run)
      for (const bool more : {false, true}) {
        vn::JointTerms terms(1);
        std::vector<int>& orders = terms.transmission[0].orders;
        for (int k = 0; k < run; ++k) orders.push_back(first + k);
        if (more)
          for (const int k : {2, 3, 4, 5, 6, 8, 20}) orders.push_back(first + run + k);
        const vn::JointErrors errors(terms, normals(rng, terms.size()));
        const vn::JointVector<1> q(rng.uniform(-pi, pi));
        double value = 0, slope = 0;
        for (std::size_t k = 0; k < orders.size(); ++k) {
          const double order = orders[k], c = std::cos(order * q(0)), s = std::sin(order * q(0));
          const double a = errors.coefficients()(static_cast<Index>(2 * k)),
                       b = errors.coefficients()(static_cast<Index>(2 * k + 1));
          value += a * c + b * s;
          slope += order * (b * c - a * s);
        }
        const auto at = errors.effective<1>(q);
        EXPECT_NEAR(at.joints(0) - q(0), value, 1e-12) << first << ", " << run;
        EXPECT_NEAR(at.derivative(0, 0) - 1, slope, 1e-11) << first << ", " << run;
      }
}

// Nine joints fill one vector of eight and one lane of a second: what lies behind the ninth is neither read nor
// changed.
TEST(JointErrors, OnlyTheJointsThereAreAreTouched) {
  vn::Rng rng(80);
  constexpr int n = 9, room = 16;
  vn::JointTerms terms(n);
  terms.transmission.assign(n, vn::Fourier::up_to(3));
  const vn::JointErrors errors(terms, normals(rng, terms.size(), 1e-3));
  std::vector<double> q(room, std::nan("")), effective(room, 7), derivative(n * n + room * n, 7);
  for (std::size_t j = 0; j < n; ++j) q[j] = rng.uniform(-pi, pi);
  errors.evaluate(q.data(), n, effective.data(), derivative.data());
  for (std::size_t j = 0; j < n; ++j) EXPECT_NE(effective[j], 7);
  for (std::size_t j = n; j < effective.size(); ++j) EXPECT_EQ(effective[j], 7) << j;
  for (std::size_t j = n * n; j < derivative.size(); ++j) EXPECT_EQ(derivative[j], 7) << j;
}

TEST(JointErrors, HysteresisFollowsTheDirectionOfApproach) {
  vn::JointTerms terms(2);
  terms.hysteresis = {0.01, 0.3};
  const vn::JointErrors errors(terms, vector({50e-6, -20e-6, 10e-6, 30e-6}));
  EXPECT_EQ(terms.names(),
            (std::vector<std::string>{"hysteresis1_1", "hysteresis2_1", "hysteresis1_2", "hysteresis2_2"}));
  const vn::JointVector<2> q(0.4, -0.2);
  const RealMatrix nominal = RealMatrix::of(q);
  const auto moved = [&](double d1, double d2) {
    const vn::JointVector<2> previous(q(0) - d1, q(1) - d2);
    return RealMatrix::of(errors.effective<2>(q, previous.data()).joints) - nominal;
  };
  const auto by = [](double h1, double h2, double d) { return h1 * std::tanh(d / 0.01) + h2 * std::tanh(d / 0.3); };
  EXPECT_NEAR(moved(0.005, -0.1)(0), by(50e-6, 10e-6, 0.005), 1e-16);
  EXPECT_NEAR(moved(0.005, -0.1)(1), by(-20e-6, 30e-6, -0.1), 1e-16);
  EXPECT_EQ(moved(0, 0), vector({0, 0}));
  EXPECT_LT((moved(1, 2) + moved(-1, -2)).norm(), 1e-16);             // the other direction, the other side
  EXPECT_EQ(RealMatrix::of(errors.effective<2>(q).joints), nominal);  // unknown: in the middle
  const vn::JointVector<2> unknown(std::nan(""), 0.1);
  EXPECT_EQ(errors.effective<2>(q, unknown.data()).joints(0), q(0));
  EXPECT_NE(errors.effective<2>(q, unknown.data()).joints(1), q(1));
  const vn::JointVector<2> endless(std::numeric_limits<double>::infinity(), q(1));
  EXPECT_EQ(errors.effective<2>(q, endless.data()).joints(0), q(0));  // from nowhere
  EXPECT_DOUBLE_EQ(errors.half_loop(0), 60e-6);
  EXPECT_DOUBLE_EQ(errors.half_loop(1), 20e-6);  // of small motions; of large ones 10
  // rows of joint values with and without previous ones
  const RealMatrix rows = nominal.transpose(), before = (nominal - vector({0.005, -0.1})).transpose();
  EXPECT_EQ(RealMatrix(errors.effective_rows(rows)), rows);
  EXPECT_LT((errors.effective_rows(rows, before) - rows - moved(0.005, -0.1).transpose()).norm(), 1e-15);
}

// Loops of joints that err in other ways, too.
TEST(JointErrors, HalfLoopsAreThoseOfHysteresisAlone) {
  vn::JointTerms terms(2);
  terms.gear_ratio = terms.coupling = true;
  terms.hysteresis = {0.01, 0.3};
  terms.transmission[1] = vn::Fourier::up_to(1);
  const vn::JointErrors errors(terms, vector({7, 8, 9, 50e-6, -20e-6, 10e-6, -30e-6, 5, 6}));
  EXPECT_DOUBLE_EQ(errors.half_loop(0), 60e-6);
  EXPECT_DOUBLE_EQ(errors.half_loop(1), 50e-6);
}

/// Linear motion and rotation of a view, by central differences.
TEST(ApproachedArm, JacobianIsThatOfItsPoses) {
  vn::Rng rng(78);
  const auto chain = vernier_test::random_chain<6>(rng);
  vn::JointTerms terms(6);
  terms.hysteresis = {0.01, 0.3};
  terms.transmission.assign(6, vn::Fourier{{1, 12}});
  const vn::WithJointErrors<vn::DhChain<6>> arm(chain, vn::JointErrors(terms, normals(rng, terms.size(), 1e-3)));
  const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
  vn::JointVector<6> previous = q;
  for (double& x : previous) x -= 0.01 * rng.normal();
  const vn::ApproachedArm view(arm, previous);
  EXPECT_GT((view.position(q) - arm.position(q)).norm(), 1e-6);
  EXPECT_EQ(RealMatrix(view.position(q)), RealMatrix(vn::translation(view.pose(q))));
  const auto found = view.pose_and_jacobian(q);
  const RealMatrix jacobian = found.jacobian;
  EXPECT_EQ(RealMatrix(found.pose), RealMatrix(view.pose(q)));
  EXPECT_EQ(jacobian, RealMatrix(view.jacobian(q)));
  constexpr double h = 1e-5;
  for (int j = 0; j < 6; ++j) {
    const vn::Isometry3 ahead = view.pose(stepped(q, j, h)), behind = view.pose(stepped(q, j, -h));
    const vn::Vector3 linear = (vn::translation(ahead) - vn::translation(behind)) / (2 * h);
    const vn::Vector3 angular = vn::rotation_difference(vn::rotation(ahead), vn::rotation(behind)) / (2 * h);
    EXPECT_LT((jacobian.block(0, j, 3, 1) - linear).norm(), 1e-7) << j;
    EXPECT_LT((jacobian.block(3, j, 3, 1) - angular).norm(), 1e-7) << j;
  }
}

/// All terms at once: harmonics, and joints without functions.
template <class Chain>
vn::JointTerms all_terms(const Chain& chain) {
  vn::JointTerms terms(Chain::dof);
  terms.gear_ratio = terms.coupling = true;
  terms.gravity.emplace(chain, vn::Vector3(0.6, 0, -0.8));
  terms.transmission[0] = vn::Fourier::up_to(12);
  if constexpr (Chain::dof > 2) terms.transmission[2] = vn::Fourier::up_to(5);
  if constexpr (Chain::dof > 3) terms.transmission[3] = vn::Fourier::up_to(3);
  return terms;
}

/// Coefficients of 1 mrad.
vn::JointErrors random_errors(vn::Rng& rng, vn::JointTerms terms) {
  const Index n = terms.size();
  return {std::move(terms), normals(rng, n, 1e-3)};
}

template <int N>
void expect_effective_is_phi_beta() {
  vn::Rng rng(300 + N);
  const auto arm = vernier_test::random_chain<N>(rng);
  for (int present = 0; present < 16; ++present) {  // each block with and without each other
    vn::JointTerms terms = all_terms(arm);
    terms.gear_ratio = (present & 1) != 0;
    terms.coupling = (present & 2) != 0;
    if ((present & 4) == 0) terms.gravity.reset();
    if ((present & 8) == 0) terms.transmission.assign(N, vn::Fourier{});
    const auto errors = random_errors(rng, terms);
    EXPECT_EQ(errors.empty(), terms.size() == 0);
    for (int i = 0; i < 5; ++i) {
      const vn::JointVector<N> q = vernier_test::random_joints<N>(rng);
      vn::MatrixX dense = vn::MatrixX::Constant(N, terms.num_dense_terms(), std::nan(""));
      terms.dense_basis(q.data(), nullptr, dense);
      RealMatrix phi(N, terms.size());
      phi.set_block(0, 0, dense);
      for (int j = 0; j < N; ++j) {
        const VectorX h = functions(terms.transmission[static_cast<std::size_t>(j)], q(j)).value;
        const Index begin = terms.transmission_begin(j);
        double sum = 0;
        for (Index k = 0; k < h.size(); ++k) {
          phi(j, begin + k) = h(k);
          sum += h(k) * errors.coefficients()(begin + k);
        }
        EXPECT_NEAR(errors.transmission(j, q(j)), sum, 1e-15);
      }
      const auto joints = [&](const vn::JointVector<N>& at) { return RealMatrix::of(errors.effective(at).joints); };
      EXPECT_LE(difference(joints(q) - RealMatrix::of(q), phi * errors.coefficients()), 1e-15);
      const RealMatrix derivative = RealMatrix::of(errors.effective(q).derivative);
      for (int k = 0; k < N; ++k) {
        const RealMatrix slopes = (joints(stepped(q, k, 1e-5)) - joints(stepped(q, k, -1e-5))) / 2e-5;
        EXPECT_LE(difference(derivative.col(k), slopes), 1e-9);
      }
    }
  }
}

TEST(JointErrors, EffectiveJointsArePhiBeta) {
  expect_effective_is_phi_beta<1>();
  expect_effective_is_phi_beta<2>();
  expect_effective_is_phi_beta<3>();
  expect_effective_is_phi_beta<6>();
}

// A palletiser: J3 turns the forearm against the ground, and joint 4 follows without a motor. Its gears err with the
// angles of the motors, and joint 4 with its own; gravity is that of the chain.
TEST(JointErrors, MotorsErrByTheirOwnAngles) {
  vn::Rng rng(82);
  constexpr int n = 5;
  const std::array<std::string, n> law{"J1", "J2 + 20 deg", "J3 - J2", "-J3", "-J4"};
  const vn::ControllerMap controller(law);
  const auto arm = vernier_test::random_chain<n>(rng);
  vn::JointTerms terms = all_terms(arm), at_chain = terms;
  for (vn::JointTerms* both : {&terms, &at_chain}) both->hysteresis = {0.02, 0.3};
  terms.motors = vn::MotorAngles(controller.with_motor_errors());
  EXPECT_TRUE(vn::MotorAngles(controller).none());
  ASSERT_FALSE(terms.motors.none());
  const VectorX beta = normals(rng, terms.size(), 1e-3);
  const vn::JointErrors errors(terms, beta);
  VectorX of_motors = beta, of_gravity = VectorX::Zero(beta.size());
  for (const vn::JointTermBlock& block : terms.blocks())
    for (Index k = 0; block.kind == vn::JointTermBlock::Kind::gravity && k < block.count; ++k) {
      of_gravity(block.begin + k) = beta(block.begin + k);
      of_motors(block.begin + k) = 0;
    }
  const vn::JointErrors functions_alone(at_chain, of_motors), gravity_alone(at_chain, of_gravity);
  // motors by joints, and joints by motors, by hand
  const auto motors = [](const vn::JointVector<n>& q) {
    const double j2 = q(1) - 20 * pi / 180;
    return vn::JointVector<n>{q(0), j2, q(2) + j2, -q(4), q(3)};
  };
  const auto moved = [](const vn::JointVector<n>& e) {
    return RealMatrix(n, 1, {e(0), e(1), e(2) - e(1), e(4) - e(2), -e(3)});
  };
  for (int trial = 0; trial < 5; ++trial) {
    const vn::JointVector<n> q = vernier_test::random_joints<n>(rng);
    vn::JointVector<n> previous = q;
    for (double& x : previous) x -= 0.1 * rng.normal();
    if (trial == 4) previous(2) = std::nan("");  // so motor 3 is unknown, and no other
    const vn::JointVector<n> u = motors(q), before = motors(previous);
    const vn::JointVector<n> e = functions_alone.effective(u, before.data()).joints - u;
    const RealMatrix expected = RealMatrix::of(gravity_alone.effective(q).joints) + moved(e);
    const auto effective = [&](const vn::JointVector<n>& at) { return errors.effective(at, previous.data()); };
    const auto found = effective(q);
    EXPECT_LE(difference(RealMatrix::of(found.joints), expected), 1e-14);
    vn::MatrixX dense = vn::MatrixX::Constant(n, terms.num_dense_terms(), std::nan(""));
    terms.dense_basis(q.data(), previous.data(), dense);
    vn::JointVector<n> harmonics;
    for (int j = 0; j < n; ++j) harmonics(j) = errors.transmission(j, u(j));
    const RealMatrix sum =
        RealMatrix::of(q) + RealMatrix(dense) * RealMatrix(VectorX(beta.head(dense.cols()))) + moved(harmonics);
    EXPECT_LE(difference(RealMatrix::of(found.joints), sum), 1e-14);
    for (int k = 0; k < n; ++k) {
      constexpr double h = 1e-5;
      const RealMatrix ahead = RealMatrix::of(effective(stepped(q, k, h)).joints),
                       behind = RealMatrix::of(effective(stepped(q, k, -h)).joints);
      EXPECT_LE(difference(RealMatrix::of(found.derivative).col(k), (ahead - behind) / (2 * h)), 1e-8) << k;
    }
  }
  vn::JointTerms of_six(6);
  of_six.motors = terms.motors;
  EXPECT_EQ(vernier_test::complaint([&] { vn::JointErrors(of_six, VectorX()); }),
            "JointErrors: motors of 5 joints, expected 6");
}

// Every block at once, the configurations approached from known ones: columns lie where their coefficients do.
TEST(JointErrors, BlocksFollowEachOtherInColumnsAndCoefficients) {
  vn::Rng rng(81);
  constexpr int n = 4;
  const auto arm = vernier_test::random_chain<n>(rng);
  vn::JointTerms terms = all_terms(arm);
  terms.hysteresis = {0.02, 0.3};
  terms.tilt.emplace(arm);
  const auto errors = random_errors(rng, terms);
  const VectorX& beta = errors.coefficients();
  for (int trial = 0; trial < 5; ++trial) {
    const vn::JointVector<n> q = vernier_test::random_joints<n>(rng);
    vn::JointVector<n> previous = q;
    for (double& x : previous) x -= 0.1 * rng.normal();
    vn::MatrixX dense = vn::MatrixX::Constant(n, terms.num_dense_terms(), std::nan(""));
    terms.dense_basis(q.data(), previous.data(), dense);
    const auto effective = [&](const vn::JointVector<n>& at) { return errors.effective(at, previous.data()); };
    const auto found = effective(q);
    for (Index i = 0; i < n; ++i) {
      double sum = errors.transmission(static_cast<int>(i), q(i));
      for (Index k = 0; k < terms.num_dense_terms(); ++k) sum += dense(i, k) * beta(k);
      EXPECT_NEAR(found.joints(i) - q(i), sum, 1e-15) << i;
      for (Index k = 0; k < 2 * n; ++k) {  // width by width, the joints of each
        const double width = terms.hysteresis[static_cast<std::size_t>(k / n)];
        EXPECT_DOUBLE_EQ(dense(i, terms.end_begin() - 2 * n + k),
                         k % n == i ? std::tanh((q(i) - previous(i)) / width) : 0);
      }
    }
    for (int k = 0; k < n; ++k) {
      constexpr double h = 1e-5;
      const RealMatrix ahead = RealMatrix::of(effective(stepped(q, k, h)).joints),
                       behind = RealMatrix::of(effective(stepped(q, k, -h)).joints);
      EXPECT_LE(difference(RealMatrix::of(found.derivative).col(k), (ahead - behind) / (2 * h)), 1e-8) << k;
    }
  }
}

TEST(JointErrors, LinearTermsStayAtTheEndOfWhereTheyAreKnown) {
  vn::JointTerms terms(3);
  terms.gear_ratio = terms.coupling = true;
  terms.linear_ranges = {{-1, 2}, {0, 0.5}, {-3, 3}};
  const VectorX beta = vector({1e-3, 2e-3, -1e-3, 4e-3, 5e-3});
  const vn::JointErrors errors(terms, beta);
  const auto error = [&](double a, double b, double c) {
    const vn::JointVector<3> q(a, b, c);
    return vn::JointVector<3>(errors.effective<3>(q).joints - q);
  };
  EXPECT_LT((error(1, 0.25, -2) - vn::JointVector<3>(1e-3, 2e-3 * 0.25 + 4e-3 * 1, 2e-3 + 5e-3 * 0.25)).norm(), 1e-15);
  EXPECT_LT((error(7, 0.7, -2) - vn::JointVector<3>(2e-3, 2e-3 * 0.5 + 4e-3 * 2, 2e-3 + 5e-3 * 0.5)).norm(), 1e-15);
  EXPECT_LT((error(-7, -9, -9) - vn::JointVector<3>(-1e-3, -4e-3, 3e-3)).norm(), 1e-15);
  const auto inside = errors.effective<3>({1, 0.25, -2}).derivative,
             outside = errors.effective<3>({7, 0.7, -5}).derivative;
  EXPECT_EQ(inside(1, 0), 4e-3);
  EXPECT_EQ(inside(0, 0), 1 + 1e-3);
  EXPECT_EQ(RealMatrix(outside), RealMatrix::identity(3));
  vn::MatrixX phi(3, 5);
  const vn::JointVector<3> q(7, 0.7, -5);
  terms.dense_basis(q.data(), nullptr, phi);
  EXPECT_LT((RealMatrix(phi) * beta - error(7, 0.7, -5)).norm(), 1e-15);
  terms.linear_ranges.pop_back();
  EXPECT_THROW(vn::JointErrors(terms, beta), std::invalid_argument);
}

TEST(JointErrors, NoneChangeNothing) {
  const vn::JointErrors none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.terms().joints, 0);
  EXPECT_EQ(none.terms().size(), 0);
  vn::Rng rng(5);
  const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
  EXPECT_EQ(RealMatrix(none.effective(q).joints), RealMatrix(q));
  EXPECT_EQ(RealMatrix(none.effective(q).derivative), RealMatrix::identity(6));
  EXPECT_EQ(none.transmission(3, 1.0), 0);
  const auto arm = vernier_test::random_chain<6>(rng);
  EXPECT_EQ(RealMatrix(vn::WithJointErrors<vn::DhChain<6>>(arm).pose(q)), RealMatrix(arm.pose(q)));
}

TEST(JointErrors, WithoutTiltsAPoseStays) {
  vn::Rng rng(10);
  const auto arm = vernier_test::random_chain<6>(rng);
  vn::JointTerms terms(6);
  terms.gear_ratio = true;
  const vn::JointErrors gears = random_errors(rng, terms);
  const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
  const auto before = arm.pose_and_jacobian(q);
  auto after = before;
  gears.tilt(q.data(), after.pose, after.jacobian.data());
  EXPECT_EQ(RealMatrix(after.pose), RealMatrix(before.pose));
  EXPECT_EQ(RealMatrix::of(after.jacobian), RealMatrix::of(before.jacobian));
  EXPECT_FALSE(gears.tilts());
}

TEST(JointErrors, NamesAreInOrderAndUnique) {
  vn::Rng rng(6);
  const auto arm = vernier_test::random_chain<3>(rng);
  vn::JointTerms terms(3);
  terms.gear_ratio = terms.coupling = true;
  terms.gravity.emplace(arm);
  terms.transmission[0] = vn::Fourier::up_to(2);
  terms.transmission[2] = vn::Fourier::up_to(1);
  EXPECT_EQ(terms.names(), (std::vector<std::string>{"gear1", "gear2", "gear3", "coupling2", "coupling3", "sag1_1",
                                                     "sag1_2", "sag1_3", "sag2_2", "sag2_3", "sag3_3", "cos1_1",
                                                     "sin1_1", "cos1_2", "sin1_2", "cos3_1", "sin3_1"}));
  const auto many = [&](auto chain) {
    auto all = all_terms(chain);
    all.transmission.assign(all.transmission.size(), vn::Fourier::up_to(60));
    const auto names = all.names();
    EXPECT_EQ(static_cast<Index>(names.size()), all.size());
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  };
  many(arm);
  many(vernier_test::random_chain<1>(rng));
  many(vernier_test::random_chain<12>(rng));  // joint 1, harmonic 12 is not joint 11, harmonic 2
}

/// Blocks follow each other without gaps, up to all coefficients, and none is empty.
void expect_blocks_in_sequence(const vn::JointTerms& terms) {
  Index at = 0;
  for (const vn::JointTermBlock& block : terms.blocks()) {
    EXPECT_EQ(block.begin, at);
    EXPECT_GT(block.count, 0);
    if (block.kind == vn::JointTermBlock::Kind::transmission) {
      EXPECT_EQ(block.begin, terms.transmission_begin(block.joint));
    } else {
      EXPECT_EQ(block.joint, -1) << "of all joints";
    }
    at += block.count;
  }
  EXPECT_EQ(at, terms.size());
}

// Coefficients are the same where their names are.
TEST(JointErrors, CommonTermsHaveTheSameNames) {
  vn::Rng rng(9);
  const auto arm = vernier_test::random_chain<3>(rng);
  std::vector<vn::JointTerms> sets(4, vn::JointTerms(3));
  sets[0] = all_terms(arm);
  sets[0].transmission = {{{1, 3, 5}}, {{2}}, {{4, 8}}};
  sets[0].hysteresis = {0.01, 0.3};
  sets[0].tilt.emplace(arm);
  sets[1].coupling = true;
  sets[1].hysteresis = {0.02};
  sets[1].transmission = {{{3, 4, 5, 7}}, {{1}}, {{1, 2, 8, 9}}};
  sets[2].gear_ratio = true;
  sets[2].tilt.emplace(arm);
  sets[2].transmission = {vn::Fourier{}, vn::Fourier::up_to(5), {{8}}};
  for (const vn::JointTerms& first : sets) {
    expect_blocks_in_sequence(first);
    const std::vector<std::string> names = first.names();
    for (const vn::JointTerms& second : sets) {
      const std::vector<std::string> others = second.names();
      std::vector<std::pair<Index, Index>> expected, found;
      for (std::size_t a = 0; a < names.size(); ++a) {
        const auto b = std::find(others.begin(), others.end(), names[a]);
        if (b != others.end()) expected.emplace_back(static_cast<Index>(a), b - others.begin());
      }
      vn::detail::visit_common_terms(first, second, [&](Index a, Index b) { found.emplace_back(a, b); });
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(JointTerms, BlocksAreMadeFromTheirParameters) {
  using Kind = vn::JointTermBlock::Kind;
  const vn::DhChain<3> chain({{.joint = vn::JointType::prismatic}, {}, {}});
  const std::map<Kind, std::vector<double>> parameters{
      {Kind::payload, {0, 0, -1, 2, 0, 0, 0.1}}, {Kind::bend, {0, 0, -1, 2, 0, 0, 0.1}},
      {Kind::straightness, {2, -0.5, 1}},        {Kind::gravity, {0.6, 0, -0.8}},
      {Kind::hysteresis, {0.02, 0.3}},           {Kind::tilt, {0, -1, 0}}};
  const std::map<Kind, Index> sizes{{Kind::gear_ratio, 3}, {Kind::coupling, 2},      {Kind::payload, 3},
                                    {Kind::bend, 6},       {Kind::straightness, 12}, {Kind::gravity, 6},
                                    {Kind::hysteresis, 6}, {Kind::tilt, 18}};
  for (const vn::JointTermTraits& row : vn::joint_term_rows) {
    vn::JointTerms terms(3);
    const auto of_kind = parameters.contains(row.kind) ? parameters.at(row.kind) : std::vector<double>{};
    EXPECT_EQ(row.has_parameters(), !of_kind.empty() || row.kind == Kind::transmission);
    const auto add = [&] { terms.add(row.kind, vn::detail::ChainTable(chain.view()), of_kind); };
    if (row.kind == Kind::transmission) {
      EXPECT_THROW(add(), std::invalid_argument);
      continue;
    }
    add();
    ASSERT_EQ(terms.blocks().size(), 1u) << row.key;
    EXPECT_EQ(terms.blocks()[0].kind, row.kind);
    EXPECT_EQ(terms.size(), sizes.at(row.kind)) << row.key;
    EXPECT_EQ(terms.parameters(row.kind), of_kind);
  }
  vn::JointTerms terms(3);
  const auto complaint = [&](Kind kind, const std::vector<double>& of_kind) {
    return vernier_test::complaint([&] { terms.add(kind, vn::detail::ChainTable(chain.view()), of_kind); });
  };
  EXPECT_EQ(complaint(Kind::gravity, {0, 0, -2}), "must have length 1");
  EXPECT_EQ(complaint(Kind::tilt, {0, 1}), "a direction has 2 components, must have 3");
  EXPECT_EQ(complaint(Kind::hysteresis, {0.1, 0}), "a width is 0, must be positive");
  EXPECT_EQ(complaint(Kind::straightness, {2}), "a range is empty or missing");
  EXPECT_EQ(complaint(Kind::straightness, {2, 1, 1}), "a range is empty or missing");
  EXPECT_EQ(complaint(Kind::payload, {0, 0, -1, -2, 0, 0, 0}), "a reference payload has a mass, which is not negative");
}

TEST(JointErrors, WrongCoefficientsAreNamed) {
  using Errors = vn::JointErrors;
  vn::JointTerms terms(6);
  terms.gear_ratio = true;
  for (const Index n : {0, 5, 7}) EXPECT_THROW((void)Errors(terms, VectorX::Zero(n)), std::invalid_argument) << n;
  try {
    (void)Errors(terms, VectorX::Zero(7));
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(std::string(e.what()), "JointErrors: 7 coefficients for 6 terms");
  }
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    VectorX beta = VectorX::Zero(6);
    beta(4) = bad;
    EXPECT_THROW((void)Errors(terms, beta), std::invalid_argument);
  }
  EXPECT_NO_THROW((void)Errors(terms, VectorX::Zero(6)));
}

TEST(JointErrors, InconsistentTermsAreNamed) {
  const auto complaint = [](const vn::JointTerms& terms, Index coefficients) {
    return vernier_test::complaint([&] { (void)vn::JointErrors(terms, VectorX::Ones(coefficients)); });
  };
  vn::JointTerms terms(2);
  terms.transmission = {vn::Fourier::up_to(1), vn::Fourier::up_to(2)};
  EXPECT_EQ(complaint(terms, 6), "");
  terms.transmission[1].orders = {2, 2};
  EXPECT_EQ(complaint(terms, 6), "Fourier: order 2 after 2, must ascend from 1");
  terms.transmission[1].orders = {0, 2};
  EXPECT_EQ(complaint(terms, 6), "Fourier: order 0 after 0, must ascend from 1");
  terms.transmission[1].orders = {};
  terms.hysteresis = {0.1, 0};
  EXPECT_EQ(complaint(terms, 6), "JointErrors: a width of the hysteresis is 0, must be positive");
  terms.hysteresis = {std::numeric_limits<double>::infinity()};
  EXPECT_EQ(complaint(terms, 4), "JointErrors: a width of the hysteresis is inf, must be positive");
  terms.hysteresis = {};
  terms.linear_ranges = {{-1, 1}, {2, 1.5}};
  EXPECT_EQ(complaint(terms, 2), "JointErrors: a linear range ends at 1.5, below its start");
  terms.linear_ranges = {{-1, 1}, {2, 2}};  // of a joint that stood still
  EXPECT_EQ(complaint(terms, 2), "");
  terms.linear_ranges = {};
  terms.transmission.pop_back();
  EXPECT_EQ(complaint(terms, 2), "JointErrors: transmissions of 1 joints, expected 2");
  terms = vn::JointTerms(2);
  terms.gravity.emplace(vn::DhChain<3>({{}, {}, {}}));
  EXPECT_EQ(complaint(terms, 6), "JointErrors: gravity compliance of 3 joints, expected 2");
  const vn::JointErrors of_two(vn::JointTerms(2), VectorX());
  vn::JointTerms gears(2);
  gears.gear_ratio = true;
  const vn::DhChain<3> chain({{}, {}, {}});
  EXPECT_EQ(
      vernier_test::complaint([&] { (void)vn::WithJointErrors(chain, vn::JointErrors(gears, VectorX::Ones(2))); }),
      "WithJointErrors: errors of 2 joints for a chain of 3");
}

vn::Isometry3 frame(const vn::Vector3& position, const vn::Vector3& rotation) {
  return vn::FrameParameters(vn::Vector6{position(0), position(1), position(2), rotation(0), rotation(1), rotation(2)})
      .isometry();
}

template <int N, class Convention>
void expect_laws() {
  vn::Rng rng(400 + N);
  const auto arm = vernier_test::random_chain<N, Convention>(rng);
  using Chain = vn::DhChain<N, Convention>;
  const vn::WithJointErrors<Chain> actual(arm, random_errors(rng, all_terms(arm)));
  const vn::Framed framed(actual, frame({1, 2, 3}, {0.4, -1.2, 2.0}), frame({0.1, -0.05, 0.2}, {0, 0.7, -0.1}));
  static_assert(vn::KinematicModel<vn::WithJointErrors<Chain>>);
  static_assert(vn::KinematicModel<vn::Framed<vn::WithJointErrors<Chain>>>);
  static_assert(!vn::ParametricModel<vn::WithJointErrors<Chain>>);
  const vn::JointRows<N> samples = vernier_test::random_joint_rows<N>(rng, 20);
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::kinematic_model_violations(actual, samples)));
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::kinematic_model_violations(framed, samples)));
}

TEST(WithJointErrors, ObeysTheLaws) {
  expect_laws<1, vn::StandardDh>();
  expect_laws<3, vn::ModifiedDh>();
  expect_laws<6, vn::StandardDh>();
  expect_laws<7, vn::ModifiedDh>();
}

TEST(WithJointErrors, IsTheChainAtTheEffectiveJoints) {
  vn::Rng rng(7);
  const auto arm = vernier_test::random_chain<6>(rng);
  const auto errors = random_errors(rng, all_terms(arm));
  const vn::WithJointErrors<vn::DhChain<6>> actual(arm, errors);
  EXPECT_EQ(actual.chain(), arm);
  EXPECT_EQ(RealMatrix(actual.joint_errors().coefficients()), RealMatrix(errors.coefficients()));
  const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
  EXPECT_EQ(RealMatrix(actual.pose(q)), RealMatrix(arm.pose(errors.effective(q).joints)));
  EXPECT_GT((actual.position(q) - arm.position(q)).norm(), 1e-5);
}

TEST(NoAllocation, JointErrors) {
  vn::Rng rng(8);
  const auto arm = vernier_test::random_chain<6>(rng);
  const auto terms = all_terms(arm);
  const auto errors = random_errors(rng, terms);
  const vn::Framed model(vn::WithJointErrors<vn::DhChain<6>>(arm, errors), frame({1, 2, 3}, {0.1, 0.2, 0.3}));
  const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
  vn::MatrixX dense(6, terms.num_dense_terms());
  EXPECT_EQ(allocations([&] { keep(model.pose(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.position(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.pose_and_jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(errors.effective(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(errors.transmission(2, q(2))); }), 0);
  EXPECT_EQ(allocations([&] { terms.dense_basis(q.data(), nullptr, dense); }), 0);
}

}  // namespace
}  // namespace joint_errors_test
