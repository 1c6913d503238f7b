// SPDX-License-Identifier: BSD-3-Clause
#include "ranks.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <stdexcept>
#ifdef VERNIER_HAS_MPI
#include <chrono>
#include <thread>

#include "vernier/mpi.hpp"
#endif

namespace support {

namespace {

/// What Open MPI, MPICH and Slurm tell the processes they start.
bool started_as_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

}  // namespace

#ifdef VERNIER_HAS_MPI

Ranks::Ranks() {
  if (!started_as_rank()) return;  // else MPI would start services for this one process
  int level = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
  if (!first() && std::freopen("/dev/null", "w", stdout) == nullptr) std::fclose(stdout);
}

Ranks::~Ranks() {
  int started = 0;
  MPI_Initialized(&started);
  if (started != 0) MPI_Finalize();
}

std::vector<std::string> Ranks::gather(const std::string& text) const {
  if (!many()) return {text};
  // Waits without a processor: ranks may be done hours before others.
  MPI_Request all_here;
  MPI_Ibarrier(MPI_COMM_WORLD, &all_here);
  for (int here = 0; MPI_Test(&all_here, &here, MPI_STATUS_IGNORE), here == 0;)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const auto ranks = static_cast<std::size_t>(count_);
  const auto own = static_cast<long long>(text.size());
  std::vector<long long> sizes(ranks);
  MPI_Allgather(&own, 1, MPI_LONG_LONG, sizes.data(), 1, MPI_LONG_LONG, MPI_COMM_WORLD);
  std::vector<int> counts, starts;
  long long sum = 0;
  for (const long long size : sizes) {
    counts.push_back(static_cast<int>(size));
    starts.push_back(static_cast<int>(sum));
    if ((sum += size) > std::numeric_limits<int>::max())
      throw std::runtime_error(
          "the results of all ranks are too many for MPI; the same command without mpirun collects them");
  }
  std::string all(static_cast<std::size_t>(sum), '\0');
  MPI_Allgatherv(text.data(), counts[static_cast<std::size_t>(rank_)], MPI_CHAR, all.data(), counts.data(),
                 starts.data(), MPI_CHAR, MPI_COMM_WORLD);
  std::vector<std::string> out;
  for (std::size_t r = 0; r < ranks; ++r)
    out.push_back(all.substr(static_cast<std::size_t>(starts[r]), static_cast<std::size_t>(counts[r])));
  return out;
}

#else

Ranks::Ranks() {
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (size == nullptr) size = std::getenv("PMI_SIZE");
  if (started_as_rank() && size != nullptr && std::atoi(size) > 1)
    throw std::runtime_error("this program was built without MPI, so every process would do the whole work");
}

Ranks::~Ranks() = default;

std::vector<std::string> Ranks::gather(const std::string& text) const { return {text}; }

#endif

void Ranks::together(const std::function<void()>& work) const {
  std::exception_ptr own;
  std::string told;  // a letter and what went wrong; empty where nothing did
  try {
    work();
  } catch (const std::exception& error) {
    own = std::current_exception();
    told = std::string("!") + error.what();
  }
  const std::vector<std::string> all = gather(told);
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (all[r].empty()) continue;
    if (own) std::rethrow_exception(own);
    throw std::runtime_error(fmt::format("rank {}: {}", r, all[r].substr(1)));
  }
}

}  // namespace support
