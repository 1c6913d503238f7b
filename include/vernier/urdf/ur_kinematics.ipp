// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <set>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/io/json.hpp"
#include "vernier/kinematics/detail/rows_of_axes.hpp"
#include "vernier/urdf/detail/origin_patch.hpp"
#include "vernier/urdf/detail/roll_pitch_yaw.hpp"
#include "vernier/urdf/ur_kinematics.hpp"

namespace vernier {

namespace detail {

inline constexpr std::array<const char*, 6> ur_links{"shoulder", "upper_arm", "forearm",
                                                     "wrist_1",  "wrist_2",   "wrist_3"};
inline constexpr std::array<const char*, 6> ur_values{"x", "y", "z", "roll", "pitch", "yaw"};

/// Whether a hash can stand in a file as it is: 1 to 64 letters, digits and underscores.
VERNIER_LOCAL bool is_ur_hash(const std::string& hash) {
  return !hash.empty() && hash.size() <= 64 &&
         hash.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == std::string::npos;
}

/// A node of a kinematics file, for messages that name file, line and key.
class UrYaml {
 public:
  UrYaml(const YAML::Node& node, std::string file, std::string key)
      : node_(node), file_(std::move(file)), key_(std::move(key)) {}

  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    const int line = node_.Mark().line + 1;
    throw DataError(line > 0 ? message(file_, ", line ", line, ": ", parts...) : message(file_, ": ", parts...));
  }
  VERNIER_LOCAL bool has(const std::string& key) const { return static_cast<bool>(map()[key]); }
  VERNIER_LOCAL UrYaml at(const std::string& key) const {
    if (!has(key)) fail("key '", path(key), "' is missing");
    return {map()[key], file_, path(key)};
  }
  VERNIER_LOCAL std::string text() const {
    if (!node_.IsScalar()) fail("'", key_, "' must be a text");
    return node_.Scalar();
  }
  VERNIER_LOCAL double number() const {
    if (!node_.IsScalar()) fail("'", key_, "' must be a number");
    const std::string& word = node_.Scalar();
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
      fail("'", key_, "': '", quotable(word), "' is not a number");
    constexpr double largest = 1000;
    if (std::abs(value) > largest) fail("'", key_, "': ", value, " is beyond any length or angle");
    return value;
  }

 private:
  VERNIER_LOCAL std::string path(const std::string& key) const { return key_.empty() ? key : key_ + "." + key; }
  VERNIER_LOCAL const YAML::Node& map() const {
    if (!node_.IsMap()) fail(key_.empty() ? "must be a map of keys" : "'" + key_ + "' must be a map of keys");
    std::set<std::string> keys;
    for (const auto& entry : node_)
      if (entry.first.IsScalar() && !keys.insert(entry.first.Scalar()).second)
        fail("key '", path(quotable(entry.first.Scalar())), "' is given twice");
    return node_;
  }

  YAML::Node node_;
  std::string file_, key_;
};

}  // namespace detail

VERNIER_IMPL UrKinematics UrKinematics::of(const ArmGeometry& geometry, const std::string& hash) {
  bool fits = geometry.joints() == 6 && !geometry.chain().modified();
  for (int i = 0; fits && i < 6; ++i) fits = geometry.chain().revolute(i);
  demand(fits, "UrKinematics: not an arm of six revolute joints in the standard convention");
  UrKinematics out;
  out.hash = hash;
  Isometry3 before = geometry.base().isometry();
  for (std::size_t i = 0; i < 6; ++i) {
    const DhRow& row = geometry.chain().rows()[i];
    out.origins[i] = before * Eigen::AngleAxisd(row.theta, Vector3::UnitZ()) * Eigen::Translation3d(0, 0, row.d);
    before = Eigen::Translation3d(row.a, 0, 0) * Eigen::AngleAxisd(row.alpha, Vector3::UnitX()) *
             Eigen::AngleAxisd(row.beta, Vector3::UnitY());
  }
  return out;
}

VERNIER_IMPL UrKinematics UrKinematics::of(const UrdfChain& chain, const ArmGeometry& geometry,
                                           const std::string& hash) {
  demand(chain.moving.size() == 6, "UrKinematics: ", chain.moving.size(), " joints move, must be 6");
  const std::vector<Isometry3> origins = joint_origins(chain, geometry);
  UrKinematics out;
  out.hash = hash;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto joint = static_cast<std::size_t>(chain.moving[i]);
    const Vector3 axis = chain.link_in_row[i].linear().row(2).transpose();  // of the joint, in its own frame
    demand(chain.robot.rows[i].joint == JointType::revolute && (axis - Vector3::UnitZ()).norm() < 1e-9 &&
               (i == 0 || chain.moving[i] == chain.moving[i - 1] + 1),
           "UrKinematics: joint '", chain.joints[joint],
           "' does not turn about its z axis next to the joint before, as those of Universal Robots do");
    out.origins[i] = origins[joint];
  }
  return out;
}

VERNIER_IMPL RobotDescription UrKinematics::robot(const std::string& name) const {
  std::vector<detail::JointAxis> axes;
  Isometry3 at = Isometry3::Identity();
  for (const Isometry3& origin : origins) {
    at = at * origin;
    axes.push_back({at.linear().col(2), at.translation()});
  }
  const detail::AxisRows found = detail::rows_of_axes(axes);
  RobotDescription out;
  out.name = name;
  out.files = files;
  out.rows = found.rows;
  out.base = found.base;
  out.tool = found.frames.back().inverse() * at;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  out.limits.assign(6, {-infinity, infinity});
  out.drives.resize(6);
  for (const char* link : detail::ur_links) out.joint_names.push_back(link);
  return out;
}

VERNIER_IMPL std::string UrKinematics::text(const ExportNote& note) const {
  std::string out;
  for (const std::string& line : note.lines()) out += "# " + line + "\n";
  out += "# The controller keeps its own calibration; joint values that it computes are by that one, not by this.\n";
  out += "kinematics:\n";
  for (std::size_t i = 0; i < 6; ++i) {
    const Vector3 xyz = origins[i].translation(), rpy = detail::roll_pitch_yaw(origins[i].linear());
    out += message("  ", detail::ur_links[i], ":\n");
    for (std::size_t k = 0; k < 6; ++k) {
      const auto at = static_cast<Index>(k % 3);
      out += message("    ", detail::ur_values[k], ": ", detail::exact_number(k < 3 ? xyz(at) : rpy(at)), "\n");
    }
  }
  if (hash.empty()) return out;
  demand(detail::is_ur_hash(hash), "UrKinematics: the hash must be of up to 64 letters, digits and underscores");
  return out + "  hash: " + hash + "\n";
}

VERNIER_IMPL UrKinematics read_ur_kinematics(const std::string& path) {
  std::string content;
  try {
    content = read_file(path);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
  constexpr std::size_t largest = 1u << 16u;  // the driver writes 1 kB; of 1 MiB the parser can take many seconds
  if (content.size() > largest) throw DataError(message(path, ": ", content.size(), " bytes, more than ", largest));
  YAML::Node document;
  try {
    document = YAML::Load(content);
  } catch (const YAML::Exception& e) {
    throw DataError(message(path, ", line ", e.mark.line + 1, ": not valid YAML (", detail::quotable(e.msg), ")"));
  }
  const detail::UrYaml kinematics = detail::UrYaml(document, path, "").at("kinematics");
  UrKinematics out;
  out.files.push_back({path, sha256(content)});
  for (std::size_t i = 0; i < 6; ++i) {
    const detail::UrYaml link = kinematics.at(detail::ur_links[i]);
    Vector6 values;
    for (std::size_t k = 0; k < 6; ++k) values(static_cast<Index>(k)) = link.at(detail::ur_values[k]).number();
    out.origins[i] = Isometry3::Identity();
    out.origins[i].translation() = values.head<3>();
    out.origins[i].linear() = detail::from_roll_pitch_yaw(values.tail<3>());
  }
  if (!kinematics.has("hash")) return out;
  const detail::UrYaml hash = kinematics.at("hash");
  out.hash = hash.text();
  if (!detail::is_ur_hash(out.hash)) hash.fail("'kinematics.hash' must be of up to 64 letters, digits and underscores");
  return out;
}

}  // namespace vernier
