// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/executor.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace vernier {

VERNIER_IMPL void ThreadExecutor::for_ranges(Index n, RangeFunction work) const {
  const Index parts = std::min<Index>(threads_, n);
  if (parts <= 1) return SequentialExecutor{}.for_ranges(n, work);
  std::exception_ptr failure;
  std::mutex guard;
  const auto run = [&](Index part) {
    try {
      work(n * part / parts, n * (part + 1) / parts);
    } catch (...) {
      const std::scoped_lock lock(guard);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> workers;
    workers.reserve(static_cast<std::size_t>(parts - 1));
    for (Index part = 1; part < parts; ++part) workers.emplace_back(run, part);
    run(0);
  }
  if (failure) std::rethrow_exception(failure);
}

VERNIER_IMPL void ExecutorRef::allgather(VectorRef values, RangeFunction work) const {
  allgather_ != nullptr ? allgather_(object_, values, work) : for_ranges(values.size(), work);
}

VERNIER_IMPL bool ExecutorRef::broadcast(FunctionRef<bool()> condition) const {
  if (allgather_ == nullptr) return condition();
  VectorX value = VectorX::Zero(1);
  allgather(value, [&](Index, Index) { value(0) = condition() ? 1 : 0; });
  return value(0) > 0;
}

}  // namespace vernier
