// SPDX-License-Identifier: BSD-3-Clause
#include "console.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace support {

namespace {

bool quiet = false;

bool shows_colours(int stream) {
  const char* const none = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return isatty(stream) == 1 && (none == nullptr || *none == '\0') && terminal != nullptr &&
         std::string(terminal) != "dumb";
}

}  // namespace

void be_quiet() {
  std::fflush(stdout);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) throw std::runtime_error("--quiet: there is no /dev/null");
  close(nowhere);
  quiet = true;
}

bool is_quiet() { return quiet; }

std::string styled(const std::string& text, Look look, int stream) {
  if (!shows_colours(stream)) return text;
  const char* const code = look == Look::strong ? "1" : look == Look::good ? "1;32" : "1;31";
  return "\x1b[" + std::string(code) + "m" + text + "\x1b[0m";
}

}  // namespace support
