// SPDX-License-Identifier: BSD-3-Clause
// The standard chain of a modified one.
#include "vernier/kinematics/convert.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "larger.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::convert_test {
namespace {

/// Largest difference of any pose entry between random modified chains (prismatic joints and beta included) and their
/// standard forms.
template <int N>
double largest_difference() {
  Rng rng(static_cast<std::uint64_t>(N));
  double largest = 0;
  for (int chain = 0; chain < 20; ++chain) {
    std::array<DhRow, N> rows{};
    for (DhRow& row : rows)
      row = {rng.uniform(-0.5, 0.5), rng.uniform(-3, 3),
             rng.uniform(-0.5, 0.5), rng.uniform(-3, 3),
             rng.uniform(-1, 1),     rng.below(4) == 0 ? JointType::prismatic : JointType::revolute};
    const auto modified = DhChain<N, ModifiedDh>::from_rows(rows);
    const Framed<DhChain<N>> standard = to_standard(modified);
    for (int k = 0; k < 10; ++k) {
      JointVector<N> q;
      for (auto& value : q) value = rng.uniform(-1, 1);
      largest = vernier_test::larger(largest, vernier_test::difference(standard.pose(q), modified.pose(q)));
    }
  }
  return largest;
}

TEST(ToStandard, PosesAreEqual) {
  EXPECT_LT(largest_difference<1>(), 1e-14);
  EXPECT_LT(largest_difference<2>(), 1e-14);
  EXPECT_LT(largest_difference<6>(), 1e-14);
  EXPECT_LT(largest_difference<9>(), 1e-14);
}

TEST(ToStandard, TheLastRowIsFree) {
  constexpr DhChain<2, ModifiedDh> chain{{{{.a = 0.1, .alpha = 0.2}, {.a = 0.3, .alpha = 0.4, .beta = 0.5}}}};
  const auto standard = to_standard(chain);
  EXPECT_EQ(standard.model().row(0), (DhRow{.a = 0.3, .alpha = 0.4, .beta = 0.5}));
  EXPECT_EQ(standard.model().row(1), DhRow{});
  EXPECT_EQ(standard.base().translation(), Vector3(0.1, 0, 0));
}

// The base takes over what the first row does before its joint: Rx(alpha), then a along x and Ry(beta).
TEST(ToStandard, TheFirstRowMovesTheBase) {
  for (const double beta : {0.0, 0.3, 1.0, -1.0}) {
    const DhChain<1, ModifiedDh> chain({{.a = 0.1, .alpha = 0.2, .beta = beta}});
    const auto standard = to_standard(chain);
    const double ca = std::cos(0.2), sa = std::sin(0.2), cb = std::cos(beta), sb = std::sin(beta);
    EXPECT_LE(vernier_test::difference(standard.base(), vernier_test::RealMatrix(4, 4,
                                                                                 {cb, 0, sb, 0.1,            //
                                                                                  sa * sb, ca, -sa * cb, 0,  //
                                                                                  -ca * sb, sa, ca * cb, 0,  //
                                                                                  0, 0, 0, 1})),
              1e-15)
        << beta;
  }
}

}  // namespace
}  // namespace vernier::convert_test
