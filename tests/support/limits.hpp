// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Options at the limits of what is taken.

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "complaint.hpp"

namespace vernier_test {

/// The next number above x.
inline double above(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
/// The next number below x.
inline double below(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }

/// Values of an option that are just inside its limits are taken, those just outside are refused.
/// @param use    a call with the options, which throws std::invalid_argument where it refuses them
/// @param valid  the other options
template <class Use, class Options, class Value>
void expect_limits(Use&& use, const Options& valid, Value Options::*option, std::initializer_list<Value> inside,
                   std::initializer_list<Value> outside) {
  for (const auto& values : {inside, outside})
    for (const Value value : values) {
      Options options = valid;
      options.*option = value;
      const std::string said = complaint([&] { use(options); });
      EXPECT_EQ(said.empty(), values.begin() == inside.begin()) << testing::PrintToString(value) << ": " << said;
    }
}

}  // namespace vernier_test
