// SPDX-License-Identifier: BSD-3-Clause
#include "carried_camera.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "camera_calibration.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/io/camera_files.hpp"
#include "vernier/io/json.hpp"

namespace support {

namespace vn = vernier;

Option CarriedCamera::add_to(Program& program, const std::string& help) {
  Option where = program.add_option("--camera-mount", mount, help, "WHERE").one_of({"flange", "fixed"});
  Option what = program.add_option("--board", board, "the printed board (JSON)", "FILE");
  Option seen_by = program.add_option(
      "--intrinsics", intrinsics, "the camera, with the size of its images (JSON, or YAML of OpenCV or ROS)", "FILE");
  Option held = program
                    .add_option("--carried", carried,
                                "camera, or board, in the frame of the flange: position [mm] and rotation vector "
                                "[deg]; to some millimetres",
                                "X,Y,Z,RX,RY,RZ")
                    .delimiter(',')
                    .expected(6);
  where.needs(what).needs(seen_by).needs(held);
  for (Option one : {what, seen_by, held}) one.needs(where);
  return where;
}

vn::Board CarriedCamera::printed() const { return vn::read_board(board); }

vn::Camera CarriedCamera::camera() const {
  const vn::Camera out = read_camera(intrinsics);
  if (out.width <= 0 || out.height <= 0)
    throw UsageError(intrinsics + ": states no size of the images, which is needed here");
  return out;
}

vn::Isometry3 CarriedCamera::in_flange() const {
  const double mm = 1e-3, degree = std::numbers::pi / 180;
  return vn::rigid_motion(vn::exp_so3(vn::Vector3(vn::Vector3(carried[3], carried[4], carried[5]) * degree)),
                          vn::Vector3(vn::Vector3(carried[0], carried[1], carried[2]) * mm));
}

NamedPlaces read_places(const std::string& file) {
  NamedPlaces out;
  const nlohmann::json json = vn::read_json(file);
  const auto fail = [&](const std::string& what) { throw vn::DataError(file + ": " + what); };
  if (!json.contains("places") || !json["places"].is_array() || json["places"].empty())
    fail("has no list of places, as plan_poses --json writes it");
  for (const nlohmann::json& one : json["places"]) {
    const std::string at = "places[" + std::to_string(out.names.size()) + "]";
    const auto numbers = [&](const char* key) {
      if (!one.contains(key) || !one[key].is_array() || one[key].size() != 3)
        fail(at + "." + key + ": not three numbers");
      vn::Vector3 v;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!one[key][k].is_number()) fail(at + "." + key + ": not three numbers");
        v(static_cast<vn::Index>(k)) = one[key][k].get<double>();
      }
      return v;
    };
    if (!one.is_object() || !one.contains("name") || !one["name"].is_string()) fail(at + ": has no name");
    out.names.push_back(one["name"].get<std::string>());
    const vn::Vector3 position = numbers("position_mm") * 1e-3, turn = numbers("rotation_vector_rad");
    out.in_base.push_back(vn::rigid_motion(vn::exp_so3(turn), position));
  }
  return out;
}

}  // namespace support
