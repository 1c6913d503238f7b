// SPDX-License-Identifier: BSD-3-Clause
// URDF files read and written, against urdfdom (the parser), kdl_parser and KDL's forward kinematics.

#include <gtest/gtest.h>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "larger.hpp"
#include "urdf_samples.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/urdf/export_urdf.hpp"
#include "vernier/urdf/urdf_text.hpp"

namespace vernier::urdf_kdl_test {
namespace {

constexpr double tolerance = 1e-12;  // m, and entries of rotations, on arms of up to about 6 m

/// What KDL makes of a URDF file between two links.
class Peer {
 public:
  Peer(const std::string& text, const std::string& base, const std::string& tip) {
    KDL::Tree tree;
    EXPECT_TRUE(kdl_parser::treeFromString(text, tree)) << text;
    EXPECT_TRUE(tree.getChain(base, tip, chain_)) << text;
  }
  Index joints() const { return chain_.getNrOfJoints(); }
  Eigen::Matrix4d pose(const VectorX& q) const {
    KDL::ChainFkSolverPos_recursive forward(chain_);
    KDL::JntArray joints(static_cast<unsigned>(q.size()));
    joints.data = q;
    KDL::Frame frame;
    EXPECT_EQ(forward.JntToCart(joints, frame), 0);
    Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
    for (int r = 0; r < 3; ++r) {
      out(r, 3) = frame.p(r);
      for (int c = 0; c < 3; ++c) out(r, c) = frame.M(r, c);
    }
    return out;
  }

 private:
  KDL::Chain chain_;
};

double worst_difference(const ArmGeometry& ours, const Peer& peer, Rng& rng, int samples) {
  EXPECT_EQ(peer.joints(), ours.joints());
  if (peer.joints() != ours.joints()) return 1;
  MatrixX q(samples, ours.joints());
  for (Index i = 0; i < q.size(); ++i) q(i) = rng.uniform(-3, 3);
  const auto poses = ours.poses(q);
  double worst = 0;
  for (Index i = 0; i < samples; ++i) {
    const Eigen::Matrix4d difference =
        poses[static_cast<std::size_t>(i)].matrix() - peer.pose(VectorX(q.row(i).transpose()));
    worst = vernier_test::larger(worst, difference.cwiseAbs().maxCoeff());
  }
  return worst;
}

/// The chain as read, and another geometry as written.
void compare(const std::string& text, const std::string& base, const std::string& tip, bool frames, Rng& rng,
             int samples) {
  const UrdfChain chain = parse_urdf(text, "in", base, tip);
  const ArmGeometry nominal = chain.robot.geometry();
  EXPECT_LE(worst_difference(nominal, Peer(text, base, tip), rng, samples), tolerance) << text;
  VectorX p = nominal.parameters();
  const Index last_row = 6 + 5 * (nominal.joints() - 1);
  const double size = rng.uniform() < 0.5 ? 1e-3 : 0.2;
  for (Index i = frames ? 0 : 6; i < (frames ? p.size() : last_row); ++i) p(i) += rng.uniform(-size, size);
  ArmGeometry made = nominal.with_parameters(p);
  if (!frames) made = made.with_frames(nominal.base(), nominal.tool());
  const std::string out = export_urdf(chain, made, {});
  EXPECT_LE(worst_difference(made, Peer(out, base, tip), rng, samples), tolerance) << out;
}

TEST(UrdfAgainstKdl, ThreeArmsInAndOut) {
  Rng rng(1);
  compare(vernier_test::ur_like_urdf(), "base_link", "tool0", true, rng, 1000);
  compare(vernier_test::ur_like_urdf(), "base_link_inertia", "wrist_3_link", false, rng, 1000);
  compare(vernier_test::abb_like_urdf(), "base_link", "tool0", true, rng, 1000);
  compare(vernier_test::abb_like_urdf(), "base_link", "left_finger", false, rng, 1000);
  compare(vernier_test::seven_axis_urdf(), "link_0", "link_7", false, rng, 1000);
}

TEST(UrdfAgainstKdl, RandomTreesInAndOut) {
  Rng rng(2);
  for (int tree = 0; tree < 200 && !testing::Test::HasFailure(); ++tree)
    compare(vernier_test::random_tree_urdf(rng, 1 + tree % 9), "base", "tip", tree % 2 == 0, rng, 10);
}

TEST(UrdfAgainstKdl, CatalogueArmsAsPlainFiles) {
  Rng rng(4);
  for (const RobotDescription& robot :
       {RobotDescription::of(robots::abb_irb120()), RobotDescription::of(robots::puma560()),
        RobotDescription::of(robots::barrett_wam()), RobotDescription::of(robots::fanuc_r2000ib_165f())})
    EXPECT_LE(worst_difference(robot.geometry(), Peer(urdf_text(robot), "base_link", "tool"), rng, 100), tolerance)
        << robot.name;
}

// Rows next to singular ones: axes that are nearly parallel, upside down or the same.
TEST(UrdfAgainstKdl, AnyAngleBetweenAxes) {
  Rng rng(3);
  for (const double angle : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.199, 0.2, 0.201, 1.0, 3.1, 3.14159265, 3.2})
    for (const char* at : {"0 0 0", "0.3 0 0", "0 0 0.2", "0.1 -0.2 0.3"}) {
      std::string text = "<robot name='three'><link name='base'/>";
      for (int i = 0; i < 3; ++i)
        text += message("<link name='", i == 2 ? "tip" : message("l", i), "'/><joint name='j", i,
                        "' type='continuous'><parent link='", i == 0 ? "base" : message("l", i - 1), "'/><child link='",
                        i == 2 ? "tip" : message("l", i), "'/><origin xyz='", at, "' rpy='", angle, " 0 ", i,
                        "'/><axis xyz='0 0 1'/></joint>");
      compare(text + "</robot>", "base", "tip", false, rng, 20);
    }
}

}  // namespace
}  // namespace vernier::urdf_kdl_test
