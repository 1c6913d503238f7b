// SPDX-License-Identifier: BSD-3-Clause
// The library's sensors under the laws of sensors, and planted faults that the laws must find.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/measurements/bar_sensor.hpp"
#include "vernier/measurements/distance_sensor.hpp"
#include "vernier/measurements/plane_sensor.hpp"
#include "vernier/measurements/pose_sensor.hpp"
#include "vernier/measurements/position_sensor.hpp"
#include "vernier/measurements/socket_sensor.hpp"
#include "vernier/testing/sensor_laws.hpp"

namespace vernier::sensor_laws_test {
namespace {

using testing::sensor_violations;
using Violations = std::vector<std::string>;

/// Poses in a sensor's frame whose positions are given, oriented at random.
std::vector<Isometry3> oriented(const PointRows& points, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Isometry3> out;
  for (Index i = 0; i < points.rows(); ++i)
    out.push_back(
        rigid_motion(exp_so3(Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1))), point(points, i)));
  return out;
}

PointRows scattered(Index n, std::uint64_t seed) {
  Rng rng(seed);
  PointRows out(n, 3);
  for (Index k = 0; k < out.size(); ++k) out.data()[k] = rng.uniform(-0.5, 0.5);
  return out;
}

/// The same poses in the base frame of an arm that stands somewhere.
std::vector<Isometry3> from_base(const std::vector<Isometry3>& poses, const Isometry3& base) {
  std::vector<Isometry3> out;
  for (const Isometry3& pose : poses) out.push_back(composed(inverse_of(base), pose));
  return out;
}

/// Places of a base: near, turned by a right angle, and upside down.
std::vector<Isometry3> places() {
  return {rigid_motion(Matrix3::Identity(), Vector3(0.3, -0.2, 0.5)),
          rigid_motion(exp_so3(Vector3(0.3, 1.2, -0.4)), Vector3(2, -1, 0.4)),
          rigid_motion(exp_so3(Vector3(2.9, 0.4, 0)), Vector3(-0.5, 0.3, 1))};
}

template <class MakeSensor>
void expect_lawful(const PointRows& points, const MakeSensor& make) {
  const std::vector<Isometry3> seen = oriented(points, 7);
  for (const Isometry3& base : places()) EXPECT_EQ(sensor_violations(make(seen), from_base(seen, base)), Violations());
}

std::vector<Matrix3> rotations_of(const std::vector<Isometry3>& poses) {
  std::vector<Matrix3> out;
  for (const Isometry3& pose : poses) out.push_back(rotation(pose));
  return out;
}

TEST(SensorLaws, HoldForTheLibrarysSensors) {
  const PointRows points = scattered(12, 1);
  expect_lawful(points, [&](const auto&) { return PositionSensor(points); });
  expect_lawful(points, [&](const auto& seen) { return PoseSensor(points, rotations_of(seen)); });
  expect_lawful(points, [&](const auto&) { return DistanceSensor(distances_from(points, Vector3::Zero())); });
  PointRows on_ball = points;
  for (Index i = 0; i < 12; ++i) set_point(on_ball, i, 0.02 * point(points, i).normalized());
  expect_lawful(on_ball, [](const auto&) { return BallSensor(VectorX::Constant(12, 0.02)); });
  PointRows on_faces = points, on_bar = PointRows::Zero(12, 3);
  for (Index i = 0; i < 12; ++i) on_faces(i, 2) = on_bar(i, 2) = i < 6 ? 0 : 0.1;
  expect_lawful(on_faces, [&](const auto&) { return PlaneSensor(on_faces.col(2)); });
  expect_lawful(on_bar, [&](const auto&) { return BarSensor(on_bar.col(2)); });
  expect_lawful(PointRows::Zero(12, 3), [](const auto&) { return SocketSensor(12); });
}

/// A distance sensor with one fault.
struct Faulty {
  enum Fault { none, slope, start, forgets, hidden_row, needless_unknown, missing_unknown } fault;
  DistanceSensor right;
  mutable int calls = 0;

  const char* kind() const { return "distances"; }
  Index size() const { return right.size(); }
  Index values() const { return 1; }
  SensorSigma sigma() const { return right.sigma(); }
  Plausibility plausibility() const { return right.plausibility(); }
  std::array<bool, 6> unknown_frame() const {
    return {true, true, fault != missing_unknown, fault == needless_unknown, false, false};
  }
  Isometry3 base_from(std::span<const Isometry3> poses) const {
    Isometry3 out = right.base_from(poses);
    if (fault == start) out.translation().x() += 1e-3;
    return out;
  }
  void sense(Index i, const Isometry3& pose, SensedRows& rows) const {
    right.sense(i, pose, rows);
    if (fault == slope) rows.motion(0, 1) *= 1.01;
    if (fault == forgets) rows.residual(0) += 1e-9 * calls++;
    if (fault == hidden_row) rows.residual(4) = 1;
  }
};

TEST(SensorLaws, FindPlantedFaults) {
  const PointRows points = scattered(12, 1);
  const std::vector<Isometry3> seen = oriented(points, 7);
  const DistanceSensor right(distances_from(points, Vector3::Zero()));
  const auto said = [&](Faulty::Fault fault) {
    std::string out;
    for (const std::string& line : sensor_violations(Faulty{fault, right}, from_base(seen, places()[1]))) out += line;
    return out;
  };
  EXPECT_EQ(said(Faulty::none), "");
  EXPECT_NE(said(Faulty::slope).find("motion is not the derivative of the residual: row 0 by a shift along y"),
            std::string::npos);
  EXPECT_NE(said(Faulty::start).find("base_from() leaves residuals"), std::string::npos);
  EXPECT_NE(said(Faulty::forgets).find("another answer to the same pose"), std::string::npos);
  EXPECT_NE(said(Faulty::hidden_row).find("a residual in a row that it does not measure"), std::string::npos);
  EXPECT_NE(said(Faulty::needless_unknown).find("has 4 parameters, of which 3 have an effect"), std::string::npos);
  EXPECT_NE(said(Faulty::missing_unknown).find("leaves out have an effect"), std::string::npos);
  EXPECT_NE(sensor_violations(right, std::span(seen).first(5))[0].find("size() is 12 of 5 poses"), std::string::npos);
}

struct NoDerivative {
  const char* kind() const { return ""; }
};
static_assert(Sensor<DistanceSensor> && Sensor<PoseSensor> && Sensor<Faulty>);
static_assert(!Sensor<NoDerivative> && !Sensor<VectorX>);

}  // namespace
}  // namespace vernier::sensor_laws_test
