// SPDX-License-Identifier: BSD-3-Clause
// Where is the tool? A robot is a table of link parameters; forward kinematics turns joint angles into a pose.

#include <cstdio>
#include <numbers>
#include <vernier/core/so3.hpp>
#include <vernier/kinematics/framed.hpp>
#include <vernier/kinematics/robots.hpp>

namespace vn = vernier;
using namespace vernier::literals;

int main() {
  // The ABB IRB 120 in standard Denavit-Hartenberg form. A missing row would not compile.
  constexpr vn::DhChain<6> arm{{{
      {.a = 0_mm, .alpha = -90_deg, .d = 290_mm, .theta = 0_deg},
      {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
      {.a = 70_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
      {.a = 0_mm, .alpha = 90_deg, .d = 302_mm, .theta = 0_deg},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
      {.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg},
  }}};  // the catalogue has it too: vn::robots::abb_irb120().chain

  const vn::JointVector<6> q{10_deg, 20_deg, -30_deg, 40_deg, 50_deg, 60_deg};
  const vn::Isometry3 pose = arm.pose(q);
  const vn::Vector3 p = pose.translation() * 1e3, r = vn::log_so3(pose.linear()) * 180 / std::numbers::pi;
  std::printf("tool position         [%8.3f %8.3f %8.3f] mm\n", p.x(), p.y(), p.z());
  std::printf("tool rotation vector  [%8.3f %8.3f %8.3f] deg\n\n", r.x(), r.y(), r.z());

  // The Jacobian maps joint rates to the velocity of the tool: linear rows first, then angular.
  // It also propagates joint errors: here 1 mrad each.
  const vn::Jacobian<6> jacobian = arm.jacobian(q);
  for (int j = 0; j < 6; ++j)
    std::printf("joint %d off by 1 mrad moves the tool by %.3f mm\n", j + 1, jacobian.col(j).head<3>().norm());

  // A tool in the hand and a base somewhere in the room go around any model.
  vn::Isometry3 base = vn::Isometry3::Identity(), tool = vn::Isometry3::Identity();
  base.translation() << 1200_mm, 0, 0;
  tool.translation() << 0, 0, 109_mm;
  const vn::Framed<vn::DhChain<6>> in_the_cell(arm, base, tool);
  const vn::Vector3 tip = in_the_cell.position(q) * 1e3;
  std::printf("\nprobe tip in the cell [%8.3f %8.3f %8.3f] mm\n", tip.x(), tip.y(), tip.z());
}
