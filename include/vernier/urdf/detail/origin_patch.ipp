// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <string_view>

#include "vernier/core/check.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/urdf/detail/origin_patch.hpp"
#include "vernier/urdf/detail/roll_pitch_yaw.hpp"
#include "vernier/urdf/detail/urdf_document.hpp"
#include "vernier/urdf/detail/xml_tags.hpp"

namespace vernier::detail {

/// Replacements of bytes, in order.
struct TextPatch {
  std::size_t begin, end;
  std::string content;
};

/// What makes an origin of a joint's element between two tags.
/// @param joint the joint's start tag
/// @param origin its origin, if it has one
VERNIER_LOCAL void patch_origin(std::string_view text, const XmlTag& joint, const std::optional<XmlTag>& origin,
                                const Isometry3& frame, std::vector<TextPatch>& patches) {
  const auto three = [](const Vector3& v) {
    return exact_number(v.x()) + " " + exact_number(v.y()) + " " + exact_number(v.z());
  };
  const std::string xyz = three(frame.translation()), rpy = three(roll_pitch_yaw(frame.linear()));
  const Eigen::Quaterniond q(frame.linear());
  const std::string quat = three({q.x(), q.y(), q.z()}) + " " + exact_number(q.w());
  if (!origin) {
    const std::size_t next = text.find_first_not_of(" \t\r\n", joint.end);
    const std::string space(text.substr(joint.end, next - joint.end));
    patches.push_back({joint.end, joint.end, space + "<origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>"});
    return;
  }
  std::vector<TextPatch> here;
  std::string missing;
  const bool quaternion = attribute_value(text, *origin, "quat_xyzw").has_value();
  for (const auto& [name, value] : {std::pair<const char*, const std::string&>{"xyz", xyz},
                                    {quaternion ? "quat_xyzw" : "rpy", quaternion ? quat : rpy}}) {
    if (const auto place = attribute_value(text, *origin, name))
      here.push_back({place->first, place->second, value});
    else
      missing += std::string(" ") + name + "=\"" + value + "\"";
  }
  const std::size_t behind_name = origin->begin + 1 + origin->name.size();
  if (!missing.empty()) here.push_back({behind_name, behind_name, missing});
  std::sort(here.begin(), here.end(), [](const TextPatch& a, const TextPatch& b) { return a.begin < b.begin; });
  patches.insert(patches.end(), here.begin(), here.end());
}

VERNIER_IMPL std::string exact_number(double value) {
  std::string out = message(same_value(value, 0) ? 0.0 : value);  // not -0
  const std::size_t exponent = out.find('e');
  if (exponent != std::string::npos && out.find('.') == std::string::npos) out.insert(exponent, ".0");
  return out;
}

VERNIER_IMPL std::string with_origins(const std::string& text,
                                      const std::vector<std::pair<std::string, Isometry3>>& origins,
                                      const std::vector<std::string>& comment) {
  const UrdfDocument document = read_urdf_document(text, "the URDF");
  std::vector<TextPatch> patches;
  std::size_t number = 0;  // of the next joint
  int depth = 0;           // 1 inside of the robot
  const Isometry3* frame = nullptr;
  std::optional<XmlTag> joint, origin;
  for (std::optional<XmlTag> tag = next_tag(text, 0); tag; tag = next_tag(text, tag->end)) {
    if (depth == 0 && !tag->closing && !comment.empty()) {
      std::string lines;
      for (std::string line : comment) {
        for (std::size_t dash = line.find("--"); dash != std::string::npos; dash = line.find("--", dash))
          line.insert(dash + 1, " ");
        lines += "\n       " + line;
      }
      patches.push_back({tag->end, tag->end, "\n  <!-- " + lines.substr(8) + " -->"});
    }
    if (depth == 1 && !tag->closing && tag->name == "joint") {
      const std::string& name = document.joints.at(number++).name;
      const auto found = std::find_if(origins.begin(), origins.end(), [&](const auto& of) { return of.first == name; });
      frame = found == origins.end() ? nullptr : &found->second;
      joint = tag;
      origin.reset();
    }
    if (depth == 2 && !tag->closing && tag->name == "origin" && joint) origin = tag;
    if (depth == 2 && tag->closing && joint && tag->name == "joint") {
      if (frame != nullptr) patch_origin(text, *joint, origin, *frame, patches);
      joint.reset();
    }
    if (tag->closing)
      --depth;
    else if (!tag->empty)
      ++depth;
  }
  std::string out;
  std::size_t done = 0;
  for (const TextPatch& patch : patches) {
    out.append(text, done, patch.begin - done).append(patch.content);
    done = patch.end;
  }
  return out.append(text, done);
}

}  // namespace vernier::detail
