// SPDX-License-Identifier: BSD-3-Clause
// `NominalArm` for arms of VERNIER_JOINTS joints.

#include <algorithm>
#include <type_traits>
#include <utility>

#include "controller_rows.hpp"
#include "nominal_arm.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/kinematics/detail/chain_blocks.hpp"
#include "with_branches.hpp"

namespace support {

namespace {

namespace vn = vernier;

using Pair = vn::detail::Simd<2>::Double;

/// Copies rows of N numbers into columns, two rows at a time.
template <int N>
void to_columns(const double* rows, vn::Index n, double* columns, vn::Index stride) noexcept {
  vn::Index i = 0;
  for (; i + 2 <= n; i += 2, rows += 2 * N) {
    int j = 0;
    for (; j + 2 <= N; j += 2) {
      Pair a, b;
      vn::detail::load<2>(a, rows + j);
      vn::detail::load<2>(b, rows + N + j);
      vn::detail::store<2>(columns + j * stride + i, Pair{a[0], b[0]});
      vn::detail::store<2>(columns + (j + 1) * stride + i, Pair{a[1], b[1]});
    }
    if (j < N) vn::detail::store<2>(columns + j * stride + i, Pair{rows[j], rows[N + j]});
  }
  for (int j = 0; j < N && i < n; ++j) columns[j * stride + i] = rows[j];
}

/// Copies three columns of n coordinates into points, two at a time.
inline void to_points(const double* columns, vn::Index n, double* points) noexcept {
  vn::Index i = 0;
  for (; i + 2 <= n; i += 2, points += 6) {
    Pair x, y, z;
    vn::detail::load<2>(x, columns + i);
    vn::detail::load<2>(y, columns + n + i);
    vn::detail::load<2>(z, columns + 2 * n + i);
    vn::detail::store<2>(points, Pair{x[0], y[0]});
    vn::detail::store<2>(points + 2, Pair{z[0], x[1]});
    vn::detail::store<2>(points + 4, Pair{y[1], z[1]});
  }
  for (int k = 0; k < 3 && i < n; ++k) points[k] = columns[k * n + i];
}

template <int N>
class NominalArmOf final : public NominalArm {
 public:
  explicit NominalArmOf(const vn::RobotDescription& description)
      : robot_(description.arm<N>()), change_(robot_.controller) {}

  int joints() const override { return change_.moving(); }

  void poses(RowsView q, double* out, vn::ExecutorRef executor) const override {
    in_blocks(q, executor, [&](const double* joints, vn::Index n, vn::Index first) {
      evaluate(joints, n, {.matrices = out + 16 * first});
    });
  }

  void positions(RowsView q, double* out, vn::ExecutorRef executor) const override {
    in_blocks(q, executor, [&](const double* joints, vn::Index n, vn::Index first) {
      double positions[3 * block];
      evaluate(joints, n, {.positions = positions});
      to_points(positions, n, out + 3 * first);
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
  static constexpr vn::Index block = 64;  // rows whose joints and poses stay in the cache

  /// Calls `use` with chain joints of blocks of rows: columns of `block` numbers, how many count, the first row.
  template <class Use>
  void in_blocks(RowsView q, vn::ExecutorRef executor, const Use& use) const {
    executor.for_ranges(q.rows, [&](vn::Index begin, vn::Index end) {
      double joints[N * block];
      for (vn::Index first = begin; first < end; first += block) {
        const vn::Index n = std::min(block, end - first);
        if (change_.same()) {
          to_columns<N>(q.row(first), n, joints, block);
        } else {
          for (vn::Index i = 0; i < n; ++i) {
            const vn::JointVector<N> of_row = chain_joints(change_, q.row(first + i));
            for (int j = 0; j < N; ++j) joints[j * block + i] = of_row(j);
          }
        }
        use(joints, n, first);
      }
    });
  }

  void evaluate(const double* joints, vn::Index n, const vn::detail::BlockResults& results) const {
    const double* tool = robot_.arm.tool().data();
    vn::detail::evaluate_chain(robot_.arm.chain().view(),
                               {.base = robot_.arm.base().data(), .point = tool + 12, .tool = tool}, joints, n, block,
                               results);
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
