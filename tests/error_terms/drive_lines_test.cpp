// SPDX-License-Identifier: BSD-3-Clause
// The orders at which stated gears and encoders err, and what an order is called.

#include "vernier/error_terms/drive_lines.hpp"

#include <gtest/gtest.h>

#include <string>

namespace vernier::drive_lines_test {
namespace {

TEST(DriveLines, FollowFromGearAndEncoder) {
  EXPECT_TRUE(lines_of({}).empty());
  const HarmonicSpectrum encoder = lines_of({.encoder_periods = 128});
  EXPECT_EQ(encoder, (HarmonicSpectrum{{126, 130, 10e-6}, {254, 258, 6e-6}}));
  const HarmonicSpectrum gear = lines_of({.gear_ratio = 101});
  for (const int order : {202, 400, 404, 408, 505, 808, 1010, 1212, 2020, 2424})
    EXPECT_GT(expected_std(gear, order), 0) << order;
  for (const int order : {101, 300, 399, 409, 1000, 2525}) EXPECT_EQ(expected_std(gear, order), 0) << order;
  const HarmonicSpectrum coarse = lines_of({.gear_ratio = 33.5});
  EXPECT_GT(expected_std(coarse, 268), 0);  // 8 a turn; lower ones are in the general spectrum
  EXPECT_EQ(expected_std(coarse, 134), 0);
}

TEST(DriveLines, CausesAreNamed) {
  const JointDrive drive{.gear_ratio = 101, .encoder_periods = 512};
  EXPECT_EQ(cause_of(404, drive), "4 a turn of a 101:1 gear");
  EXPECT_EQ(cause_of(405, drive), "4 a turn of a 101:1 gear");
  EXPECT_EQ(cause_of(512, drive), "the period of an encoder of 512 periods a turn");
  EXPECT_EQ(cause_of(1024, drive), "half the period of an encoder of 512 periods a turn");
  EXPECT_EQ(cause_of(128, drive), "");
  EXPECT_EQ(cause_of(128), "probably the period of an encoder of 128 periods a turn");
  EXPECT_EQ(cause_of(404), "probably 4 a turn of a 101:1 gear");
  EXPECT_EQ(cause_of(404, {.gear_ratio = 50}), "");
  EXPECT_EQ(cause_of(1), "once a turn: an eccentric encoder or gear");
}

TEST(DriveLines, EveryPeriodOfTheInputIsNamed) {
  const JointDrive drive{.gear_ratio = 50.25, .encoder_periods = 4000};
  for (const int periods : {1, 2, 4, 5, 8, 10, 12, 20, 24})
    EXPECT_EQ(cause_of(static_cast<int>(periods * 50.25), drive),
              std::to_string(periods) + " a turn of a 50.25:1 gear");
  for (const int periods : {3, 6, 7, 9, 11}) EXPECT_EQ(cause_of(static_cast<int>(periods * 50.25), drive), "");
  EXPECT_EQ(cause_of(2), "twice a turn: an oval encoder or gear");
}

TEST(DriveLines, OrdersNearALineHaveItsCause) {
  // one and a half beside a gear's, one beside an encoder's
  const JointDrive drive{.gear_ratio = 33.5, .encoder_periods = 512};
  for (const int order : {32, 33, 34, 35}) EXPECT_EQ(cause_of(order, drive), "1 a turn of a 33.5:1 gear") << order;
  for (const int order : {31, 36, 510, 514, 1022, 1026}) EXPECT_EQ(cause_of(order, drive), "") << order;
  for (const int order : {511, 512, 513})
    EXPECT_EQ(cause_of(order, drive), "the period of an encoder of 512 periods a turn") << order;
  for (const int order : {1023, 1025})
    EXPECT_EQ(cause_of(order, drive), "half the period of an encoder of 512 periods a turn") << order;
}

// A resolver of one pole pair, a motor without gear; the constant is the joint's zero, which no drive causes.
TEST(DriveLines, TheCoarsestDrivesHaveCauses) {
  EXPECT_EQ(cause_of(3, {.encoder_periods = 1}), "half the period of an encoder of 1 periods a turn");
  EXPECT_EQ(cause_of(5, {.gear_ratio = 1}), "4 a turn of a 1:1 gear");
  EXPECT_EQ(cause_of(6, {.gear_ratio = 0.5}), "10 a turn of a 0.5:1 gear");
  EXPECT_EQ(cause_of(0), "");
}

TEST(DriveLines, AreAtTheNearestOrder) {
  EXPECT_EQ(lines_of({.gear_ratio = 50.2}),  // 200.8, 251, 401.6, 502, 602.4, 1004, 1204.8
            (HarmonicSpectrum{{197, 205, 12e-6},
                              {250, 252, 7e-6},
                              {401, 403, 7e-6},
                              {501, 503, 7e-6},
                              {601, 603, 7e-6},
                              {1003, 1005, 7e-6},
                              {1204, 1206, 7e-6}}));
}

TEST(DriveLines, AreFromAbove140To2500) {
  EXPECT_EQ(lines_of({.gear_ratio = 14}),  // 8 a turn are 112, 10 are 140
            (HarmonicSpectrum{{167, 169, 7e-6}, {279, 281, 7e-6}, {335, 337, 7e-6}}));
  EXPECT_EQ(lines_of({.gear_ratio = 625}), (HarmonicSpectrum{{1249, 1251, 7e-6}, {2496, 2504, 12e-6}}));
  EXPECT_EQ(lines_of({.gear_ratio = 70.5}).front(), (HarmonicBand{140, 142, 7e-6}));   // 2 a turn are 141
  EXPECT_EQ(lines_of({.gear_ratio = 625.2}), (HarmonicSpectrum{{1249, 1251, 7e-6}}));  // 4 a turn are 2501
  EXPECT_EQ(lines_of({.encoder_periods = 1}), (HarmonicSpectrum{{1, 3, 10e-6}, {1, 4, 6e-6}}));
}

}  // namespace
}  // namespace vernier::drive_lines_test
