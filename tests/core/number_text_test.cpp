// SPDX-License-Identifier: BSD-3-Clause
// Rounded numbers as text: what printf writes in the C locale, under every locale.

#include "vernier/core/detail/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <locale>

#include "foreign_locale.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::number_text_test {
namespace {

using vernier_test::ForeignLocale;

std::string printed(const char* format, int precision, double value) {
  char text[400];
  std::snprintf(text, sizeof text, format, precision, value);
  return text;
}

TEST(NumberText, IsWhatPrintfWrites) {
  Rng rng(1);
  std::vector<double> values{0,    -0.0, 0.5,   1.5,  2.5,    0.125, 999.5,
                             1e22, 1e-7, 12e-5, 1e-5, 123456, 1e300, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < 300; ++k) values.push_back(rng.uniform(-1, 1) * std::pow(10, rng.uniform(-8, 8)));
  for (const double value : values)
    for (int precision = 0; precision < 7; ++precision) {
      EXPECT_EQ(detail::fixed_digits(value, precision), printed("%.*f", precision, value));
      EXPECT_EQ(detail::signed_digits(value, precision), printed("%+.*f", precision, value));
      EXPECT_EQ(detail::significant_digits(value, precision), printed("%.*g", precision, value));
    }
  EXPECT_EQ(detail::fixed_digits(std::numeric_limits<double>::quiet_NaN(), 2), "nan");
}

TEST(NumberText, BriefNumbersHaveNoExponentFromAThousandOn) {
  EXPECT_EQ(detail::brief(0.012345), "0.0123");
  EXPECT_EQ(detail::brief(999.4), "999");
  EXPECT_EQ(detail::brief(999.6), "1000");
  EXPECT_EQ(detail::brief(-123456.7), "-123457");
  EXPECT_EQ(detail::brief(1e6), "1e+06");
}

TEST(NumberText, ColumnsAreFilledAndNeverCut) {
  EXPECT_EQ(detail::at_right("1.5", 6), "   1.5");
  EXPECT_EQ(detail::at_left("1.5", 6), "1.5   ");
  EXPECT_EQ(detail::at_right("1234567", 6), "1234567");
  EXPECT_EQ(detail::at_left("1234567", 6), "1234567");
}

TEST(NumberText, NoLocaleChangesIt) {
  const ForeignLocale locale;
  EXPECT_EQ(detail::fixed_digits(1234567.891, 2), "1234567.89");
  EXPECT_EQ(detail::signed_digits(1234.5, 1), "+1234.5");
  EXPECT_EQ(detail::significant_digits(0.0012345, 3), "0.00123");
  EXPECT_EQ(message(1234567.5, ' ', 1234567, ' ', 0.25f), "1234567.5 1234567 0.25");
}

}  // namespace
}  // namespace vernier::number_text_test
