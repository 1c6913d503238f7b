// SPDX-License-Identifier: BSD-3-Clause
// Messages carry the numbers, exactly.

#include "vernier/core/check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "complaint.hpp"
#include "vernier/core/box.hpp"

namespace vn = vernier;

namespace check_test {
namespace {

using vernier_test::complaint;

TEST(Message, JoinsNumbersInTheirShortestExactForm) {
  EXPECT_EQ(vn::message("a ", 1, " b ", -2L, " c ", 3u), "a 1 b -2 c 3");
  EXPECT_EQ(vn::message(0.1, ' ', 1e-9, ' ', 0.30000000000000004, ' ', -2.0), "0.1 1e-09 0.30000000000000004 -2");
  EXPECT_EQ(vn::message(std::numeric_limits<double>::infinity(), " ", std::nan("")), "inf nan");
  EXPECT_EQ(vn::message(true, '/', false), "true/false");
  EXPECT_EQ(vn::message(std::string("text"), std::string_view(" and "), "more", 'x'), "text and morex");
  EXPECT_EQ(vn::message(std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
  EXPECT_EQ(vn::message(0.1F), "0.1");
  EXPECT_EQ(vn::message(), "");
  EXPECT_EQ(std::stod(vn::message(1.0 / 3)), 1.0 / 3);
}

TEST(Message, CountsInSingularAndPlural) {
  EXPECT_EQ(vn::counted(0, "pose", "poses"), "0 poses");
  EXPECT_EQ(vn::counted(1, "touch", "touches"), "1 touch");
  EXPECT_EQ(vn::counted(21, "pose lies", "poses lie"), "21 poses lie");
}

TEST(Require, ThrowsTheMessageWhenTheConditionFails) {
  EXPECT_NO_THROW(vn::demand(true, "never seen"));
  try {
    vn::demand(false, "Elm: hidden_nodes is ", 0, ", must be at least ", 1);
    FAIL() << "did not throw";
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "Elm: hidden_nodes is 0, must be at least 1");
  }
}

TEST(Box, ChecksItsBoundsAndNamesThem) {
  const vn::Box box = vn::Box::cube(3, -1, 2);
  EXPECT_EQ(box.dimension(), 3);
  EXPECT_NO_THROW(box.validate());
  EXPECT_TRUE(box.contains(Eigen::Vector3d(-1, 2, 0)));
  EXPECT_FALSE(box.contains(Eigen::Vector3d(-1, 2.0000001, 0)));
  EXPECT_FALSE(box.contains(Eigen::Vector3d(0, 0, std::nan(""))));
  EXPECT_FALSE(box.contains(Eigen::Vector2d(0, 0)));
  for (int i = 0; i < 3; ++i) {  // each bound of each dimension
    Eigen::Vector3d below(0, 0, 0), above(0, 0, 0);
    below(i) = -1.0000001;
    above(i) = 2.0000001;
    EXPECT_FALSE(box.contains(below)) << i;
    EXPECT_FALSE(box.contains(above)) << i;
  }

  EXPECT_EQ(complaint([] { (void)vn::Box::cube(0, -1, 1); }), "Box::cube: dimension is 0, must be at least 1");
  EXPECT_EQ(complaint([] { (void)vn::Box::cube(2, 1, 1); }), "Box::cube: lower bound 1 is not below upper bound 1");
  vn::Box bad = box;
  bad.lower(1) = 5;
  EXPECT_EQ(complaint([&] { bad.validate(); }),
            "Box: dimension 1 has bounds [5, 2], must be finite and lower below upper");
  bad.upper.resize(2);
  EXPECT_EQ(complaint([&] { bad.validate(); }), "Box: 3 lower and 2 upper bounds");
  EXPECT_EQ(complaint([] { vn::Box{}.validate(); }), "Box: 0 lower and 0 upper bounds");
}

TEST(Box, MayHaveOneDimensionButNotAnEmptyOrAnEndlessOne) {
  const vn::Box line = vn::Box::cube(1, -0.25, 0.25);
  EXPECT_EQ(line.dimension(), 1);
  EXPECT_NO_THROW(line.validate());
  // the width counts, not the bounds: a search computes with it
  for (const auto& [lower, upper] :
       {std::pair{1.0, 1.0}, std::pair{2.0, 1.0}, std::pair{-6e299, 6e299}, std::pair{0.0, 1.2e300},
        std::pair{std::nan(""), 1.0}, std::pair{0.0, std::nan("")},
        std::pair{0.0, std::numeric_limits<double>::infinity()}}) {
    vn::Box bad = line;
    bad.lower(0) = lower;
    bad.upper(0) = upper;
    EXPECT_EQ(complaint([&] { bad.validate(); }), vn::message("Box: dimension 0 has bounds [", lower, ", ", upper,
                                                              "], must be finite and lower below upper"));
  }
  vn::Box far = line;  // far away, but of finite width
  far.lower(0) = 8e299;
  far.upper(0) = 9e299;
  EXPECT_NO_THROW(far.validate());
}

}  // namespace
}  // namespace check_test
