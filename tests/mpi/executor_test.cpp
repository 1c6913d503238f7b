// SPDX-License-Identifier: BSD-3-Clause
// A population shared out over ranks: the same bits as without MPI, every particle evaluated once, and no rank left
// waiting where another fails. Every rank runs every case; mpiexec fails when one of them does.

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "laws.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/mpi.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
#include "vernier/testing/executor_laws.hpp"

namespace vernier {
namespace {

using testing::same_bits;
using vernier_test::no_violations;

std::string said_before_start;  // by a constructor that ran before MPI_Init_thread

const Pso pso{.particles = 11, .iterations = 20};
const Box box = Box::cube(3, -2, 2);
double sphere(const VectorX& x) { return (x.array() - 0.1).square().sum(); }

/// A sum over all ranks.
Index total(Index value) {
  long long sum = value;
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
  return sum;
}

/// What a call threw.
template <class Exception, class Call>
std::string thrown(Call&& call) {
  try {
    call();
  } catch (const Exception& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("another type: ") + error.what();
  }
  return "nothing";
}

TEST(MpiExecutor, KeepsTheLaws) {
  const MpiExecutor ranks;
  EXPECT_TRUE(no_violations(testing::executor_violations(ranks)));
  for (const int threads : {1, 2, 3}) {
    const ThreadExecutor local(threads);
    const MpiExecutor with_threads(MPI_COMM_WORLD, local);
    EXPECT_TRUE(no_violations(testing::executor_violations(with_threads))) << threads << " threads in a rank";
  }
}

TEST(MpiExecutor, KnowsItsRank) {
  int rank = -1, ranks = -1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const MpiExecutor executor;
  EXPECT_EQ(executor.rank(), rank);
  EXPECT_EQ(executor.ranks(), ranks);
}

// Each particle is evaluated on one rank, and no rank has more than its share.
TEST(MpiExecutor, SharesThePopulationOut) {
  const MpiExecutor ranks;
  std::atomic<Index> here = 0;
  const auto counting = [&](const VectorX& x) {
    ++here;
    return sphere(x);
  };
  const SearchResult alone = minimize(pso, sphere, box, {}, 2);
  const SearchResult found = minimize(pso, counting, box, {}, 2, ranks);
  EXPECT_EQ(total(here), 11 * 21);
  EXPECT_EQ(found.evaluations, 11 * 21);
  EXPECT_LE(here, (11 / ranks.ranks() + 1) * 21);
  EXPECT_TRUE(same_bits(found.best, alone.best));
}

TEST(MpiExecutor, ForRangesIsWholeOnEveryRank) {
  const MpiExecutor ranks;
  std::atomic<Index> here = 0;
  ranks.for_ranges(17, [&](Index begin, Index end) { here += end - begin; });
  EXPECT_EQ(here, 17);
}

// PSO-ELM as users fit it, through a compensation: nothing but the executor changes.
TEST(MpiExecutor, SameFitAsAlone) {
  const auto arm = robots::abb_irb120().chain;
  const auto data = measure(with_geometric_errors(arm, {}, 1), abb_irb120_operating_region().sample(arm, 150, 1));
  const CartesianCompensation recipe{Tuned{Elm{.hidden_nodes = 10}, Pso{.particles = 9, .iterations = 8}}};
  const auto alone = recipe.fit(arm, data, {.seed = 5});
  const ThreadExecutor local(2);
  const MpiExecutor ranks, ranks_of_threads(MPI_COMM_WORLD, local);
  for (const MpiExecutor* executor : {&ranks, &ranks_of_threads}) {
    const auto fitted = recipe.fit(arm, data, {.seed = 5, .executor = *executor});
    EXPECT_TRUE(same_bits(fitted.identified().learned().theta(), alone.identified().learned().theta()));
    EXPECT_TRUE(same_bits(fitted.identified().learned().beta(), alone.identified().learned().beta()));
  }
}

// The objective fails at one particle, so on one rank: that rank throws what was thrown, the others say who it was, and
// the next search is as if nothing had been.
TEST(MpiExecutor, AnExceptionOnOneRankReachesAll) {
  const MpiExecutor ranks;
  for (int culprit = 0; culprit < ranks.ranks(); ++culprit) {
    int calls = 0;
    const auto failing = [&](const VectorX& x) {
      if (ranks.rank() == culprit && ++calls == 5) throw std::domain_error("singular");
      return sphere(x);
    };
    const auto search = [&] { static_cast<void>(minimize(pso, failing, box, {}, 2, ranks)); };
    if (ranks.rank() == culprit) {
      EXPECT_EQ(thrown<std::domain_error>(search), "singular");
    } else {
      EXPECT_EQ(thrown<std::runtime_error>(search), message("MpiExecutor: rank ", culprit, ": singular"));
    }
    EXPECT_TRUE(same_bits(minimize(pso, sphere, box, {}, 2, ranks).best, minimize(pso, sphere, box, {}, 2).best));
  }
}

// Where several fail, the others hear the first; what is no std::exception arrives, too, also from a rank's threads.
TEST(MpiExecutor, ExceptionsOnSeveralRanks) {
  const ThreadExecutor local(2);
  const MpiExecutor ranks(MPI_COMM_WORLD, local);
  const auto all = [&](const VectorX&) -> double { throw std::domain_error(message("rank ", ranks.rank())); };
  EXPECT_EQ(thrown<std::domain_error>([&] { static_cast<void>(minimize(pso, all, box, {}, 2, ranks)); }),
            message("rank ", ranks.rank()));
  const auto number = [&](const VectorX& x) -> double {
    if (ranks.rank() == 0) throw 42;
    return sphere(x);
  };
  const auto search = [&] { static_cast<void>(minimize(pso, number, box, {}, 2, ranks)); };
  if (ranks.rank() == 0) {
    EXPECT_THROW(search(), int);
  } else {
    EXPECT_EQ(thrown<std::runtime_error>(search), "MpiExecutor: rank 0: an exception of unknown type");
  }
}

// Observers on all ranks that would decide differently: the first one's word holds, and it alone is asked.
TEST(MpiExecutor, TheFirstRanksObserverDecidesForAll) {
  const MpiExecutor ranks;
  int asked = 0;
  const auto observer = [&](const Progress& progress) {
    ++asked;
    return progress.generation < 3 + ranks.rank();
  };
  const SearchResult found = minimize(pso, sphere, box, {}, 2, ranks, observer);
  EXPECT_EQ(found.status, SearchStatus::observer_stopped);
  EXPECT_EQ(found.generations, 3);
  EXPECT_EQ(asked, ranks.rank() == 0 ? 4 : 0);

  // An observer on the first rank only, as for a progress bar; and one that fails there.
  const auto quits = [](const Progress& progress) { return progress.generation < 2; };
  EXPECT_EQ(
      minimize(pso, sphere, box, {}, 2, ranks, ranks.rank() == 0 ? ObserverRef(quits) : ObserverRef{}).generations, 2);
  const auto fails = [](const Progress&) -> bool { throw std::domain_error("terminal gone"); };
  const auto search = [&] { static_cast<void>(minimize(pso, sphere, box, {}, 2, ranks, fails)); };
  if (ranks.rank() == 0) {
    EXPECT_EQ(thrown<std::domain_error>(search), "terminal gone");
  } else {
    EXPECT_EQ(thrown<std::runtime_error>(search), "MpiExecutor: rank 0: terminal gone");
  }
}

TEST(MpiExecutor, RanksAtDifferentWorkAreRefused) {
  const MpiExecutor ranks;
  if (ranks.ranks() == 1) GTEST_SKIP() << "needs two ranks";
  const auto own_seed = static_cast<std::uint64_t>(ranks.rank());
  const std::string seeds =
      thrown<std::invalid_argument>([&] { static_cast<void>(minimize(pso, sphere, box, {}, own_seed, ranks)); });
  EXPECT_NE(seeds.find("runs another computation than the others"), std::string::npos) << seeds;
  EXPECT_NE(seeds.find(message("rank ", ranks.rank(), " of ", ranks.ranks())), std::string::npos) << seeds;
  const Pso own_size{.particles = 10 + ranks.rank(), .iterations = 20};
  const std::string sizes =
      thrown<std::invalid_argument>([&] { static_cast<void>(minimize(own_size, sphere, box, {}, 2, ranks)); });
  EXPECT_NE(sizes.find(message("has ", 10 + ranks.rank(), " values")), std::string::npos) << sizes;
  EXPECT_TRUE(same_bits(minimize(pso, sphere, box, {}, 2, ranks).best, minimize(pso, sphere, box, {}, 2).best));
}

// Two groups of ranks search for themselves, with seeds of their own.
TEST(MpiExecutor, PartOfTheRanks) {
  const MpiExecutor world;
  MPI_Comm half = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, world.rank() % 2, 0, &half);
  {
    const MpiExecutor ranks(half);
    const auto seed = static_cast<std::uint64_t>(world.rank() % 2);
    EXPECT_TRUE(same_bits(minimize(pso, sphere, box, {}, seed, ranks).best, minimize(pso, sphere, box, {}, seed).best));
  }
  MPI_Comm_free(&half);
}

TEST(MpiExecutor, RefusesWhatCannotWork) {
  EXPECT_EQ(said_before_start, "MpiExecutor: MPI is not initialised, call MPI_Init_thread first");
  EXPECT_EQ(thrown<std::invalid_argument>([] { const MpiExecutor none(MPI_COMM_NULL); }),
            "MpiExecutor: the communicator is MPI_COMM_NULL");
}

}  // namespace

// Whether the executor refuses threads where MPI was not told of them depends on how MPI was started; see main.
int check_single_thread_level() {
  const ThreadExecutor local(2);
  const std::string said = thrown<std::invalid_argument>([&] { const MpiExecutor executor(MPI_COMM_WORLD, local); });
  return said.find("must be at least MPI_THREAD_FUNNELED") != std::string::npos ? 0 : 1;
}

void note_refusal_before_start() {
  said_before_start = thrown<std::invalid_argument>([] { const MpiExecutor executor; });
}

}  // namespace vernier

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  vernier::note_refusal_before_start();
  int level = MPI_THREAD_SINGLE;
  if (argc > 1 && std::string(argv[1]) == "--single") {
    MPI_Init_thread(&argc, &argv, MPI_THREAD_SINGLE, &level);
    // Some libraries give more than was asked for; then there is nothing to refuse.
    const int status = level == MPI_THREAD_SINGLE ? vernier::check_single_thread_level() : 0;
    MPI_Finalize();
    return status;
  }
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  const int status = RUN_ALL_TESTS();
  MPI_Finalize();
  return status;
}
