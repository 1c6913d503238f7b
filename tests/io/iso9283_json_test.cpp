// SPDX-License-Identifier: BSD-3-Clause
// Results by ISO 9283 as JSON: every number under its name, in its unit.

#include "vernier/io/iso9283_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "json_parts.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::iso9283_json_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::expect_parts;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Each value is another number of micrometres or microradians, so that no two can be exchanged.
TEST(Iso9283Json, PosesDistanceVariationsAndDrift) {
  Iso9283 result;
  Iso9283Pose pose;
  pose.pose = 4;
  pose.direction = 2;
  pose.n = 30;
  pose.ap = 1e-6;
  pose.ap_debiased = 2e-6;
  pose.ap_registered = unknown;
  pose.rp = 3e-6;
  pose.rp_low = 4e-6;
  pose.rp_high = 5e-6;
  pose.ap_xyz = Vector3(6e-6, 7e-6, 8e-6);
  pose.rp_xyz = Vector3(9e-6, 10e-6, 11e-6);
  pose.ap_abc = Vector3(12e-6, 13e-6, 14e-6);
  pose.rp_abc = Vector3(15e-6, unknown, 17e-6);
  result.poses = {pose, pose};
  result.poses[1].ap_registered = 18e-6;
  Iso9283Distance distance;
  distance.first = 3;
  distance.second = 5;
  distance.n = 29;
  distance.ad = -19e-6;
  distance.rd = 20e-6;
  distance.ad_xyz = Vector3(21e-6, 22e-6, 23e-6);
  distance.rd_xyz = Vector3(24e-6, 25e-6, 26e-6);
  distance.ad_abc = Vector3(27e-6, 28e-6, 29e-6);
  distance.rd_abc = Vector3(30e-6, 31e-6, 32e-6);
  result.distance = distance;
  result.variations = {{1, 3, 33e-6, Vector3(34e-6, 35e-6, 36e-6)}};
  result.drift = {{2, {{37, 38e-6, 39e-6}, {unknown, 40e-6, unknown}}, 41e-6, 42e-6}};
  result.registration = rigid_motion(exp_so3(Vector3(0, 0, 0.25)), Vector3(1, -2, 3));
  result.departures = {"ten cycles"};

  expect_parts(to_json(result), R"({
    "poses": [
      {"pose": 4, "direction": 2, "visits": 30, "ap_mm": 1e-3, "ap_debiased_mm": 2e-3, "ap_registered_mm": null,
       "rp_mm": 3e-3, "rp_interval_95_mm": [4e-3, 5e-3], "ap_xyz_mm": [6e-3, 7e-3, 8e-3],
       "rp_xyz_mm": [9e-3, 10e-3, 11e-3], "ap_abc_mrad": [12e-3, 13e-3, 14e-3], "rp_abc_mrad": [15e-3, null, 17e-3]},
      {"ap_registered_mm": 18e-3}],
    "distance": {"poses": [3, 5], "cycles": 29, "ad_mm": -19e-3, "rd_mm": 20e-3,
                 "ad_xyz_mm": [21e-3, 22e-3, 23e-3], "rd_xyz_mm": [24e-3, 25e-3, 26e-3],
                 "ad_abc_mrad": [27e-3, 28e-3, 29e-3], "rd_abc_mrad": [30e-3, 31e-3, 32e-3]},
    "variations": [{"pose": 1, "directions": 3, "vap_mm": 33e-3, "vap_abc_mrad": [34e-3, 35e-3, 36e-3]}],
    "drift": [{"pose": 2, "dap_mm": 41e-3, "drp_mm": 42e-3,
               "groups": [{"time_s": 37, "ap_mm": 38e-3, "rp_mm": 39e-3}, {"time_s": null, "rp_mm": null}]}],
    "registration_m_rad": [1, -2, 3, 0, 0, 0.25],
    "departures": ["ten cycles"]})");
}

TEST(Iso9283Json, WhatThereIsNotIsNullOrEmpty) {
  const Json json = to_json(Iso9283{});
  EXPECT_TRUE(json.at("distance").is_null());
  EXPECT_TRUE(json.at("registration_m_rad").is_null());
  for (const char* list : {"poses", "variations", "drift", "departures"})
    EXPECT_TRUE(json.at(list).is_array() && json.at(list).empty()) << list;
}

TEST(Iso9283Json, Paths) {
  Iso9283Path result;
  result.at = 1e-6;
  result.rt = 2e-6;
  result.at_abc = Vector3(3e-6, 4e-6, 5e-6);
  result.rt_abc = Vector3(6e-6, 7e-6, 8e-6);
  result.length = 0.9;
  result.runs = 10;
  Iso9283PathPoint point;
  point.arc_length = 0.25;
  point.at = 11e-6;
  point.rt = unknown;
  point.at_abc = Vector3(12e-6, 13e-6, 14e-6);
  point.rt_abc = Vector3(15e-6, 16e-6, 17e-6);
  result.points = {point};
  result.departures = {"one run"};

  expect_parts(to_json(result), R"({
    "at_mm": 1e-3, "rt_mm": 2e-3, "at_abc_mrad": [3e-3, 4e-3, 5e-3], "rt_abc_mrad": [6e-3, 7e-3, 8e-3],
    "length_mm": 900, "runs": 10,
    "points": [{"arc_length_mm": 250, "at_mm": 11e-3, "rt_mm": null, "at_abc_mrad": [12e-3, 13e-3, 14e-3],
                "rt_abc_mrad": [15e-3, 16e-3, 17e-3]}],
    "departures": ["one run"]})");
}

}  // namespace
}  // namespace vernier::iso9283_json_test
