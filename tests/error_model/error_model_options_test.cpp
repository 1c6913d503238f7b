// SPDX-License-Identifier: BSD-3-Clause
// Options of a fit that cannot be used are named.

#include "vernier/error_model/error_model_options.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "complaint.hpp"
#include "vernier/core/check.hpp"

namespace vernier::error_model_options_test {
namespace {

template <class Change>
std::string complaint_after(const Change& change) {
  ErrorModelOptions options;
  change(options);
  return vernier_test::complaint([&] { options.validate(); });
}

struct Size {
  const char* name;
  double ErrorModelOptions::*value;
};

TEST(ErrorModelOptions, ExpectedSizesArePositive) {
  for (const Size& size : {Size{"compliance_prior_std", &ErrorModelOptions::compliance_prior_std},
                           {"thermal_prior_std", &ErrorModelOptions::thermal_prior_std},
                           {"gear_ratio_prior_std", &ErrorModelOptions::gear_ratio_prior_std},
                           {"coupling_prior_std", &ErrorModelOptions::coupling_prior_std},
                           {"hysteresis_prior_std", &ErrorModelOptions::hysteresis_prior_std},
                           {"tilt_prior_std", &ErrorModelOptions::tilt_prior_std}})
    for (const double bad : {0.0, -1e-3, std::numeric_limits<double>::infinity(), std::nan("")})
      EXPECT_EQ(complaint_after([&](ErrorModelOptions& o) { o.*size.value = bad; }),
                message("ErrorModelOptions: ", size.name, " is ", bad, ", must be positive"));
}

TEST(ErrorModelOptions, NumbersAndDirectionsHaveBounds) {
  EXPECT_EQ(complaint_after([](ErrorModelOptions&) {}), "");
  for (const int good : {0, 500}) EXPECT_EQ(complaint_after([&](ErrorModelOptions& o) { o.harmonics = good; }), "");
  for (const int bad : {-1, 501})
    EXPECT_EQ(complaint_after([&](ErrorModelOptions& o) { o.harmonics = bad; }),
              message("ErrorModelOptions: harmonics is ", bad, ", must lie in 0..500"));
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.relevant_size = 1e-5; }), "");
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.relevant_size = -1; }),
            "ErrorModelOptions: relevant_size is -1, must be 0 or more");
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.num_validation_poses = 1; }), "");
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.num_validation_poses = 0; }),
            "ErrorModelOptions: num_validation_poses is 0, must be at least 1");
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.down = Vector3(0.6, 0, 0.8); }), "");
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.down = Vector3(0, 0, -9.75); }),
            "ErrorModelOptions: down has length 9.75, must be 1");
  EXPECT_EQ(complaint_after([](ErrorModelOptions& o) { o.down = Vector3(0, 0, 0); }),
            "ErrorModelOptions: down has length 0, must be 1");
}

}  // namespace
}  // namespace vernier::error_model_options_test
