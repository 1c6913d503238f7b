// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/destination.hpp"

namespace vernier {

namespace detail {

/// Writes all of it at the place where the file stands.
/// @return whether it could; else `errno` says why not
VERNIER_LOCAL bool write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const auto written = ::write(file, content.data(), content.size());
    if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
    if (written == 0) errno = ENOSPC;
    if (written == 0 || (written < 0 && errno != EINTR)) return false;
  }
  return true;
}

/// Whether something is mounted at this path alone, so that it cannot be renamed.
VERNIER_LOCAL bool is_mounted(const std::string& path) {
#ifdef STATX_ATTR_MOUNT_ROOT
  struct statx status {};
  return ::statx(AT_FDCWD, path.c_str(), 0, 0, &status) == 0 && (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
#else
  return path.empty();  // renaming fails then, and the file is written in place
#endif
}

/// An output, opened as far as that changes nothing; closed, and the file beside it removed, with it.
class Output {
 public:
  /// @throws std::runtime_error naming the file and the reason why it cannot be written
  VERNIER_LOCAL explicit Output(const std::string& path);
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output() {
    if (file_ >= 0) ::close(file_);
    if (present_ >= 0) ::close(present_);
    if (!beside_.empty()) ::unlink(beside_.c_str());
  }

  Writing writing() const { return writing_; }
  /// @throws std::runtime_error naming the file and the reason
  VERNIER_LOCAL void write(std::string_view content);

 private:
  Output() = default;
  VERNIER_LOCAL [[noreturn]] void fail(const char* what, int reason) const {
    throw std::runtime_error(path_ + ": " + what +
                             (reason != 0 ? std::string(": ") + std::strerror(reason) : std::string()));
  }
  VERNIER_LOCAL void open_stream(int descriptor);
  VERNIER_LOCAL bool open_beside(const struct stat* replaced);
  VERNIER_LOCAL void rewrite(std::string_view content);

  std::string path_;    // as it was named
  std::string target_;  // after all symbolic links
  std::string beside_;  // what becomes the target; empty: none
  Writing writing_ = Writing::replaced;
  int file_ = -1;     // the file beside, or the stream; -1: not open
  int present_ = -1;  // the regular file that is there; -1: none
};

VERNIER_IMPL Output::Output(const std::string& path) : Output() {
  path_ = path;
  struct stat status {};
  const bool there = ::stat(path.c_str(), &status) == 0;
  if (!there && errno != ENOENT) fail("cannot be written", errno);
  const Destination to = destination_of(path);
  target_ = to.file;
  if (there && S_ISDIR(status.st_mode)) fail("is a folder, cannot be written as a file", 0);
  if (to.descriptor >= 0) {
    open_stream(to.descriptor);
    return;
  }
  if (there && (S_ISSOCK(status.st_mode) || S_ISBLK(status.st_mode)))
    fail(S_ISBLK(status.st_mode) ? "is a block device, cannot be written as a file"
                                 : "is a socket, cannot be written as a file",
         0);
  if (there && !S_ISREG(status.st_mode)) {
    writing_ = Writing::through;  // opened when it is written: a pipe waits for its reader
    if (::access(path.c_str(), W_OK) != 0) fail("cannot be written", errno);
    return;
  }
  if (there) {
    present_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (present_ < 0) fail("cannot be written", errno);
  }
  const bool mounted = there && is_mounted(target_);
  if (!mounted && open_beside(there ? &status : nullptr)) return;
  if (!mounted && (!there || (errno != EACCES && errno != EPERM && errno != EROFS))) fail("cannot be written", errno);
  writing_ = Writing::in_place;
}

/// A stream of this process: what was opened before goes on, at its place and in its mode.
VERNIER_IMPL void Output::open_stream(int descriptor) {
  writing_ = Writing::through;
  const int mode = ::fcntl(descriptor, F_GETFL);
  if (mode != -1 && (mode & O_ACCMODE) == O_RDONLY) fail("cannot be written", EBADF);
  if (descriptor == STDOUT_FILENO) std::fflush(stdout);
  file_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (file_ < 0) fail("cannot be written", errno);
}

/// Opens a new file in the folder of the target, with the owner, the group and the mode of the one that it replaces.
/// @return whether that is possible; else `errno` says why not
VERNIER_IMPL bool Output::open_beside(const struct stat* replaced) {
  static std::atomic<unsigned> count{0};
  const std::string folder = target_.substr(0, target_.rfind('/') + 1);  // empty without a slash
  const mode_t mode = replaced != nullptr ? 0600 : 0666;                 // what is private stays so
  do {
    beside_ = message(folder, ".vernier.", ::getpid(), '.', count++, ".partial");
    file_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  } while (file_ < 0 && errno == EEXIST);
  if (file_ < 0) {
    beside_.clear();
    return false;
  }
  if (replaced == nullptr) return true;
  constexpr mode_t permissions = 07777;
  struct stat made {};
  const bool alike = ::fstat(file_, &made) == 0 &&
                     ((made.st_uid == replaced->st_uid && made.st_gid == replaced->st_gid) ||
                      ::fchown(file_, replaced->st_uid, replaced->st_gid) == 0) &&
                     ::fchmod(file_, replaced->st_mode & permissions) == 0 && ::fstat(file_, &made) == 0 &&
                     (made.st_mode & permissions) == (replaced->st_mode & permissions);
  if (alike) return true;
  ::close(file_);
  ::unlink(beside_.c_str());
  file_ = -1;
  beside_.clear();
  errno = EPERM;
  return false;
}

VERNIER_IMPL void Output::write(std::string_view content) {
  if (writing_ == Writing::in_place) return rewrite(content);
  if (file_ < 0) file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (file_ < 0) fail("cannot be written", errno);
  const bool written = write_all(file_, content);
  int reason = errno;
  const bool closed = ::close(file_) == 0;  // some file systems write now
  if (written) reason = errno;
  file_ = -1;
  if (!written || !closed) fail("could not be written whole", reason);
  if (writing_ == Writing::through) return;
  if (::rename(beside_.c_str(), target_.c_str()) == 0) {
    beside_.clear();
    return;
  }
  if (present_ < 0 || (errno != EBUSY && errno != EPERM && errno != EACCES)) fail("cannot be replaced", errno);
  rewrite(content);
}

/// Writes the regular file that is there. What is longer comes first, so that a full disk leaves the old content.
VERNIER_IMPL void Output::rewrite(std::string_view content) {
  struct stat status {};
  if (::fstat(present_, &status) != 0) fail("cannot be written", errno);
  const std::size_t common = (std::min)(content.size(), static_cast<std::size_t>(status.st_size));
  if (::lseek(present_, status.st_size, SEEK_SET) < 0 || !write_all(present_, content.substr(common))) {
    const int reason = errno;
    if (::ftruncate(present_, status.st_size) != 0) fail("has its old content and a part of the new one", reason);
    fail("could not be written whole", reason);
  }
  if (::lseek(present_, 0, SEEK_SET) < 0 || !write_all(present_, content.substr(0, common)) ||
      ::ftruncate(present_, static_cast<off_t>(content.size())) != 0)
    fail("could not be written whole, its old content is lost", errno);
}

}  // namespace detail

VERNIER_IMPL Writing writing_of(const std::string& path) { return detail::Output(path).writing(); }

VERNIER_IMPL void write_file(const std::string& path, std::string_view content) { detail::Output(path).write(content); }

VERNIER_IMPL std::string read_file(const std::string& path, std::size_t most) {
  const auto fail = [&](const char* what) {
    throw std::invalid_argument(path + ": " + (what != nullptr ? what : std::strerror(errno)));
  };
  errno = 0;
  std::FILE* in = std::fopen(path.c_str(), "rb");
  if (in == nullptr) fail(errno != 0 ? nullptr : "cannot be opened");
  std::string content;
  char buffer[1 << 14];
  for (std::size_t n; content.size() <= most && (n = std::fread(buffer, 1, sizeof buffer, in)) > 0;)
    content.append(buffer, n);
  const bool failed = std::ferror(in) != 0, folder = errno == EISDIR;
  std::fclose(in);
  if (failed) fail(folder ? "is a folder, not a file" : "could not be read");
  if (content.size() > most) fail(("has more than " + std::to_string(most >> 20) + " MiB").c_str());
  return content;
}

}  // namespace vernier
