// SPDX-License-Identifier: BSD-3-Clause
// The law suite itself: models that obey pass, and each broken law is named.

#include "vernier/testing/kinematic_laws.hpp"

#include <gtest/gtest.h>

#include "laws.hpp"
#include "random_chains.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::mentions;
using vernier_test::no_violations;
using vn::testing::kinematic_model_violations;
using vn::testing::parametric_model_violations;

namespace kinematic_laws_test {
namespace {

using Chain = vn::DhChain<3>;

const vn::JointRows<3>& samples() {
  static const vn::JointRows<3> rows = [] {
    vn::Rng rng(3);
    return vernier_test::random_joint_rows<3>(rng, 20);
  }();
  return rows;
}

const Chain& chain() {
  static const Chain value = [] {
    vn::Rng rng(4);
    return vernier_test::random_chain<3>(rng);
  }();
  return value;
}

enum class Fault { none, position, rotation, mirror, pose, jacobian, derivative, repeat, infinite, blocks };

/// A chain that breaks one law.
struct Faulty {
  static constexpr int dof = 3;
  Fault fault = Fault::none;
  mutable int calls = 0;

  vn::Isometry3 pose(const vn::JointVector<3>& q) const noexcept {
    vn::Isometry3 t = chain().pose(q);
    if (fault == Fault::rotation) t.linear() *= 1 + 1e-9;
    if (fault == Fault::mirror) t.linear().col(0) *= -1;
    if (fault == Fault::pose) t.translation().x() += 1e-9;
    if (fault == Fault::repeat) t.translation().x() += 1e-15 * ++calls;
    if (fault == Fault::infinite) t.translation().x() = std::nan("");
    return t;
  }
  vn::Vector3 position(const vn::JointVector<3>& q) const noexcept {
    vn::Vector3 p = pose(q).translation();
    if (fault == Fault::position) p.z() += 1e-9;
    return p;
  }
  vn::Jacobian<3> jacobian(const vn::JointVector<3>& q) const noexcept {
    vn::Jacobian<3> j = pose_and_jacobian(q).jacobian;
    if (fault == Fault::jacobian) j(5, 2) += 1e-9;
    return j;
  }
  vn::PoseAndJacobian<3> pose_and_jacobian(const vn::JointVector<3>& q) const noexcept {
    vn::PoseAndJacobian<3> both = chain().pose_and_jacobian(q);
    if (fault == Fault::derivative) both.jacobian(4, 1) += 1e-6;
    return both;
  }
  std::vector<vn::Isometry3> poses(const vn::JointRows<3>& joints) const {
    std::vector<vn::Isometry3> all = chain().poses(joints);
    if (fault == Fault::blocks) all.back() = all.front();
    return all;
  }
};
static_assert(vn::KinematicModel<Faulty>);

struct NamedFault {
  Fault fault;
  const char* sentence;
};

TEST(KinematicLaws, EachBrokenLawIsNamed) {
  EXPECT_TRUE(no_violations(kinematic_model_violations(Faulty{}, samples())));
  const NamedFault faults[] = {{Fault::position, "position(q) is the translation"},
                               {Fault::rotation, "orthonormal"},
                               {Fault::mirror, "orthonormal"},
                               {Fault::pose, "pose(q) is the pose of pose_and_jacobian(q)"},
                               {Fault::jacobian, "jacobian(q) is the jacobian of pose_and_jacobian(q)"},
                               {Fault::derivative, "jacobian(q) is the central difference"},
                               {Fault::repeat, "a repeated call gives the same bits"},
                               {Fault::infinite, "inf"},
                               {Fault::blocks, "many configurations at once"}};
  for (const auto& [fault, sentence] : faults) {
    const auto violations = kinematic_model_violations(Faulty{fault}, samples());
    EXPECT_TRUE(mentions(violations, sentence)) << sentence;
  }
}

TEST(KinematicLaws, ASentenceSaysWhereAndHowMuch) {
  const auto violations = kinematic_model_violations(Faulty{Fault::derivative}, samples());
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_NE(violations[0].find("row 4, column 1 at sample "), std::string::npos) << violations[0];
  EXPECT_NE(violations[0].find("the tolerance is 1e-08"), std::string::npos) << violations[0];
}

TEST(KinematicLaws, NoSamplesIsMisuse) {
  EXPECT_THROW(kinematic_model_violations(chain(), vn::JointRows<3>(0, 3)), std::invalid_argument);
  EXPECT_THROW(parametric_model_violations(chain(), vn::JointRows<3>(0, 3)), std::invalid_argument);
}

enum class ParameterFault { none, round_trip, names, twice, kinds, pose, derivative, same_model };

/// A chain whose parameters break one law.
template <ParameterFault fault>
struct FaultyParameters {
  static constexpr int dof = 3;
  static constexpr int num_parameters = 15;
  using Parameters = Eigen::Matrix<double, 15, 1>;
  Chain inner = chain();

  vn::Isometry3 pose(const vn::JointVector<3>& q) const noexcept { return inner.pose(q); }
  vn::Vector3 position(const vn::JointVector<3>& q) const noexcept { return inner.position(q); }
  vn::Jacobian<3> jacobian(const vn::JointVector<3>& q) const noexcept { return inner.jacobian(q); }
  vn::PoseAndJacobian<3> pose_and_jacobian(const vn::JointVector<3>& q) const noexcept {
    return inner.pose_and_jacobian(q);
  }
  Parameters parameters() const {
    Parameters p = inner.parameters();
    if (fault == ParameterFault::round_trip) p(7) = (p(7) + 1) - 1;
    return p;
  }
  FaultyParameters with_parameters(const Parameters& p) const {
    Parameters used = p;
    if (fault == ParameterFault::same_model) used(3) += 1e-9;
    return {inner.with_parameters(used)};
  }
  static std::vector<std::string> parameter_names() {
    auto names = Chain::parameter_names();
    if (fault == ParameterFault::names) names.pop_back();
    if (fault == ParameterFault::twice) names[3] = names[8];
    return names;
  }
  static std::vector<vn::ParameterKind> parameter_kinds() {
    auto kinds = Chain::parameter_kinds();
    if (fault == ParameterFault::kinds) kinds.push_back(vn::ParameterKind::angle);
    return kinds;
  }
  vn::ParameterJacobian<15> parameter_jacobian(const vn::JointVector<3>& q) const noexcept {
    vn::ParameterJacobian<15> j = inner.parameter_jacobian(q);
    if (fault == ParameterFault::derivative) j(2, 11) += 1e-6;
    return j;
  }
  template <class S>
  vn::IsometryOf<S> pose(const Eigen::Matrix<S, 3, 1>& q, const Eigen::Matrix<S, 15, 1>& p) const {
    vn::IsometryOf<S> t = inner.pose<S>(q, p);
    if (fault == ParameterFault::pose) t.translation().y() += S(1e-9);
    return t;
  }
};

template <ParameterFault fault>
std::vector<std::string> violations_of() {
  static_assert(vn::ParametricModel<FaultyParameters<fault>>);
  return parametric_model_violations(FaultyParameters<fault>{}, samples());
}

TEST(ParametricLaws, EachBrokenLawIsNamed) {
  EXPECT_TRUE(no_violations(violations_of<ParameterFault::none>()));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::round_trip>(), "is p bit for bit"));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::names>(), "parameter_names() has 14 entries for 15 parameters"));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::twice>(), "parameter_names() has 'theta2' twice"));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::kinds>(), "parameter_kinds() has 16 entries for 15 parameters"));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::pose>(), "pose(q, p) is with_parameters(p).pose(q)"));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::derivative>(), "parameter_jacobian(q) is the central difference"));
  EXPECT_TRUE(mentions(violations_of<ParameterFault::same_model>(), "with_parameters(parameters()) is the same model"));
}

}  // namespace
}  // namespace kinematic_laws_test
