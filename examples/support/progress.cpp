// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

namespace support {

namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::min(seconds + 0.5, 359999.0));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

}  // namespace

ProgressBar::ProgressBar(std::string label, vernier::Index total)
    : ProgressBar(std::move(label), total, stderr, isatty(STDERR_FILENO) == 1) {}

ProgressBar::ProgressBar(std::string label, vernier::Index total, std::FILE* stream, bool shown)
    : label_(std::move(label)), total_(total), stream_(stream), shown_(shown) {
  update(0);
}

void ProgressBar::update(vernier::Index done, std::string_view note) {
  if (!shown_) return;
  const Clock::time_point now = Clock::now();
  if (drawn_ && done < total_ && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  std::string line = label_;
  if (total_ > 0) {
    constexpr int width = 24;
    const double share = std::clamp(static_cast<double>(done) / static_cast<double>(total_), 0.0, 1.0);
    const auto filled = static_cast<int>(share * width);
    line += fmt::format(" [{:#<{}}{:.<{}}] {:3.0f} %", "", filled, "", width - filled, 100 * share);
    if (done > 0 && done < total_) line += fmt::format(", {} left", duration(elapsed * (1 / share - 1)));
  } else {
    line += fmt::format(" {} steps, {}", done, duration(elapsed));
  }
  if (!note.empty()) line += fmt::format(", {}", note);
  fmt::print(stream_, "\r\x1b[K{}", line);
  std::fflush(stream_);
}

void ProgressBar::operator()(const vernier::Progress& progress) {
  if (shown_) update(progress.generation, fmt::format("best {:.3g}", progress.best));
}

void ProgressBar::finish() {
  if (drawn_) std::fputs("\r\x1b[K", stream_);
  if (drawn_) std::fflush(stream_);
  drawn_ = shown_ = false;
}

}  // namespace support
