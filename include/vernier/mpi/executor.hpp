// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Populations distributed over MPI ranks: every rank runs the same search and evaluates its part of each population.

/// @cond
// Without the C++ bindings, which MPI itself has removed: they cause warnings and need a library of their own.
#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX 1
#endif
#ifndef MPICH_SKIP_MPICXX
#define MPICH_SKIP_MPICXX 1
#endif
/// @endcond
#include <mpi.h>

#include <bit>
#include <cstdint>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "vernier/core/executor.hpp"

namespace vernier {

namespace detail {

/// Turns an error code of MPI into an exception. By MPI's default an error aborts all ranks before it is returned.
inline void check_mpi(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw std::runtime_error(message("MpiExecutor: ", call, ": ", text));
}

}  // namespace detail

/// A `DistributedExecutor` over the ranks of an MPI communicator. In a search every rank evaluates its own columns of a
/// population, on the threads of a local executor if it has one, and all fitness values are gathered on every rank.
///
///     int level = 0;
///     MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
///     {
///       const vernier::ThreadExecutor threads(4);                       // in each rank; optional
///       const vernier::MpiExecutor ranks(MPI_COMM_WORLD, threads);
///       const auto predictor = recipe.fit(X, Y, {.seed = 1, .executor = ranks});   // on every rank, with equal data
///       if (ranks.rank() == 0) save(predictor);
///     }
///     MPI_Finalize();
///
/// - Every rank makes the same calls with the same data and seed. Then every rank has the same result: the same bits
///   as without MPI, for any number of ranks (on equal processors: another instruction set rounds differently).
/// - The observer is called on rank 0 only, and its decision holds for all.
/// - An exception of the objective or of the observer on one rank is thrown on all: the rank itself rethrows it, the
///   others throw std::runtime_error with its text and the number of the (first such) rank. A rank that stops in any
///   other way, before or between searches, must end the program (MPI_Abort), or the others wait for it.
/// - Ranks whose populations differ (for instance by another seed) throw std::invalid_argument, all of them. Different
///   data are not detected.
///
/// `for_ranges` works on the whole range in every rank. Not to be used from several threads at once.
/// @complexity two collective calls per population; each rank sends eight bytes per particle of its own
class MpiExecutor {
 public:
  /// Ranks that compute on the calling thread. Collective: all ranks of the communicator construct one together. The
  /// communicator is duplicated, so that messages cannot be confused with the program's own.
  /// @throws std::invalid_argument before MPI_Init, after MPI_Finalize and on MPI_COMM_NULL
  explicit MpiExecutor(MPI_Comm communicator = MPI_COMM_WORLD) {
    int started = 0, ended = 0;
    MPI_Initialized(&started);
    MPI_Finalized(&ended);
    demand(started != 0, "MpiExecutor: MPI is not initialised, call MPI_Init_thread first");
    demand(ended == 0, "MpiExecutor: MPI is finalised already");
    demand(communicator != MPI_COMM_NULL, "MpiExecutor: the communicator is MPI_COMM_NULL");
    detail::check_mpi(MPI_Comm_dup(communicator, &communicator_), "MPI_Comm_dup");
    detail::check_mpi(MPI_Comm_rank(communicator_, &rank_), "MPI_Comm_rank");
    detail::check_mpi(MPI_Comm_size(communicator_, &ranks_), "MPI_Comm_size");
  }

  /// @param communicator the ranks the work is distributed over
  /// @param local        executor of a rank's part of it; must outlive this
  /// @throws std::invalid_argument also where MPI was initialised without thread support (MPI_Init_thread,
  /// MPI_THREAD_FUNNELED)
  MpiExecutor(MPI_Comm communicator, ExecutorRef local) : MpiExecutor(communicator) {
    int level = MPI_THREAD_SINGLE;
    detail::check_mpi(MPI_Query_thread(&level), "MPI_Query_thread");
    demand(level >= MPI_THREAD_FUNNELED, "MpiExecutor: MPI's thread level is ", level,
           ", must be at least MPI_THREAD_FUNNELED (", int{MPI_THREAD_FUNNELED}, ") for an executor inside a rank");
    local_ = local;
  }

  MpiExecutor(const MpiExecutor&) = delete;
  MpiExecutor& operator=(const MpiExecutor&) = delete;
  ~MpiExecutor() {
    int ended = 0;
    MPI_Finalized(&ended);
    if (ended == 0) MPI_Comm_free(&communicator_);
  }

  /// This process' number, 0 to ranks() - 1.
  int rank() const { return rank_; }
  /// Number of processes.
  int ranks() const { return ranks_; }

  /// Calls `work` on the whole range, in every rank.
  void for_ranges(Index n, RangeFunction work) const { local_.for_ranges(n, work); }

  /// Computes a part of `values` in each rank, and exchanges them. Collective.
  void allgather(VectorRef values, RangeFunction work) const {
    const Index n = values.size(), begin = first(rank_, n), end = first(rank_ + 1, n);
    const long long before = fingerprint(values);
    std::exception_ptr failure;
    std::string text;
    try {
      demand(n <= (std::numeric_limits<int>::max)(), "MpiExecutor: ", n, " values are more than MPI can count");
      if (begin < end) local_.for_ranges(end - begin, [&](Index from, Index to) { work(begin + from, begin + to); });
    } catch (const std::exception& error) {
      failure = std::current_exception();
      text = error.what();
    } catch (...) {
      failure = std::current_exception();
      text = "an exception of unknown type";
    }
    // All ranks meet here, also those that failed: the first of these, the smallest and the largest fingerprint.
    long long agreed[3] = {failure ? rank_ : ranks_, before, -before};
    detail::check_mpi(MPI_Allreduce(MPI_IN_PLACE, agreed, 3, MPI_LONG_LONG, MPI_MIN, communicator_), "MPI_Allreduce");
    if (agreed[0] < ranks_) fail(static_cast<int>(agreed[0]), text, failure);
    demand(agreed[1] == -agreed[2], "MpiExecutor: rank ", rank_, " of ", ranks_, ", which has ", n,
           " values to gather, runs another computation than the others: every rank needs the same seed, options and "
           "calls");
    gather(values);
  }

 private:
  /// First of a rank's share of n values. Rank 0 has the first of the larger shares, so a single value is its own.
  Index first(int rank, Index n) const { return (n * rank + ranks_ - 1) / ranks_; }

  /// FNV-1a hash of the values' bits and number, not negative: detects ranks that run different searches.
  static long long fingerprint(const ConstVectorRef& values) {
    auto hash = (14695981039346656037u ^ static_cast<std::uint64_t>(values.size())) * 1099511628211u;
    for (const double value : values) hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211u;
    return static_cast<long long>(hash >> 1);
  }

  /// Throws on every rank; `text` is used on the failed one only.
  [[noreturn]] void fail(int failed, std::string text, const std::exception_ptr& own) const {
    int length = static_cast<int>(text.size());
    detail::check_mpi(MPI_Bcast(&length, 1, MPI_INT, failed, communicator_), "MPI_Bcast");
    text.resize(static_cast<std::size_t>(length));
    detail::check_mpi(MPI_Bcast(text.data(), length, MPI_CHAR, failed, communicator_), "MPI_Bcast");
    if (own) std::rethrow_exception(own);
    throw std::runtime_error(message("MpiExecutor: rank ", failed, ": ", text));
  }

  void gather(VectorRef values) const {
    std::vector<int> counts, starts;
    for (int rank = 0; rank < ranks_; ++rank) {
      starts.push_back(static_cast<int>(first(rank, values.size())));
      counts.push_back(static_cast<int>(first(rank + 1, values.size())) - starts.back());
    }
    detail::check_mpi(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, values.data(), counts.data(), starts.data(),
                                     MPI_DOUBLE, communicator_),
                      "MPI_Allgatherv");
  }

  MPI_Comm communicator_ = MPI_COMM_NULL;
  ExecutorRef local_;
  int rank_ = 0, ranks_ = 1;
};

static_assert(DistributedExecutor<const MpiExecutor>);

}  // namespace vernier
