// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/core/sha256.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::sha256_test {
namespace {

// The examples that NIST publishes beside the standard.
TEST(Sha256, EqualsThePublishedExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(
      sha256("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqr"
             "stnopqrstu"),
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Every length up to three blocks, where padding may need one more block; all 256 values of a byte.
TEST(Sha256, EqualsThatOfSha256sum) {
  if (std::system("sha256sum --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "sha256sum is not there";
  const vernier_test::TemporaryFolder folder("sha256");
  Rng rng(1);
  std::string expected, names;
  for (int n = 0; n <= 192; ++n) {
    std::string bytes;
    for (int i = 0; i < n; ++i) bytes += static_cast<char>(static_cast<int>(256 * rng.uniform()));
    write_file(folder / std::to_string(n), bytes);
    expected += sha256(bytes) + "  " + std::to_string(n) + "\n";
    names += " " + std::to_string(n);
  }
  const auto sums = vernier_test::run_command("cd '" + folder.path().string() + "'; sha256sum" + names, folder.path());
  EXPECT_EQ(sums.exit_code, 0) << sums.errors;
  EXPECT_EQ(sums.output, expected);
}

}  // namespace
}  // namespace vernier::sha256_test
