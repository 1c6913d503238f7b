// SPDX-License-Identifier: BSD-3-Clause
// Who is a kinematic model and who is not, and the helpers that any model gets.

#include "vernier/kinematics/concepts.hpp"

#include <gtest/gtest.h>

#include "turntable.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;

namespace concepts_test {
namespace {

static_assert(vn::ParametricModel<vn::DhChain<1>>);
static_assert(vn::ParametricModel<vn::DhChain<6>>);
static_assert(vn::ParametricModel<vn::DhChain<9, vn::ModifiedDh>>);
static_assert(vn::ParametricModel<vn::Framed<vn::DhChain<7>>>);
static_assert(vn::ParametricModel<vn::Framed<vn::Framed<vn::DhChain<2>>>>);
static_assert(!vn::KinematicModel<int>);
static_assert(!vn::KinematicModel<vn::DhTable<6>>);
static_assert(!vn::ParametricModel<vn::Robot<6>>);

using vernier_test::Turntable;
static_assert(vn::KinematicModel<Turntable>);
static_assert(!vn::ParametricModel<Turntable>);
static_assert(vn::KinematicModel<vn::Framed<Turntable>>);
static_assert(!vn::ParametricModel<vn::Framed<Turntable>>, "frames alone do not make a model parametric");

struct NoJoints : Turntable {
  static constexpr int dof = 0;
};
static_assert(!vn::KinematicModel<NoJoints>);

struct MayThrow : Turntable {
  vn::Isometry3 pose(const vn::JointVector<1>& q) const { return Turntable::pose(q); }
};
static_assert(!vn::KinematicModel<MayThrow>, "a controller calls pose: it must be noexcept");

struct NotConst : Turntable {
  vn::Vector3 position(const vn::JointVector<1>&) noexcept { return vn::Vector3::Zero(); }
};
static_assert(!vn::KinematicModel<NotConst>);

struct ColumnsOfAnotherArm : Turntable {
  vn::Jacobian<2> jacobian(const vn::JointVector<1>&) const noexcept { return vn::Jacobian<2>::Zero(); }
};
static_assert(!vn::KinematicModel<ColumnsOfAnotherArm>);

struct OnlyPose {
  static constexpr int dof = 1;
  vn::Isometry3 pose(const vn::JointVector<1>&) const noexcept { return vn::Isometry3::Identity(); }
};
static_assert(!vn::KinematicModel<OnlyPose>);

struct HidesParameterNames : vn::DhChain<2> {
  static int parameter_names() { return 0; }
};
static_assert(vn::KinematicModel<HidesParameterNames>);
static_assert(!vn::ParametricModel<HidesParameterNames>);

struct KnowsItsNominal : Turntable {
  vn::DhChain<1> nominal() const { return vn::DhChain<1>::from_rows({vn::DhRow{.a = 2}}); }
};

TEST(KinematicModel, NominalIsItsOwnOrTheModelItself) {
  static_assert(std::is_same_v<vn::NominalOf<Turntable>, Turntable>);
  static_assert(std::is_same_v<vn::NominalOf<KnowsItsNominal>, vn::DhChain<1>>);
  const Turntable table;
  EXPECT_EQ(&vn::nominal_of(table), &table);
  EXPECT_EQ(vn::nominal_of(KnowsItsNominal{}).row(0).a, 2);
}

}  // namespace
}  // namespace concepts_test
