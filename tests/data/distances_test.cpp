// SPDX-License-Identifier: BSD-3-Clause
// Measured distances: what is refused, and rows of them.

#include "vernier/data/distances.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "complaint.hpp"

namespace distances_test {
namespace {

using namespace vernier;
using vernier_test::complaint;

JointRows<2> joints_of_three() {
  JointRows<2> out(3, 2);
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 2; ++j) out(i, j) = static_cast<double>(10 * i + j);
  return out;
}

VectorX lengths_of_three() {
  VectorX out(3);
  out(0) = 0.5;
  out(1) = 0.75;
  out(2) = 1.25;
  return out;
}

TEST(Distances, EachRowIsChecked) {
  for (Index i = 0; i < 3; ++i) {
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      VectorX lengths = lengths_of_three();
      lengths(i) = value;
      EXPECT_EQ(complaint([&] { Distances<2>(joints_of_three(), lengths); }),
                message("Distances: row ", i, " has a value that is not finite"));
      JointRows<2> joints = joints_of_three();
      joints(i, 1) = value;
      EXPECT_EQ(complaint([&] { Distances<2>(joints, lengths_of_three()); }),
                message("Distances: row ", i, " has a value that is not finite"));
    }
    VectorX lengths = lengths_of_three();
    lengths(i) = 0;
    EXPECT_EQ(complaint([&] { Distances<2>(joints_of_three(), lengths); }),
              message("Distances: row ", i, " has a distance of 0 m, must be positive"));
  }
  EXPECT_EQ(complaint([] { Distances<2>(joints_of_three(), VectorX::Ones(2)); }),
            "Distances: 3 rows of joints, but 2 distances");
}

TEST(Distances, RowsInTheGivenOrder) {
  const Distances<2> all(joints_of_three(), lengths_of_three());
  const std::array<Index, 3> order{2, 0, 2};
  const Distances<2> some = all.rows(order);
  ASSERT_EQ(some.size(), 3);
  for (Index k = 0; k < 3; ++k) {
    const Index i = order[static_cast<std::size_t>(k)];
    EXPECT_EQ(some.length(k), all.length(i));
    EXPECT_EQ(some.joints(k), all.joints(i));
  }
  for (const Index outside : {-1, 3})
    EXPECT_EQ(complaint([&] { (void)all.rows(std::array<Index, 1>{outside}); }),
              message("rows: row ", outside, " of 3"));
  EXPECT_EQ(Distances<2>().size(), 0);
}

}  // namespace
}  // namespace distances_test
