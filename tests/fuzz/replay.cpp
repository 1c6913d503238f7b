// Every seed of a fuzz target once, without libFuzzer: `<reader>_replay FOLDER`. What is called valid* must be
// accepted, so that fuzzing starts from files that readers do take.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "reader_fuzz.hpp"
#include "vernier/core/atomic_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::filesystem::path folder;

TEST(Seeds, AreTakenOrRefusedInOneLine) {
  std::vector<std::filesystem::path> seeds;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) seeds.push_back(entry.path());
  std::sort(seeds.begin(), seeds.end());
  bool valid_ones = false;
  for (const auto& seed : seeds) {
    SCOPED_TRACE(seed.string());
    const std::string content = vernier::read_file(seed.string());
    const std::vector<std::uint8_t> bytes(content.begin(), content.end());
    vernier::fuzz::complaint.clear();
    EXPECT_EQ(LLVMFuzzerTestOneInput(bytes.data(), bytes.size()), 0);
    const bool valid = seed.filename().string().starts_with("valid");
    valid_ones = valid_ones || valid;
    if (valid) {
      EXPECT_EQ(vernier::fuzz::complaint, "");
    }
  }
  EXPECT_TRUE(valid_ones) << "a folder of seeds needs one called valid...";
}

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (argc != 2) return 2;
  folder = argv[1];
  return RUN_ALL_TESTS();
}
