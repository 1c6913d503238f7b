// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_page.hpp"

#include <fmt/format.h>

#include <utility>

#include "dispatch.hpp"
#include "file_name.hpp"
#include "report_page.hpp"

namespace support {

namespace vn = vernier;

namespace {

/// Poses of a page, with the names of the training rows.
struct PagePoses {
  vn::ReportInput held_out;               ///< poses and their times
  std::vector<std::string> learned_from;  ///< training rows, one station after the other
};

template <int N>
PagePoses poses_of(const vn::DescribedRobot<N>& robot, const MeasuredFiles<N>& measured) {
  PagePoses out;
  for (std::size_t s = 0; s < measured.train.poses().size(); ++s) {
    const vn::Dataset<N>&train = measured.train.poses()[s], &test = measured.test.poses()[s];
    for (const vn::Index line : train.origin().line)
      out.learned_from.push_back(fmt::format("line {} of {}", line, file_name(measured.names[s])));
    add_poses(out.held_out, robot.arm, test);
  }
  return out;
}

}  // namespace

template <int N>
vn::ReportInput calibration_page(const vn::CalibrationReport& report, const CalibrationOptions& o,
                                 const vn::DescribedRobot<N>& robot, const MeasuredFiles<N>& measured) {
  PagePoses poses = poses_of(robot, measured);
  vn::ReportInput page = vn::report_input(report, robot.name, poses.learned_from);
  poses.held_out.poses.normalised = page.poses.normalised;
  poses.held_out.poses.gates = page.poses.gates;
  poses.held_out.poses.visited = page.poses.visited;
  page.poses = std::move(poses.held_out.poses);
  page.times = std::move(poses.held_out.times);
  page.provenance.inputs = measured.inputs;
  if (o.accept_mm > 0) page.accept = o.accept_mm * 1e-3;
  return page;
}

#define VERNIER_INSTANTIATE(N)                                                                          \
  template vn::ReportInput calibration_page<N>(const vn::CalibrationReport&, const CalibrationOptions&, \
                                               const vn::DescribedRobot<N>&, const MeasuredFiles<N>&);
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
