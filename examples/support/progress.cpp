// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "console.hpp"
#include "vernier/error_model/error_model_options.hpp"

namespace support {

namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::min(seconds + 0.5, 359999.0));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

bool is_shown() { return isatty(STDERR_FILENO) == 1 && !is_quiet(); }

}  // namespace

ProgressBar::ProgressBar(std::string label, vernier::Index total)
    : ProgressBar(std::move(label), total, stderr, is_shown()) {}

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

Working::Working(std::string label) : Working(std::move(label), stderr, is_shown(), std::chrono::seconds(2)) {}

Working::Working(std::string label, std::FILE* stream, bool shown, std::chrono::milliseconds from)
    : label_(std::move(label)), stream_(stream), from_(from) {
  if (shown) thread_ = std::thread([this] { run(); });
}

void Working::run() {
  std::unique_lock lock(mutex_);
  auto next = start_ + from_;
  bool drawn = false;
  while (!ended_.wait_until(lock, next, [&] { return end_; })) {
    const Clock::time_point now = Clock::now();
    const double left = std::chrono::duration<double>(end_expected_ - now).count();
    fmt::print(stream_, "\r\x1b[K{}, {}{}", label_, duration(std::chrono::duration<double>(now - start_).count()),
               left > 0 ? fmt::format(", about {} left", duration((std::max)(left, 1.0))) : "");
    std::fflush(stream_);
    drawn = true;
    next += std::chrono::milliseconds(500);
  }
  if (!drawn) return;
  std::fputs("\r\x1b[K", stream_);
  std::fflush(stream_);
}

double share_of_fit(vernier::Index steps) {
  constexpr std::array<double, vernier::fit_steps + 1> shares{0,    0.03, 0.05, 0.34, 0.45, 0.55,
                                                              0.64, 0.65, 0.82, 0.91, 1};
  return shares[static_cast<std::size_t>(std::clamp<vernier::Index>(steps, 0, vernier::fit_steps))];
}

void Working::reach(double share) {
  const std::lock_guard lock(mutex_);
  if (share > 0.2 && share < 1)  // before, it says too little
    end_expected_ = start_ + std::chrono::duration_cast<Clock::duration>((Clock::now() - start_) / share);
}

void Working::finish() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

}  // namespace support
