// SPDX-License-Identifier: BSD-3-Clause

#include "vernier/measurements/row_fingerprints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "complaint.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::row_fingerprints_test {
namespace {

/// Rows as a file has them, with a number of decimals: joints [deg], positions [mm].
struct Rows {
  Rows(Index n, int decimals, std::uint64_t seed) : degrees(n, 6), millimetres(n, 3) {
    Rng rng(seed);
    const double step = std::pow(10.0, -decimals);
    const auto drawn = [&](double most) { return step * std::round(rng.uniform(-most, most) / step); };
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < 6; ++j) degrees(i, j) = drawn(180);
      for (Index k = 0; k < 3; ++k) millimetres(i, k) = drawn(2000);
    }
  }
  MatrixX joints() const { return degrees * (std::numbers::pi / 180); }
  MatrixX positions() const { return millimetres * 1e-3; }

  MatrixX degrees, millimetres;
};

TEST(RowFingerprints, RecogniseRowsInAnyOrderAndUnit) {
  for (const int decimals : {1, 3, 4, 5, 6}) {
    const Rows rows(2000, decimals, 7);
    const RowFingerprints known(rows.joints(), rows.positions());
    EXPECT_TRUE(known.others(rows.joints(), rows.positions()).empty());
    EXPECT_TRUE(known.others(rows.joints().colwise().reverse(), rows.positions().colwise().reverse()).empty());
    EXPECT_TRUE(known.others(rows.joints().middleRows(30, 50), rows.positions().middleRows(30, 50)).empty());
    // the same values by other arithmetic, as from a file in other units
    const MatrixX turned = (rows.degrees / 180) * std::numbers::pi, metres = rows.millimetres / 1000;
    EXPECT_FALSE(turned.isApprox(rows.joints(), 0));
    EXPECT_TRUE(known.others(turned, metres).empty()) << decimals;
  }
}

TEST(RowFingerprints, TellFreshMeasurementsOfTheSameConfigurations) {
  const Rows rows(2000, 4, 7);
  const RowFingerprints known(rows.joints(), rows.positions());
  Rng rng(9);
  MatrixX again = rows.positions();
  for (Index i = 0; i < again.rows(); ++i)
    for (Index k = 0; k < 3; ++k) again(i, k) += 5e-6 * rng.normal();  // a tracker at its best
  EXPECT_GE(known.others(rows.joints(), again).size(), 1995u);
  const Rows elsewhere(2000, 4, 8);
  EXPECT_EQ(known.others(elsewhere.joints(), elsewhere.positions()).size(), 2000u);
}

TEST(RowFingerprints, AddUpAndAreKept) {
  const Rows first(20, 4, 1), second(30, 4, 2);
  RowFingerprints known(first.joints(), first.positions());
  EXPECT_EQ(known.others(second.joints(), second.positions()).size(), 30u);
  known.add({second.joints(), second.positions()});
  EXPECT_TRUE(known.others(second.joints(), second.positions()).empty());
  EXPECT_EQ(known.values().size(), 50u);
  EXPECT_EQ(RowFingerprints(known.values()), known);
  EXPECT_EQ(RowFingerprints(std::vector<std::uint32_t>(known.values().rbegin(), known.values().rend())), known);
  EXPECT_TRUE(RowFingerprints().empty());
}

TEST(RowFingerprints, NeedAPositionARow) {
  EXPECT_EQ(
      vernier_test::complaint([] { static_cast<void>(RowFingerprints(MatrixX::Zero(2, 6), MatrixX::Zero(3, 3))); }),
      "RowFingerprints: 2 rows of joints and 3 positions");
}

}  // namespace
}  // namespace vernier::row_fingerprints_test
