// SPDX-License-Identifier: BSD-3-Clause
#include "measured_data.hpp"

#include "dispatch.hpp"
#include "vernier/data/csv.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// Joints of the controller: a reader that knows no controller returns those of the file.
vn::CsvFormat of_file(vn::CsvFormat format) {
  format.controller = {};
  return format;
}

/// Poses of a set of the library, joints as they are there.
template <int N>
MeasuredPoses poses_of(const vn::Dataset<N>& data, std::string name) {
  return {data.joints(),       data.positions(), data.orientations(), data.previous(), data.times(),
          data.temperatures(), data.payloads(),  data.covariances(),  data.origin(),   std::move(name)};
}

/// Types of joints of the controller's, for which a number of joints is known at run time.
std::vector<vn::JointType> types_of(const vn::RobotDescription& robot) {
  return robot.controller.types(robot.joint_types());
}

}  // namespace

void validate(const MeasuredPoses& poses) {
  dispatch_dof(static_cast<int>(poses.joints.cols()),
               [&](auto n) { static_cast<void>(reflectors_of<n()>(poses, {})); });
}

MeasuredPoses rows_of(const MeasuredPoses& poses, const std::vector<vn::Index>& rows) {
  for (const vn::Index row : rows) vn::demand(row >= 0 && row < poses.size(), "rows: row ", row, " of ", poses.size());
  return dispatch_dof(static_cast<int>(poses.joints.cols()), [&](auto n) {
    vn::Dataset<n()> data = dataset_of<n()>(poses, {});
    if (!poses.points.empty()) data = vn::approached_together(data, poses.points);
    MeasuredPoses out = poses_of(data.rows(rows), poses.name);
    for (const vn::Index row : rows)
      if (!poses.points.empty()) out.points.push_back(poses.points[static_cast<std::size_t>(row)]);
    return out;
  });
}

MeasuredPoses read_measured_poses(const std::string& path, const vn::RobotDescription& robot,
                                  const vn::CsvFormat& format) {
  const std::vector<vn::JointType> types = types_of(robot);
  return dispatch_dof(robot.controller_joints(), [&](auto n) {
    const vn::detail::PoseColumns columns = vn::detail::read_pose_columns(path, n(), types, of_file(format));
    MeasuredPoses out = poses_of(vn::detail::dataset_of<n()>(columns), path);
    out.points = columns.points;
    return out;
  });
}

MeasuredDistances read_measured_distances(const std::string& path, const vn::RobotDescription& robot,
                                          const vn::CsvFormat& format) {
  const std::vector<vn::JointType> types = types_of(robot);
  return dispatch_dof(robot.controller_joints(), [&](auto n) {
    const vn::Distances<n()> read = vn::read_distances<n()>(path, types, of_file(format));
    return MeasuredDistances{read.joints(), read.lengths(), read.origin(), path};
  });
}

std::vector<vn::Contact> read_measured_contacts(const std::string& path, const vn::RobotDescription& robot,
                                                const vn::CsvFormat& given) {
  vn::CsvFormat format = given;
  format.controller = robot.controller;
  return vn::read_contacts(path, robot.dof(), robot.joint_types(), format);
}

void write_measured_poses(const std::string& path, const MeasuredPoses& poses, const vn::RobotDescription& robot) {
  const std::vector<vn::JointType> types = robot.joint_types();
  dispatch_dof(robot.dof(), [&](auto n) {
    if (poses.points.empty())
      vn::write_dataset(path, dataset_of<n()>(poses, robot.controller), types, robot.controller);
    else
      vn::write_reflectors<n()>(path, reflectors_of<n()>(poses, robot.controller), types, robot.controller);
  });
}

}  // namespace support
