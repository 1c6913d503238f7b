// The orders at which stated gears and encoders err, and what an order is called.

#include "vernier/error_terms/drive_lines.hpp"

#include <gtest/gtest.h>

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
  EXPECT_EQ(cause_of(128), "as of the period of an encoder of 128 periods a turn");
  EXPECT_EQ(cause_of(404), "as of 4 a turn of a 101:1 gear");
  EXPECT_EQ(cause_of(404, {.gear_ratio = 50}), "");
  EXPECT_EQ(cause_of(1), "once a turn, as of an eccentric encoder or gear");
}

}  // namespace
}  // namespace vernier::drive_lines_test
