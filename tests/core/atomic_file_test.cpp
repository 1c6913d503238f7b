// Files are whole or not there, and a failure leaves what was there before.

#include "vernier/core/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>

namespace vn = vernier;
namespace fs = std::filesystem;

namespace atomic_file_test {
namespace {

/// A folder of its own for each test.
class AtomicFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("vernier_atomic_file_" + std::to_string(::getpid()) + "_" +
                                          ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directory(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  /// Everything in the folder, by name.
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path().filename().string());
    return out;
  }

  fs::path folder;
};

/// What a call throws says.
template <class Exception, class F>
std::string thrown(F&& f) {
  try {
    f();
  } catch (const Exception& e) {
    return e.what();
  }
  return "nothing thrown";
}

TEST_F(AtomicFile, WritesAndReadsEveryByte) {
  const fs::path path = folder / "model.json";
  std::string content;
  for (int i = 0; i < 100'000; ++i) content += static_cast<char>(i * 7 % 256);  // zeros, newlines and all
  vn::write_file(path, content);
  EXPECT_EQ(vn::read_file(path), content);
  EXPECT_EQ(fs::file_size(path), content.size());
  vn::write_file(path, "short");
  EXPECT_EQ(vn::read_file(path), "short");
  vn::write_file(path, "");
  EXPECT_EQ(vn::read_file(path), "");
  EXPECT_EQ(names(), std::vector<std::string>{"model.json"}) << "nothing else is left behind";
}

// Also where the content is so short that it is written when the file is closed.
TEST_F(AtomicFile, AFullDiskLeavesTheOldContent) {
  const fs::path path = folder / "model.json";
  vn::write_file(path, "old content");
  for (const std::size_t size : {1'000'000u, 1'500u}) {
    // The system refuses files beyond this size: what a full disk looks like to the writer.
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = before;
    small.rlim_cur = size > 2'000 ? 64 * 1024 : 1024;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string message = thrown<std::runtime_error>([&] { vn::write_file(path, std::string(size, 'x')); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);

    EXPECT_EQ(message, path.string() + ": could not be written whole: File too large");
    EXPECT_EQ(vn::read_file(path), "old content");
    EXPECT_EQ(names(), std::vector<std::string>{"model.json"});
  }
}

TEST_F(AtomicFile, AMissingFolderIsNamed) {
  const fs::path path = folder / "missing" / "model.json";
  const std::string message = thrown<std::runtime_error>([&] { vn::write_file(path, "x"); });
  EXPECT_NE(message.find(path.string()), std::string::npos) << message;
  EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
  EXPECT_TRUE(names().empty());
}

TEST_F(AtomicFile, AFolderInTheWayStays) {
  const fs::path path = folder / "taken";
  fs::create_directory(path);
  vn::write_file(path / "inside", "kept");
  const std::string message = thrown<std::runtime_error>([&] { vn::write_file(path, "x"); });
  EXPECT_NE(message.find("cannot be replaced"), std::string::npos) << message;
  EXPECT_EQ(vn::read_file(path / "inside"), "kept");
  EXPECT_EQ(names(), std::vector<std::string>{"taken"});
}

TEST_F(AtomicFile, AReaderSeesTheOldOrTheNewNeverAMixture) {
  const fs::path path = folder / "model.json";
  const std::string a(300'000, 'a'), b(200'000, 'b');
  vn::write_file(path, a);
  std::atomic<bool> done{false};
  std::jthread writer([&] {
    for (int i = 0; i < 100; ++i) vn::write_file(path, i % 2 == 0 ? b : a);
    done = true;
  });
  int reads = 0, wrong = 0;
  do {
    const std::string content = vn::read_file(path);
    ++reads;
    wrong += content != a && content != b;
  } while (!done);
  EXPECT_EQ(wrong, 0) << "of " << reads;
}

TEST_F(AtomicFile, ReadingSaysWhatIsWrong) {
  const fs::path path = folder / "missing.csv";
  EXPECT_EQ(thrown<std::invalid_argument>([&] { (void)vn::read_file(path); }),
            path.string() + ": No such file or directory");
  EXPECT_EQ(thrown<std::invalid_argument>([&] { (void)vn::read_file(folder); }),
            folder.string() + ": is a folder, not a file");
}

// A service reads and writes for months: no file stays open, whether it could be read or not.
TEST_F(AtomicFile, NoFileStaysOpen) {
  const auto open_files = [] {
    std::ptrdiff_t count = 0;
    for (const auto& entry : fs::directory_iterator("/proc/self/fd")) count += entry.path().empty() ? 0 : 1;
    return count;
  };
  if (!fs::exists("/proc/self/fd")) GTEST_SKIP() << "this system does not list open files";
  const fs::path path = folder / "model.json", taken = folder / "taken";
  fs::create_directory(taken);
  const auto before = open_files();
  vn::write_file(path, "content");
  EXPECT_EQ(vn::read_file(path), "content");
  EXPECT_NE(thrown<std::invalid_argument>([&] { (void)vn::read_file(path, 3); }), "nothing thrown");
  EXPECT_NE(thrown<std::invalid_argument>([&] { (void)vn::read_file(taken); }), "nothing thrown");
  EXPECT_NE(thrown<std::runtime_error>([&] { vn::write_file(taken, "x"); }), "nothing thrown");
  EXPECT_EQ(open_files(), before);
}

TEST_F(AtomicFile, ReadingEndsWhereAFileIsTooLarge) {
  constexpr std::size_t most = std::size_t{1} << 20;
  const fs::path path = folder / "large.csv";
  vn::write_file(path, std::string(most, 'a'));
  EXPECT_EQ(vn::read_file(path, most).size(), most);
  vn::write_file(path, std::string(most + 1, 'a'));
  EXPECT_EQ(thrown<std::invalid_argument>([&] { (void)vn::read_file(path, most); }),
            path.string() + ": has more than 1 MiB");
  EXPECT_EQ(thrown<std::invalid_argument>([&] { (void)vn::read_file("/dev/zero", most); }),
            "/dev/zero: has more than 1 MiB");
}

}  // namespace
}  // namespace atomic_file_test
