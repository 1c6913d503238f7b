// SPDX-License-Identifier: BSD-3-Clause
// Every seed of every fuzz target once, without libFuzzer. What is called valid* must be accepted, so that fuzzing
// starts from files that readers do take.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "reader_fuzz.hpp"
#include "vernier/core/atomic_file.hpp"

/// The entry point of a fuzz target.
struct FuzzTarget {
  const char* name;
  int (*run)(const std::uint8_t* data, std::size_t size);

  friend void PrintTo(const FuzzTarget& target, std::ostream* out) { *out << target.name; }
};

#include "fuzz_targets.hpp"

namespace {

class Seeds : public ::testing::TestWithParam<FuzzTarget> {};

TEST_P(Seeds, AreTakenOrRefusedInOneLine) {
  std::vector<std::filesystem::path> seeds;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(VERNIER_FUZZ_CORPUS) / GetParam().name))
    seeds.push_back(entry.path());
  std::sort(seeds.begin(), seeds.end());
  bool valid_ones = false;
  for (const auto& seed : seeds) {
    SCOPED_TRACE(seed.string());
    const std::string content = vernier::read_file(seed.string());
    const std::vector<std::uint8_t> bytes(content.begin(), content.end());
    vernier::fuzz::complaint.clear();
    EXPECT_EQ(GetParam().run(bytes.data(), bytes.size()), 0);
    const bool valid = seed.filename().string().starts_with("valid");
    valid_ones = valid_ones || valid;
    if (valid) {
      EXPECT_EQ(vernier::fuzz::complaint, "");
    }
  }
  EXPECT_TRUE(valid_ones) << "a folder of seeds needs one called valid...";
}

INSTANTIATE_TEST_SUITE_P(Readers, Seeds, ::testing::ValuesIn(fuzz_targets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
