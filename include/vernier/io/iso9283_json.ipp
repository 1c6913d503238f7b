// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "vernier/core/so3.hpp"
#include "vernier/io/iso9283_json.hpp"

namespace vernier {

namespace detail {

/// In thousandths; null where it is not finite.
VERNIER_LOCAL nlohmann::ordered_json milli(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value * 1e3) : nlohmann::ordered_json();
}

VERNIER_LOCAL nlohmann::ordered_json milli_each(const Vector3& values) {
  return {milli(values.x()), milli(values.y()), milli(values.z())};
}

}  // namespace detail

VERNIER_IMPL nlohmann::ordered_json to_json(const Iso9283& result) {
  using Json = nlohmann::ordered_json;
  Json poses = Json::array(), variations = Json::array(), drift = Json::array(), distance, registration;
  for (const Iso9283Pose& one : result.poses)
    poses.push_back({{"pose", one.pose},
                     {"direction", one.direction},
                     {"visits", one.n},
                     {"ap_mm", detail::milli(one.ap)},
                     {"ap_debiased_mm", detail::milli(one.ap_debiased)},
                     {"ap_registered_mm", detail::milli(one.ap_registered)},
                     {"rp_mm", detail::milli(one.rp)},
                     {"rp_interval_95_mm", {detail::milli(one.rp_low), detail::milli(one.rp_high)}},
                     {"ap_xyz_mm", detail::milli_each(one.ap_xyz)},
                     {"rp_xyz_mm", detail::milli_each(one.rp_xyz)},
                     {"ap_abc_mrad", detail::milli_each(one.ap_abc)},
                     {"rp_abc_mrad", detail::milli_each(one.rp_abc)}});
  if (result.distance) {
    const Iso9283Distance& d = *result.distance;
    distance = {{"poses", {d.first, d.second}},
                {"cycles", d.n},
                {"ad_mm", detail::milli(d.ad)},
                {"rd_mm", detail::milli(d.rd)},
                {"ad_xyz_mm", detail::milli_each(d.ad_xyz)},
                {"rd_xyz_mm", detail::milli_each(d.rd_xyz)},
                {"ad_abc_mrad", detail::milli_each(d.ad_abc)},
                {"rd_abc_mrad", detail::milli_each(d.rd_abc)}};
  }
  for (const Iso9283Variation& one : result.variations)
    variations.push_back({{"pose", one.pose},
                          {"directions", one.directions},
                          {"vap_mm", detail::milli(one.vap)},
                          {"vap_abc_mrad", detail::milli_each(one.vap_abc)}});
  for (const Iso9283Drift& one : result.drift) {
    Json groups = Json::array();
    for (const Iso9283Drift::Group& group : one.groups)
      groups.push_back({{"time_s", std::isfinite(group.time_s) ? Json(group.time_s) : Json()},
                        {"ap_mm", detail::milli(group.ap)},
                        {"rp_mm", detail::milli(group.rp)}});
    drift.push_back({{"pose", one.pose},
                     {"dap_mm", detail::milli(one.dap)},
                     {"drp_mm", detail::milli(one.drp)},
                     {"groups", std::move(groups)}});
  }
  if (result.registration) {
    const Vector3 p = result.registration->translation(), r = log_so3(Matrix3(result.registration->linear()));
    registration = {p.x(), p.y(), p.z(), r.x(), r.y(), r.z()};
  }
  return {{"poses", std::move(poses)},
          {"distance", std::move(distance)},
          {"variations", std::move(variations)},
          {"drift", std::move(drift)},
          {"registration_m_rad", std::move(registration)},
          {"departures", result.departures}};
}

VERNIER_IMPL nlohmann::ordered_json to_json(const Iso9283Path& result) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const Iso9283PathPoint& one : result.points)
    points.push_back({{"arc_length_mm", detail::milli(one.arc_length)},
                      {"at_mm", detail::milli(one.at)},
                      {"rt_mm", detail::milli(one.rt)},
                      {"at_abc_mrad", detail::milli_each(one.at_abc)},
                      {"rt_abc_mrad", detail::milli_each(one.rt_abc)}});
  return {{"at_mm", detail::milli(result.at)},
          {"rt_mm", detail::milli(result.rt)},
          {"at_abc_mrad", detail::milli_each(result.at_abc)},
          {"rt_abc_mrad", detail::milli_each(result.rt_abc)},
          {"length_mm", detail::milli(result.length)},
          {"runs", result.runs},
          {"points", std::move(points)},
          {"departures", result.departures}};
}

}  // namespace vernier
