// SPDX-License-Identifier: BSD-3-Clause
// Files are whole or not there, and a failure leaves what was there before.

#include "vernier/core/atomic_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>
#include <utility>

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
  EXPECT_EQ(message, path.string() + ": is a folder, cannot be written as a file");
  EXPECT_EQ(thrown<std::runtime_error>([&] { (void)vn::writing_of(path); }), message);
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

mode_t mode_of(const fs::path& path) {
  struct stat status {};
  EXPECT_EQ(::lstat(path.c_str(), &status), 0) << path;
  return status.st_mode;
}

TEST_F(AtomicFile, LinksAreFollowedAndStay) {
  fs::create_directories(folder / "a");
  fs::create_directories(folder / "b");
  fs::create_symlink("../b/model.json", folder / "a" / "relative");  // leads nowhere as yet
  fs::create_symlink("a/relative", folder / "one");
  fs::create_symlink(folder / "one", folder / "two");
  for (const char* content : {"first", "second"}) {
    EXPECT_EQ(vn::writing_of(folder / "two"), vn::Writing::replaced);
    vn::write_file(folder / "two", content);
    EXPECT_EQ(vn::read_file(folder / "b" / "model.json"), content);
    for (const char* link : {"one", "two", "a/relative"}) EXPECT_TRUE(fs::is_symlink(folder / link)) << link;
  }
  fs::create_symlink("ring", folder / "circle");
  fs::create_symlink("circle", folder / "ring");
  EXPECT_NE(thrown<std::runtime_error>([&] { vn::write_file(folder / "ring", "x"); }).find("symbolic links"),
            std::string::npos);
  EXPECT_TRUE(fs::is_symlink(folder / "ring"));
}

TEST_F(AtomicFile, OwnerAndModeOfTheOldFileStay) {
  const fs::path path = folder / "model.json";
  const auto before = ::umask(027);
  vn::write_file(path, "new");
  ::umask(before);
  EXPECT_EQ(mode_of(path) & 07777u, 0640u) << "of a new file, as of every program";
  for (const mode_t mode : {0600u, 0640u, 0666u, 0755u, 02660u}) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    vn::write_file(path, "newer");
    EXPECT_EQ(mode_of(path) & 07777u, mode);
  }
  if (::geteuid() != 0) return;  // others cannot give files away
  ASSERT_EQ(::chown(path.c_str(), 65534, 65533), 0);
  vn::write_file(path, "newest");
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(std::pair(status.st_uid, status.st_gid), std::pair(uid_t{65534}, gid_t{65533}));
}

TEST_F(AtomicFile, FilesOfTheUserAreNotUsedMeanwhile) {
  vn::write_file(folder / "cmd.csv.partial", "of the user");
  vn::write_file(folder / "cmd.csv", "commands");
  EXPECT_EQ(vn::writing_of(folder / "cmd.csv"), vn::Writing::replaced);
  EXPECT_EQ(vn::read_file(folder / "cmd.csv.partial"), "of the user");
  EXPECT_EQ(names().size(), 2u);
  const std::string longest(255, 'n');  // as long as a name may be
  vn::write_file(folder / longest, "x");
  vn::write_file(folder / longest, "y");
  EXPECT_EQ(vn::read_file(folder / longest), "y");
}

TEST_F(AtomicFile, DevicesAreWrittenThrough) {
  const fs::path sink = folder / "sink", full = folder / "full", link = folder / "link";
  if (::mknod(sink.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0 ||
      ::mknod(full.c_str(), S_IFCHR | 0666, makedev(1, 7)) != 0)
    GTEST_SKIP() << "makes no devices";
  fs::create_symlink("sink", link);
  for (const fs::path& path : {sink, link}) {
    EXPECT_EQ(vn::writing_of(path), vn::Writing::through);
    vn::write_file(path, "x");
  }
  EXPECT_EQ(thrown<std::runtime_error>([&] { vn::write_file(full, "x"); }),
            full.string() + ": could not be written whole: No space left on device");
  EXPECT_TRUE(S_ISCHR(mode_of(sink)) && S_ISCHR(mode_of(full)) && S_ISLNK(mode_of(link)));
  EXPECT_EQ(names().size(), 3u);
}

TEST_F(AtomicFile, PipesAreWrittenThrough) {
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(vn::writing_of(pipe), vn::Writing::through) << "and waits for nobody";
  const std::string content(200'000, 'p');  // more than a pipe holds
  std::string received;
  {
    std::jthread reader([&] { received = vn::read_file(pipe); });
    vn::write_file(pipe, content);
  }
  EXPECT_EQ(received, content);
  EXPECT_TRUE(S_ISFIFO(mode_of(pipe)));
}

TEST_F(AtomicFile, OpenFilesOfTheProcessGoOnWhereTheyAre) {
  const fs::path log = folder / "log", link = folder / "link";
  vn::write_file(log, "before ");
  const int file = ::open(log.c_str(), O_WRONLY | O_APPEND);
  ASSERT_GE(file, 0);
  const std::string named = "/dev/fd/" + std::to_string(file);
  fs::create_symlink(named, link);
  EXPECT_EQ(vn::writing_of(named), vn::Writing::through);
  vn::write_file(named, "one ");
  vn::write_file("/dev/../dev/fd/../fd/" + std::to_string(file), "two ");
  vn::write_file(link, "three");
  EXPECT_EQ(vn::read_file(log), "before one two three");
  fs::remove(log);  // without a name it is open all the same
  vn::write_file(named, "!");
  EXPECT_FALSE(fs::exists(log));
  ::close(file);
  const int other = ::open(folder.c_str(), O_RDONLY);
  EXPECT_NE(thrown<std::runtime_error>([&] { vn::write_file("/dev/fd/" + std::to_string(other), "x"); }),
            "nothing thrown");
  ::close(other);
}

// What root may do, it does; others find folders closed.
TEST_F(AtomicFile, AFileThatCannotBeReplacedIsWrittenInPlace) {
  const fs::path closed = folder / "closed", path = closed / "model.json", kept = folder / "kept";
  fs::create_directory(closed);
  vn::write_file(path, "old content");
  vn::write_file(kept, "write-protected");
  ASSERT_EQ(::chmod(kept.c_str(), 0444), 0);
  ASSERT_EQ(::chmod(folder.c_str(), 0777), 0);
  ASSERT_EQ(::chmod(path.c_str(), 0666), 0);
  ASSERT_EQ(::chmod(closed.c_str(), 0555), 0);
  const bool root = ::geteuid() == 0;
  if (root) {
    ASSERT_EQ(::seteuid(65534), 0);
  }
  const auto writing = vn::writing_of(path);
  const std::string beside = thrown<std::runtime_error>([&] { vn::write_file(closed / "new", "x"); });
  const std::string over = thrown<std::runtime_error>([&] { vn::write_file(kept, "x"); });
  vn::write_file(path, "longer content than before");
  const std::string longer = vn::read_file(path);
  vn::write_file(path, "short");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 1024;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string full = thrown<std::runtime_error>([&] { vn::write_file(path, std::string(5'000, 'x')); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  if (root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  ASSERT_EQ(::chmod(closed.c_str(), 0755), 0);
  EXPECT_EQ(writing, vn::Writing::in_place);
  EXPECT_EQ(beside, (closed / "new").string() + ": cannot be written: Permission denied");
  EXPECT_EQ(over, kept.string() + ": cannot be written: Permission denied");
  EXPECT_EQ(longer, "longer content than before");
  EXPECT_EQ(full, path.string() + ": could not be written whole: File too large");
  EXPECT_EQ(vn::read_file(path), "short") << "a full disk leaves what was there";
  EXPECT_EQ(vn::read_file(kept), "write-protected");
}

TEST_F(AtomicFile, WritersDoNotDisturbEachOther) {
  const fs::path path = folder / "model.json";
  std::atomic<int> failed = 0;
  {
    std::vector<std::jthread> writers;
    for (char c = 'a'; c < 'g'; ++c)
      writers.emplace_back([&, c] {
        for (int i = 0; i < 30; ++i)
          failed +=
              thrown<std::runtime_error>([&] { vn::write_file(path, std::string(50'000, c)); }) != "nothing thrown";
      });
  }
  EXPECT_EQ(failed, 0);
  const std::string content = vn::read_file(path);
  EXPECT_EQ(content, std::string(50'000, content.front()));
  EXPECT_EQ(names(), std::vector<std::string>{"model.json"});
}

}  // namespace
}  // namespace atomic_file_test
