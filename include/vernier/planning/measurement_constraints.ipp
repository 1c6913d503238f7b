// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/kinematics/detail/chain_blocks.hpp"
#include "vernier/planning/measurement_constraints.hpp"

namespace vernier {

VERNIER_IMPL const char* name_of(Rejection reason) {
  switch (reason) {
    case Rejection::joint_limits: return "near or beyond the joint limits";
    case Rejection::tool_box: return "tool out of its box";
    case Rejection::range: return "out of the tracker's range";
    case Rejection::acceptance: return "reflector turned away";
    case Rejection::line_of_sight: return "beam blocked by a link";
    case Rejection::self_collision: return "links collide";
    default: return "possible";
  }
}

VERNIER_IMPL double segment_distance(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 u = b - a, v = d - c, w = a - c;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), uw = u.dot(w), vw = v.dot(w);
  const double determinant = uu * vv - uv * uv;
  const auto within = [](double x) { return std::clamp(x, 0.0, 1.0); };
  double s = determinant > 1e-14 * uu * vv ? within((uv * vw - vv * uw) / determinant) : 0;
  double t = vv > 0 ? (uv * s + vw) / vv : 0;
  if (t < 0 || t > 1 || !(vv > 0)) {
    t = within(t);
    s = uu > 0 ? within((uv * t - uw) / uu) : 0;
  }
  const Vector3 on_first = s * u, on_second = t * v, gap = w + on_first;
  return (gap - on_second).norm();
}

VERNIER_IMPL MeasurementScene::MeasurementScene(const ArmGeometry& arm, MeasurementConstraints constraints)
    : arm_(arm), constraints_(std::move(constraints)) {
  const MeasurementConstraints& c = constraints_;
  const Index joints = arm_.joints();
  static_cast<void>(c.controller.joints(static_cast<int>(joints)));
  for (const VectorX* limits : {&c.lower, &c.upper})
    demand(limits->size() == 0 || limits->size() == joints, "MeasurementScene: limits of ", limits->size(),
           " joints for an arm of ", joints);
  demand(c.joint_margin >= 0, "MeasurementScene: joint_margin is ", c.joint_margin, ", must not be negative");
  if (c.tool_box)
    for (Index k = 0; k < 3; ++k)
      demand(c.tool_box->lower(k) < c.tool_box->upper(k),
             "MeasurementScene: the lower corner of the tool box is not below the upper one");
  demand(c.link_radii.empty() || static_cast<Index>(c.link_radii.size()) == joints, "MeasurementScene: radii of ",
         c.link_radii.size(), " links for an arm of ", joints);
  for (const double radius : c.link_radii)
    demand(radius >= 0 && std::isfinite(radius), "MeasurementScene: the radius of a link is ", radius);
  if (!c.tracker) return;
  demand(detail::all_finite(c.tracker->position), "MeasurementScene: the tracker's position is not finite");
  demand(c.tracker->reflector_direction.norm() > 0, "MeasurementScene: the reflector has no direction");
  demand(c.tracker->acceptance > 0, "MeasurementScene: acceptance is ", c.tracker->acceptance, ", must be positive");
  demand(c.tracker->min_range < c.tracker->max_range, "MeasurementScene: the tracker's range is empty");
}

VERNIER_IMPL Rejection MeasurementScene::rejection(const ConstVectorRef& q) const {
  const MeasurementConstraints& c = constraints_;
  const Index joints = arm_.joints();
  demand(q.size() == joints, "MeasurementScene: ", q.size(), " joint values for an arm of ", joints);
  const MatrixX shown = c.controller.to_controller(q.transpose());
  for (Index j = 0; j < shown.cols(); ++j)
    if ((c.lower.size() > 0 && shown(0, j) < c.lower(j) + c.joint_margin) ||
        (c.upper.size() > 0 && shown(0, j) > c.upper(j) - c.joint_margin))
      return Rejection::joint_limits;
  const Isometry3 pose = arm_.poses(VERNIER_LATER(q).transpose()).front();
  const Vector3 tool = translation(pose);
  for (Index k = 0; c.tool_box && k < 3; ++k)
    if (tool(k) < c.tool_box->lower(k) || tool(k) > c.tool_box->upper(k)) return Rejection::tool_box;
  std::vector<Vector3> points;  // the base, origins of the link frames, the tool
  if (!c.link_radii.empty()) {
    const VectorX values = q;
    MatrixX axes(3, joints), on_axes(3, joints), origins(3, joints);
    detail::chain_links(arm_.chain().view(), values.data(), axes.data(), on_axes.data(), origins.data());
    const Isometry3& base = arm_.base().isometry();
    points.push_back(translation(base));
    for (Index i = 0; i < joints; ++i)
      points.push_back(transformed(base, {origins(0, i), origins(1, i), origins(2, i)}));
    points.push_back(tool);
  }
  if (c.tracker) {
    const Rejection seen = check_sight(tool, VERNIER_LATER(rotation(pose)) * c.tracker->reflector_direction, points);
    if (seen != Rejection::none) return seen;
  }
  return collides(points) ? Rejection::self_collision : Rejection::none;
}

VERNIER_IMPL Rejection MeasurementScene::check_sight(const Vector3& tool, const Vector3& looks,
                                                     const std::vector<Vector3>& points) const {
  const Tracker& tracker = *constraints_.tracker;
  const Vector3 beam = tracker.position - tool;
  const double range = beam.norm();
  if (!(range >= tracker.min_range && range <= tracker.max_range)) return Rejection::range;
  if (tracker.acceptance < std::numbers::pi &&
      std::atan2(looks.cross(beam).norm(), looks.dot(beam)) > tracker.acceptance)
    return Rejection::acceptance;
  double along = points.empty() ? 0 : (points.back() - points[points.size() - 2]).norm();
  for (std::size_t i = constraints_.link_radii.size(); i-- > 0;) {
    const double clearance = constraints_.link_radii[i] + tracker.beam_radius;
    // the links that carry the reflector are beside it anyway
    if (along > clearance && segment_distance(tool, tracker.position, points[i], points[i + 1]) < clearance)
      return Rejection::line_of_sight;
    along += (points[i + 1] - points[i]).norm();
  }
  return Rejection::none;
}

VERNIER_IMPL bool MeasurementScene::collides(const std::vector<Vector3>& points) const {
  const std::vector<double>& radii = constraints_.link_radii;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    double between = 0;  // length of the links between two; nearer ones always overlap
    for (std::size_t j = i + 2; j < radii.size(); ++j) {
      between += (points[j] - points[j - 1]).norm();
      const double clearance = radii[i] + radii[j];
      if (between > clearance && segment_distance(points[i], points[i + 1], points[j], points[j + 1]) < clearance)
        return true;
    }
  }
  return false;
}

}  // namespace vernier
