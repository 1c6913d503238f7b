// SPDX-License-Identifier: BSD-3-Clause
// `NominalArm` for arms of VERNIER_JOINTS joints.

#include <algorithm>
#include <type_traits>
#include <utility>

#include "controller_rows.hpp"
#include "nominal_arm.hpp"
#include "with_branches.hpp"

namespace support {

namespace {

namespace vn = vernier;

template <int N>
class NominalArmOf final : public NominalArm {
 public:
  explicit NominalArmOf(const vn::RobotDescription& description)
      : robot_(description.arm<N>()), change_(robot_.controller) {}

  int joints() const override { return change_.moving(); }

  void poses(RowsView q, double* out, vn::ExecutorRef executor) const override {
    in_blocks(q, executor, [&](const vn::JointRows<N>& joints, vn::Index first) {
      const std::vector<vn::Isometry3> poses = robot_.arm.poses(joints);
      for (std::size_t i = 0; i < poses.size(); ++i) set_pose(poses[i], out + 16 * (first + static_cast<vn::Index>(i)));
    });
  }

  void positions(RowsView q, double* out, vn::ExecutorRef executor) const override {
    in_blocks(q, executor, [&](const vn::JointRows<N>& joints, vn::Index first) {
      const vn::PointRows points = robot_.arm.positions(joints);
      for (vn::Index i = 0; i < points.rows(); ++i)
        for (vn::Index k = 0; k < 3; ++k) out[3 * (first + i) + k] = points(i, k);
    });
  }

  void jacobians(RowsView q, double* out, vn::ExecutorRef executor) const override {
    executor.for_ranges(q.rows, [&](vn::Index begin, vn::Index end) {
      for (vn::Index i = begin; i < end; ++i)
        set_jacobian(change_, robot_.arm.jacobian(chain_joints(change_, q.row(i))), out + 6 * joints() * i);
    });
  }

  void inverse(RowsView targets, RowsView seeds, const IkSettings& settings, const IkRows& out,
               vn::ExecutorRef executor) const override {
    vn::IkOptions<N> options{.limits = robot_.limits,
                             .position_tolerance = settings.tolerance,
                             .rotation_tolerance = settings.tolerance,
                             .restarts = settings.restarts};
    const vn::InControllerJoints<vn::Framed<vn::DhChain<N>>> arm(robot_.arm, change_);
    executor.for_ranges(targets.rows, [&](vn::Index begin, vn::Index end) {
      for (vn::Index i = begin; i < end; ++i) {
        vn::JointVector<N> seed = vn::JointVector<N>::Zero();
        std::copy_n(seeds.row(seeds.rows == 1 ? 0 : i), joints(), seed.data());
        const vn::Isometry3 target = pose_at(targets.row(i));
        const vn::IkResult<N> found =
            settings.position_only ? vn::inverse_kinematics(arm, vn::Vector3(target.translation()), seed, options)
                                   : vn::inverse_kinematics(arm, target, seed, options);
        std::copy_n(found.joints.data(), joints(), out.joints + joints() * i);
        out.status[i] = found.status;
        out.position_error[i] = found.position_error;
        out.rotation_error[i] = found.rotation_error;
      }
    });
  }

  BranchRows branches(const double* target, const double* close_to, int held) const override {
    BranchRows out;
    vn::BranchOptions<N> options{.limits = robot_.limits};
    if (close_to != nullptr) std::copy_n(close_to, joints(), options.close_to.data());
    if (held >= 0) options.limits.lower(held) = options.limits.upper(held) = options.close_to(held);
    const vn::InControllerJoints<vn::Framed<vn::DhChain<N>>> arm(robot_.arm, change_);
    with_branches(robot_.arm, change_, options.limits, [&](const auto& roots) {
      if constexpr (std::is_null_pointer_v<std::remove_cvref_t<decltype(roots)>>) {
        throw std::invalid_argument(vn::message("branches: ", robot_.name, " has ", joints(),
                                                " joints; branches are those of six revolute joints that move"));
      } else {
        const vn::Branches<N> found = vn::all_branches(roots, arm, pose_at(target), options);
        for (const vn::Branch<N>& branch : found) {
          out.joints.emplace_back(branch.joints.data(), branch.joints.data() + joints());
          out.within_limits.push_back(branch.within_limits);
          out.branch.push_back(branch.singularities.branch());
        }
        out.reach = found.describe();
      }
    });
    return out;
  }

 private:
  /// Calls `use` with chain joints of blocks of rows, by column: as many as fit into the cache.
  template <class Use>
  void in_blocks(RowsView q, vn::ExecutorRef executor, const Use& use) const {
    constexpr vn::Index block = 512;
    executor.for_ranges(q.rows, [&](vn::Index begin, vn::Index end) {
      vn::JointRows<N> joints;
      for (vn::Index first = begin; first < end; first += block) {
        const vn::Index rows = std::min(block, end - first);
        joints.resize(rows, N);
        if (change_.same()) {
          const double* from = q.row(first);
          for (vn::Index i = 0; i < rows; ++i)
            for (vn::Index j = 0; j < N; ++j) joints(i, j) = *from++;
        } else {
          for (vn::Index i = 0; i < rows; ++i)
            vn::set_configuration(joints, i, chain_joints(change_, q.row(first + i)));
        }
        use(std::as_const(joints), first);
      }
    });
  }

  vn::DescribedRobot<N> robot_;
  vn::JointChange<N> change_;
};

}  // namespace

template <>
std::shared_ptr<const NominalArm> nominal_arm_of<VERNIER_JOINTS>(const vernier::RobotDescription& description) {
  return std::make_shared<const NominalArmOf<VERNIER_JOINTS>>(description);
}

}  // namespace support
