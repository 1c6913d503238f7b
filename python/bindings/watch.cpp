// SPDX-License-Identifier: BSD-3-Clause
#include "watch.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <future>
#include <thread>

#include "arrays.hpp"
#include "vernier/core/check.hpp"

namespace python {

namespace {

namespace vn = vernier;

/// Thrown through work that is to end.
struct Interrupted {};

/// What both threads share.
class Watch {
 public:
  Watch(int threads, Steps steps) : threads_(threads), steps_(steps) {}

  /// As an observer.
  bool operator()(const vn::Progress& progress) {
    const std::lock_guard lock(mutex_);
    latest_ = progress;
    ++reports_;
    if (steps_ == Steps::reports) latest_.generation = reports_;
    return !stopped_;
  }
  /// As an executor: work ends between two of its parts.
  void for_ranges(vn::Index n, vn::RangeFunction work) const {
    if (stopped_) throw Interrupted();
    threads_.for_ranges(n, work);
    if (stopped_) throw Interrupted();
  }

  void stop() { stopped_ = true; }
  vn::Progress latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
  }

 private:
  vn::ThreadExecutor threads_;
  Steps steps_;
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_{};
  vn::Progress latest_{};
  vn::Index reports_ = 0;
};

}  // namespace

void watched(const py::object& progress, int threads, std::uint64_t seed,
             const std::function<void(const vn::FitOptions&)>& work, Steps steps) {
  Watch watch(threads, steps);
  const auto poll = [&] {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(watch.latest());
  };
  std::exception_ptr of_python;
  std::future<void> done =
      std::async(std::launch::async, [&] { work({.seed = seed, .executor = watch, .observer = watch}); });
  {
    const py::gil_scoped_release release;
    while (done.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
      if (of_python) continue;
      const py::gil_scoped_acquire acquire;
      try {
        poll();
      } catch (...) {
        of_python = std::current_exception();
        watch.stop();
      }
    }
  }
  if (of_python) {
    try {
      done.get();
    } catch (...) {  // the exception of Python says why
    }
    std::rethrow_exception(of_python);
  }
  done.get();
  poll();
}

int threads_of(const py::object& threads) {
  if (threads.is_none()) return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int out = static_cast<int>(std::min<vn::Index>(whole_number(threads, "threads"), 1 << 16));
  vn::demand(out >= 1, "threads is ", out, ", must be at least 1");
  return out;
}

}  // namespace python
