// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "vernier/core/data_error.hpp"
#include "vernier/io/json.hpp"
#include "vernier/urdf/detail/roll_pitch_yaw.hpp"
#include "vernier/urdf/detail/urdf_document.hpp"
#include "vernier/urdf/detail/xml_tags.hpp"

namespace vernier::detail {

/// An element of a URDF file, for messages that name file, line and what it is about.
class UrdfElement {
 public:
  UrdfElement(const tinyxml2::XMLElement& element, const std::string& file) : element_(&element), file_(&file) {}

  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    throw DataError(message(*file_, ", line ", element_->GetLineNum(), ": ", parts...));
  }
  int line() const { return element_->GetLineNum(); }
  const tinyxml2::XMLElement* child(const char* name) const { return element_->FirstChildElement(name); }
  /// A child that may be there once.
  const tinyxml2::XMLElement* only_child(const char* name, const std::string& owner) const {
    const tinyxml2::XMLElement* found = child(name);
    if (found != nullptr && found->NextSiblingElement(name) != nullptr)
      UrdfElement(*found->NextSiblingElement(name), *file_).fail(owner, " has two elements '", name, "'");
    return found;
  }
  /// An attribute that must be there, not empty.
  VERNIER_LOCAL std::string text(const char* attribute, const std::string& owner) const {
    const char* value = element_->Attribute(attribute);
    if (value == nullptr || *value == '\0') fail(owner, " has no ", attribute);
    return value;
  }
  bool has(const char* attribute) const { return element_->Attribute(attribute) != nullptr; }
  /// Three numbers.
  VERNIER_LOCAL Vector3 vector(const char* attribute, const Vector3& otherwise, const std::string& owner) const {
    Vector3 out = otherwise;
    if (has(attribute)) numbers(attribute, owner, {out.data(), 3});
    return out;
  }
  /// The rotation of an origin, by either of its attributes.
  /// @param quaternions whether the file's version has quat_xyzw
  VERNIER_LOCAL Matrix3 rotation(const std::string& owner, bool quaternions) const {
    if (!has("quat_xyzw")) return from_roll_pitch_yaw(vector("rpy", Vector3::Zero(), owner));
    if (has("rpy")) fail("the origin of ", owner, " has both rpy and quat_xyzw");
    if (!quaternions)
      fail("quat_xyzw of ", owner, " is of URDF 1.1, which <robot version=\"1.1\"> must say: others ignore it here");
    std::array<double, 4> q{};
    numbers("quat_xyzw", owner, q);
    const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
    constexpr double rounding = 1e-3;  // of three digits
    if (!(std::abs(quaternion.norm() - 1) < rounding))
      fail("quat_xyzw of ", owner, " has the length ", quaternion.norm(), ", must be 1");
    return quaternion.normalized().toRotationMatrix();
  }
  /// Why an element that places a frame does not say it all by these attributes; empty where it does.
  VERNIER_LOCAL std::string surplus(const std::string& owner,
                                    std::initializer_list<std::string_view> attributes) const {
    const auto told = [&](const char* kind, std::string_view name) {
      return message(*file_, ", line ", line(), ": the ", element_->Name(), " of ", owner, " has ", kind,
                     quotable(name), "', which is not known there");
    };
    for (const auto* one = element_->FirstAttribute(); one != nullptr; one = one->Next()) {
      const std::string_view name = one->Name();
      if (std::find(attributes.begin(), attributes.end(), name) == attributes.end())
        return told("an attribute '", name);
    }
    for (const auto* inner = element_->FirstChild(); inner != nullptr; inner = inner->NextSibling())
      if (inner->ToComment() == nullptr) return told("a content '", inner->Value());
    return {};
  }
  /// A number; 0 where there is none, as URDF has it.
  VERNIER_LOCAL double limit(const char* attribute, const std::string& owner) const {
    const char* value = element_->Attribute(attribute);
    return value == nullptr ? 0 : number(value, attribute, owner);
  }

 private:
  /// The numbers of an attribute, as many as there is room for.
  VERNIER_LOCAL void numbers(const char* attribute, const std::string& owner, std::span<double> out) const {
    std::size_t count = 0;
    for (std::string_view rest = element_->Attribute(attribute);; ++count) {
      const std::size_t first = rest.find_first_not_of(" \t\r\n");
      if (first == std::string_view::npos) break;
      rest.remove_prefix(first);
      const std::size_t end = (std::min)(rest.find_first_of(" \t\r\n"), rest.size());
      const double number = this->number(rest.substr(0, end), attribute, owner);
      if (count < out.size()) out[count] = number;
      rest.remove_prefix(end);
    }
    if (count != out.size()) fail(attribute, " of ", owner, " has ", count, " numbers, must have ", out.size());
  }
  VERNIER_LOCAL double number(std::string_view word, const char* attribute, const std::string& owner) const {
    const std::string_view unsigned_word = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    const auto [end, error] = std::from_chars(unsigned_word.data(), unsigned_word.data() + unsigned_word.size(), value);
    if (word.find("${") != std::string_view::npos)
      fail(attribute, " of ", owner, " is a xacro expression: run xacro first");
    if (error != std::errc{} || end != unsigned_word.data() + unsigned_word.size() || !std::isfinite(value))
      fail(attribute, " of ", owner, ": '", quotable(word), "' is not a number");
    constexpr double largest = 1000;
    if (std::abs(value) > largest) fail(attribute, " of ", owner, ": ", value, " is beyond any length or angle");
    return value;
  }

  const tinyxml2::XMLElement* element_;
  const std::string* file_;
};

/// What URDF does not have: document types, includes, xacro; nesting beyond reason.
VERNIER_LOCAL void refuse_foreign(const tinyxml2::XMLNode& node, const std::string& file, int depth) {
  constexpr int deepest = 50;
  for (const tinyxml2::XMLNode* child = node.FirstChild(); child != nullptr; child = child->NextSibling()) {
    const auto fail = [&](const std::string& what) {
      throw DataError(message(file, ", line ", child->GetLineNum(), ": ", what));
    };
    if (child->ToUnknown() != nullptr) fail("a document type or entity declaration; only plain XML is read");
    const tinyxml2::XMLElement* element = child->ToElement();
    if (element == nullptr) continue;
    const std::string_view name = element->Name();
    if (name.starts_with("xacro:")) fail("'" + quotable(name) + "' is of xacro: run xacro first");
    if (name.ends_with(":include")) fail("'" + quotable(name) + "': other files are not included");
    if (depth >= deepest) fail(message("nested deeper than ", deepest));
    refuse_foreign(*element, file, depth + 1);
  }
}

/// Small letters.
VERNIER_LOCAL std::string in_small_letters(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

/// Elements of a joint that are not known: those that may move its frame make it unreadable, others are ignored.
VERNIER_LOCAL void judge_unknown(const tinyxml2::XMLElement& xml, const std::string& owner, const std::string& file,
                                 UrdfJoint& out) {
  constexpr std::string_view known[] = {
      "parent", "child", "origin", "axis", "limit", "dynamics", "mimic", "safety_controller", "calibration"};
  constexpr std::string_view placing[] = {"pose",     "frame",       "transform",   "position",
                                          "rotation", "orientation", "translation", "axis2"};
  constexpr const char* places[] = {"xyz", "rpy", "quat_xyzw", "quat_wxyz", "pose", "position", "rotation"};
  const auto among = [](const auto& names, std::string_view name) {
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
  };
  for (const auto* child = xml.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string name = child->Name(), lower_case_name = in_small_letters(name);
    if (among(known, name)) continue;
    const bool has_place = std::any_of(std::begin(places), std::end(places),
                                       [&](const char* place) { return child->Attribute(place) != nullptr; });
    if (!among(known, lower_case_name) && !among(placing, lower_case_name) && !has_place)
      out.ignored.push_back("<" + quotable(name) + ">");
    else if (out.unreadable.empty())
      out.unreadable = message(file, ", line ", child->GetLineNum(), ": '", quotable(name), "' of ", owner,
                               among(known, lower_case_name) ? message(" is not known; is it '", lower_case_name, "'?")
                                                             : std::string(" is not known, and may move its frame"));
  }
  for (const auto* one = xml.FirstAttribute(); one != nullptr; one = one->Next())
    if (std::string_view(one->Name()) != "name" && std::string_view(one->Name()) != "type")
      out.ignored.push_back(message("its attribute '", quotable(one->Name()), "'"));
}

/// @param quaternions whether the file's version has quat_xyzw
VERNIER_LOCAL UrdfJoint read_urdf_joint(const tinyxml2::XMLElement& xml, const std::string& file, bool quaternions) {
  const UrdfElement element(xml, file);
  UrdfJoint out;
  const auto judge = [&](std::string surplus) {
    if (out.unreadable.empty()) out.unreadable = std::move(surplus);
  };
  out.line = element.line();
  out.name = element.text("name", "a joint");
  const std::string owner = "joint '" + quotable(out.name) + "'";
  out.type = element.text("type", owner);
  constexpr std::string_view types[] = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
  if (std::find(std::begin(types), std::end(types), out.type) == std::end(types))
    element.fail(owner, ": type '", quotable(out.type), "' is unknown");
  for (auto [which, link] : {std::pair{"parent", &out.parent}, {"child", &out.child}}) {
    const tinyxml2::XMLElement* found = element.only_child(which, owner);
    if (found == nullptr) element.fail(owner, " has no ", which);
    const UrdfElement named(*found, file);
    *link = named.text("link", message("the ", which, " of ", owner));
    judge(named.surplus(owner, {"link"}));
  }
  if (const auto* found = element.only_child("origin", owner)) {
    const UrdfElement origin(*found, file);
    out.origin.translation() = origin.vector("xyz", Vector3::Zero(), owner);
    out.origin.linear() = origin.rotation(owner, quaternions);
    judge(origin.surplus(owner, {"xyz", "rpy", "quat_xyzw"}));
  }
  if (const auto* found = element.only_child("axis", owner); found != nullptr && out.moves()) {
    const UrdfElement axis(*found, file);
    out.axis = axis.vector("xyz", Vector3::UnitX(), owner);
    if (!(out.axis.norm() > 1e-6)) axis.fail("the axis of ", owner, " is zero");
    out.axis.normalize();
    judge(axis.surplus(owner, {"xyz"}));
  }
  if (const auto* found = element.only_child("limit", owner); found != nullptr && out.type != "continuous") {
    const UrdfElement limit(*found, file);
    out.lower = limit.limit("lower", owner);
    out.upper = limit.limit("upper", owner);
    out.limited = out.lower < out.upper;
    if (!out.limited && out.moves()) out.ignored.push_back("its limit, whose upper value is not above the lower one,");
  }
  if (const auto* found = element.only_child("mimic", owner)) {
    const UrdfElement mimic(*found, file);
    out.mimics = true;
    if (out.moves()) {
      out.mimicked = mimic.text("joint", message("the mimic of ", owner));
      if (mimic.has("multiplier")) out.multiplier = mimic.limit("multiplier", owner);
      out.offset = mimic.limit("offset", owner);
    }
  }
  for (const char* name : {"safety_controller", "calibration"})
    if (element.child(name) != nullptr) out.ignored.push_back(message("<", name, ">"));
  judge_unknown(xml, owner, file, out);
  return out;
}

/// One parent a link, all links there, no cycle.
VERNIER_LOCAL void check_tree(const UrdfDocument& document, const std::string& file) {
  std::map<std::string, const UrdfJoint*> above;  // by child; null for one that nothing is above
  for (const std::string& link : document.links) above[link] = nullptr;
  for (const UrdfJoint& joint : document.joints) {
    const auto fail = [&](const auto&... parts) {
      throw DataError(message(file, ", line ", joint.line, ": joint '", quotable(joint.name), "': ", parts...));
    };
    for (const std::string* link : {&joint.parent, &joint.child})
      if (!above.contains(*link)) fail("link '", quotable(*link), "' is missing");
    const UrdfJoint*& other = above[joint.child];
    if (other != nullptr)
      fail("link '", quotable(joint.child), "' has another parent, by joint '", quotable(other->name), "'");
    other = &joint;
  }
  std::map<std::string, int> seen;  // in which walk
  int walk = 0;
  for (const std::string& start : document.links) {
    ++walk;
    for (const std::string* link = &start;;) {
      int& when = seen[*link];
      if (when == walk) throw DataError(file + ": link '" + quotable(*link) + "' is above itself, a cycle of joints");
      if (when != 0) break;
      when = walk;
      const UrdfJoint* joint = above[*link];
      if (joint == nullptr) break;
      link = &joint->parent;
    }
  }
}

VERNIER_IMPL UrdfDocument read_urdf_document(const std::string& text, const std::string& file) {
  constexpr std::size_t largest = 16u << 20u;
  if (text.size() > largest) throw DataError(message(file, ": ", text.size(), " bytes, more than ", largest));
  tinyxml2::XMLDocument xml;
  if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const std::string_view what = xml.ErrorName();
    if (xml.ErrorID() == tinyxml2::XML_ERROR_EMPTY_DOCUMENT) throw DataError(file + ": empty, not URDF");
    if (xml.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) throw DataError(file + ": nested too deeply");
    throw DataError(message(file, ", line ", xml.ErrorLineNum(), ": not valid XML (", what, ")"));
  }
  refuse_foreign(xml, file, 0);
  require_nested_tags(text, file);
  const tinyxml2::XMLElement* root = xml.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot")
    throw DataError(file + ": not URDF, its outermost element is not 'robot'");
  if (root->NextSiblingElement() != nullptr)
    UrdfElement(*root->NextSiblingElement(), file).fail("a second root element");
  UrdfDocument out;
  out.name = UrdfElement(*root, file).text("name", "the robot");
  const std::string version = UrdfElement(*root, file).has("version") ? root->Attribute("version") : "1.0";
  if (version != "1.0" && version != "1.1")
    UrdfElement(*root, file).fail("version '", quotable(version), "' of URDF; 1.0 and 1.1 are read");
  for (const auto* part = root->FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
    const std::string name = part->Name(), lower_case_name = in_small_letters(name);
    if (name != lower_case_name && (lower_case_name == "link" || lower_case_name == "joint"))
      UrdfElement(*part, file).fail("'", quotable(name), "' is not known; is it '", lower_case_name, "'?");
    if (lower_case_name == "include" || lower_case_name == "model")
      UrdfElement(*part, file).fail("'", quotable(name), "': parts of other files or formats are not included");
  }
  std::map<std::string, int> links, joints;  // line of each name
  const auto once = [&](std::map<std::string, int>& names, const std::string& name, const char* what, int line) {
    const auto [at, fresh] = names.emplace(name, line);
    if (!fresh)
      throw DataError(
          message(file, ", line ", line, ": ", what, " '", quotable(name), "' is also in line ", at->second));
  };
  for (const auto* link = root->FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link")) {
    out.links.push_back(UrdfElement(*link, file).text("name", "a link"));
    once(links, out.links.back(), "link", link->GetLineNum());
  }
  for (const auto* joint = root->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    out.joints.push_back(read_urdf_joint(*joint, file, version == "1.1"));
    once(joints, out.joints.back().name, "joint", joint->GetLineNum());
  }
  if (out.links.empty()) throw DataError(file + ": has no links");
  check_tree(out, file);
  return out;
}

}  // namespace vernier::detail
