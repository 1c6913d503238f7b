// SPDX-License-Identifier: BSD-3-Clause
// Joint values of controllers and of the chains behind them.
#include "vernier/core/controller_map.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "complaint.hpp"
#include "vernier/core/check.hpp"

namespace vernier::controller_map_test {
namespace {

using Formulas = std::vector<std::string>;
constexpr double degree = std::numbers::pi / 180;

std::string refused(const Formulas& formulas, const std::vector<JointType>& types = {}) {
  return vernier_test::complaint([&] { ControllerMap(formulas, types); });
}

TEST(ControllerMap, FormulasAreSumsOfJointsAndZeros) {
  const ControllerMap map(Formulas{"J1", "J2", "-(J2 + J3 - 90 deg)", " - J4+0.5rad", "2*J6 - J5", "-J6"});
  MatrixX q(1, 6);
  q << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
  const MatrixX chain = map.to_chain(q);
  EXPECT_DOUBLE_EQ(chain(0, 0), 0.1);
  EXPECT_DOUBLE_EQ(chain(0, 2), -0.2 - 0.3 + 90 * degree);
  EXPECT_DOUBLE_EQ(chain(0, 3), -0.4 + 0.5);
  EXPECT_DOUBLE_EQ(chain(0, 4), 1.2 - 0.5);
  EXPECT_DOUBLE_EQ(chain(0, 5), -0.6);
}

TEST(ControllerMap, BothWaysAreExact) {
  for (const Formulas& formulas :
       {Formulas{"J1", "J2", "-J2-J3", "-J4", "-J5", "-J6"}, Formulas{"J1", "J2", "J3-J2", "-J3", "J4"},
        Formulas{"J2", "-J1", "J1 + J3 + 12 deg"}, Formulas{"J1", "J1", "J2"}}) {
    const ControllerMap map(formulas);
    const std::vector<JointType> types(formulas.size(), JointType::revolute);
    const MatrixX q = MatrixX::Random(20, map.joints());
    EXPECT_LT((map.to_controller(map.to_chain(q)) - q).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_TRUE(ControllerMap(map.formulas(types)) == map);
    EXPECT_EQ(map.square().rows(), static_cast<Index>(formulas.size()));
    EXPECT_TRUE((map.square() * map.inverse()).isIdentity(0));
  }
}

TEST(ControllerMap, ThePassiveJointIsTheOneThatFollowsOthers) {
  const ControllerMap map(Formulas{"J1", "J2", "J3-J2", "-J3", "J4"});
  EXPECT_EQ(map.joints(), 4);
  EXPECT_EQ(map.chain_joints(), 5);
  EXPECT_EQ(map.square()(3, 4), 1);  // the last value: by how much chain joint 4 differs from its law
  EXPECT_EQ(map.square().col(4).cwiseAbs().sum(), 1);
}

TEST(ControllerMap, WithoutAMapTheJointsAreTheSame) {
  const ControllerMap map;
  const MatrixX q = MatrixX::Random(3, 4);
  EXPECT_TRUE(map.same());
  EXPECT_EQ(map.to_chain(q), q);
  EXPECT_EQ(map.to_controller(q), q);
  EXPECT_EQ(map.joints(4), 4);
  EXPECT_EQ(map.types(std::vector<JointType>{JointType::prismatic}).front(), JointType::prismatic);
}

TEST(ControllerMap, TypesFollowTheChain) {
  using enum JointType;
  const std::vector<JointType> rail{prismatic, revolute, revolute};
  const ControllerMap map(Formulas{"-J1 + 500 mm", "J2", "J3 - J2"}, rail);
  EXPECT_EQ(map.types(rail), rail);
  EXPECT_DOUBLE_EQ(map.zeros()(0), 0.5);
  EXPECT_EQ(map.formulas(rail), (Formulas{"-J1 + 500 mm", "J2", "-J2 + J3"}));
  EXPECT_EQ(refused({"J1", "J2", "J1 + J3"}, rail),
            "ControllerMap: controller joint 1 moves revolute and prismatic joints");
}

TEST(ControllerMap, ComplaintsNameTheFormula) {
  EXPECT_EQ(refused({"J1", "J\xD3\x9A\n2"}),
            "formula 'J???2': J needs the number of a controller joint, counted from 1");
  EXPECT_LT(refused({"J1", "J" + std::string(5000, 'x')}).size(), 200u);
  EXPECT_EQ(refused({"J1", "J0"}), "formula 'J0': J needs the number of a controller joint, counted from 1");
  EXPECT_EQ(refused({"J1 J2"}), "formula 'J1 J2': '+' or '-' expected");
  EXPECT_EQ(refused({"J1 + 90"}), "formula 'J1 + 90': a number needs its unit: deg, rad, mm or m");
  EXPECT_EQ(refused({"J1 + 9 mm"}), "formula 'J1 + 9 mm': the joint is revolute, its zero is an angle");
  EXPECT_EQ(refused({"-(J1 + J2"}), "formula '-(J1 + J2': a parenthesis is not closed");
  EXPECT_EQ(refused({"x"}), "formula 'x': a joint J1 .. or a number with its unit expected");
  EXPECT_EQ(refused({"0.5*J1"}), "ControllerMap: the factor 0.5 is no whole number");
  const std::string undetermined = "ControllerMap: the joints of the chain do not determine those of the controller";
  EXPECT_EQ(refused({"J1", "2*J2"}), undetermined);
  EXPECT_EQ(refused({"J1", "J3", "J3"}), undetermined);
  EXPECT_EQ(refused({"J1", "J2 + J3"}), "ControllerMap: 3 controller joints for a chain of 2");
  const ControllerMap map(Formulas{"J2", "J1"});
  EXPECT_THROW(static_cast<void>(map.to_chain(MatrixX::Zero(2, 3))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(map.joints(3)), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::controller_map_test
