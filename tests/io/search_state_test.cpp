// SPDX-License-Identifier: BSD-3-Clause
// Searches stopped half-way, saved, loaded and gone on with: the bits of the uninterrupted run; and files that are
// wrong.

#include "vernier/io/search_state.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/log.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/restarted.hpp"
#include "vernier/search/spso2011.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::search_state_test {
namespace {

using testing::same_bits;
using vernier_test::complaint;
using vernier_test::TemporaryFolder;

const TemporaryFolder folder("search_state");
const Box box{Eigen::Vector4d(-1, 0.5, 10, -1e-3), Eigen::Vector4d(2, 0.75, 30, 1e-3)};

/// Everywhere in a third of the box infinite, huge or tiny elsewhere: every kind of number has to be written.
double objective(const VectorX& x) {
  if (x(0) < 0) return std::numeric_limits<double>::infinity();
  return 1e12 * (x(0) - 0.3) * (x(0) - 0.3) + (x(1) - 0.6) * (x(1) - 0.6) + std::abs(x(2) - 11) / 3 + 1e-20 * x(3);
}

/// Every population a search evaluates from here on.
template <class A>
std::vector<MatrixX> rest_of(const A& algorithm, typename A::State state) {
  std::vector<MatrixX> out;
  const auto evaluate = [&](const MatrixX& population, VectorX& fitness) {
    out.push_back(population);
    fitness.resize(population.cols());
    for (Index k = 0; k < population.cols(); ++k) fitness(k) = objective(population.col(k));
  };
  for (int i = 0; i < 60 && !algorithm.done(state); ++i) algorithm.step(state, box, evaluate);
  return out;
}

template <class A>
void expect_same_bits_after_a_file(const A& algorithm, Index longest = 60) {
  const SearchResult whole = minimize(algorithm, objective, box, {.max_generations = longest}, 9);
  ASSERT_GT(whole.generations, 2);
  for (const Index half : {Index{0}, whole.generations / 2, whole.generations - 1}) {
    auto search = start_search(algorithm, objective, box, 9);
    minimize(algorithm, objective, box, search, {.max_generations = half});
    save_state(folder / "search.json", search);
    auto loaded = load_state<A>(folder / "search.json");
    const auto expected = rest_of(algorithm, search.state), found = rest_of(algorithm, loaded.state);
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_TRUE(same_bits(expected[i], found[i])) << i;
    const SearchResult result = minimize(algorithm, objective, box, loaded, {.max_generations = longest});
    EXPECT_TRUE(same_bits(result.best, whole.best));
    EXPECT_EQ(result.best_fitness, whole.best_fitness);
    EXPECT_EQ(result.evaluations, whole.evaluations);
    EXPECT_EQ(result.generations, whole.generations);
    EXPECT_EQ(result.status, whole.status);
  }
}

TEST(SearchState, EveryAlgorithmGoesOnFromAFile) {
  expect_same_bits_after_a_file(Pso{.particles = 6, .iterations = 20});
  expect_same_bits_after_a_file(Pso::constriction());
  expect_same_bits_after_a_file(Pso{.particles = 6, .iterations = 20, .neighbourhood = Neighbourhood::ring});
  expect_same_bits_after_a_file(Spso2011{.particles = 6, .iterations = 20});
  expect_same_bits_after_a_file(GeneticAlgorithm{.individuals = 7, .generations = 20});
  expect_same_bits_after_a_file(
      RealGeneticAlgorithm{.individuals = 7, .generations = 20, .selection = ParentSelection::roulette});
  expect_same_bits_after_a_file(DifferentialEvolution{.individuals = 8, .generations = 20});
  expect_same_bits_after_a_file(LShade{.max_evaluations = 1500}, 100);
  expect_same_bits_after_a_file(CmaEs{.generations = 50});
  expect_same_bits_after_a_file(CmaEs{.generations = 50, .restarts = 9, .tolerance_x = 0.15});
  expect_same_bits_after_a_file(RandomSearch{.individuals = 5, .generations = 9});
  expect_same_bits_after_a_file(Restarted{Pso{.particles = 5, .iterations = 4}, 5});
  expect_same_bits_after_a_file(Restarted{Restarted{CmaEs{.generations = 3}, 2}, 5});
}

// Patience counts across the pause, and an observer may save the search it watches.
TEST(SearchState, PatienceAndObservers) {
  const Pso pso{.particles = 6, .iterations = 200, .positions = PositionRule::clamped};
  const auto coarse = [](const VectorX& x) { return std::floor(4 * x(0)); };
  const StoppingCriteria stop{.patience = 7};
  const SearchResult whole = minimize(pso, coarse, box, stop, 3);
  ASSERT_EQ(whole.status, SearchStatus::stalled);
  auto search = start_search(pso, coarse, box, 3);
  const auto save = [&](const Progress& progress) {
    if (progress.generation == whole.generations - 3) save_state(folder / "watched.json", search);
  };
  EXPECT_EQ(minimize(pso, coarse, box, search, stop, {}, save).generations, whole.generations);
  auto loaded = load_state<Pso>(folder / "watched.json");
  EXPECT_EQ(loaded.state.generation, whole.generations - 3);
  EXPECT_EQ(loaded.evaluations, 6 * (whole.generations - 2));
  const SearchResult result = minimize(pso, coarse, box, loaded, stop);
  EXPECT_EQ(result.status, SearchStatus::stalled);
  EXPECT_EQ(result.generations, whole.generations);
  EXPECT_EQ(complaint([&] { minimize(pso, coarse, Box::cube(3, 0, 1), loaded); }),
            "minimize: the best point of the search has 4 entries, the box 3");
}

// Numbers at the ends of what doubles and integers hold.
TEST(SearchState, NumbersAreExact) {
  using S = Restarted<GeneticAlgorithm>::State;
  OngoingSearch<S> search;
  search.state.seed = ~std::uint64_t{0};
  search.state.current.codes = GeneticAlgorithm::Codes::Constant(5, 3, 65535);
  search.state.current.fitness = Eigen::Vector3d(-0.0, 5e-324, -std::numeric_limits<double>::infinity());
  search.state.best = search.state.current.best = (VectorX(5) << 0.1, 1.0 / 3, std::numeric_limits<double>::max(),
                                                   std::numeric_limits<double>::quiet_NaN(), -1e-310)
                                                      .finished();
  search.state.best_fitness = std::nextafter(1.0, 2.0);
  search.state.current.rng = Rng(77);
  search.evaluations = std::numeric_limits<Index>::max();
  save_state(folder / "ends.json", search);
  const auto loaded = load_state<Restarted<GeneticAlgorithm>>(folder / "ends.json");
  EXPECT_EQ(loaded.state.seed, search.state.seed);
  EXPECT_EQ(loaded.state.current.codes, search.state.current.codes);
  EXPECT_TRUE(same_bits(loaded.state.current.fitness, search.state.current.fitness));
  EXPECT_TRUE(same_bits(loaded.state.best, search.state.best));
  EXPECT_EQ(loaded.state.best_fitness, search.state.best_fitness);
  EXPECT_EQ(loaded.state.current.rng, search.state.current.rng);
  EXPECT_EQ(loaded.evaluations, search.evaluations);
}

std::string content(const std::string& name) {
  std::ifstream in(folder / name);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// What is said of a saved DE whose text `from` became `to`.
std::string said_of(const std::string& from, const std::string& to) {
  auto search = start_search(DifferentialEvolution{.individuals = 4}, objective, box, 9);
  save_state(folder / "right.json", search);
  std::string text = content("right.json");
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  std::ofstream(folder / "wrong.json") << text;
  const std::string said = complaint([] { load_state<DifferentialEvolution>(folder / "wrong.json"); });
  EXPECT_NE(said.find("wrong.json"), std::string::npos) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos);
  return said;
}

TEST(SearchState, FilesThatAreWrongAreRefused) {
  const auto expect = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  expect(said_of("\"schema_version\": 1", "\"schema_version\": 2"), "schema_version: is not supported");
  expect(said_of("\"generation\": 0", "\"generation\": 0.5"), "state.generation: must be a whole number");
  expect(said_of("\"generation\": 0", "\"generation\": -1"), "has negative counts");
  expect(said_of("\"generation\": 0", "\"generation\": 18446744073709551615"), "too large or too small");
  expect(said_of("\"generation\"", "\"generations\""), "state.generation: is missing");
  expect(said_of("\"generation\": 0", "\"generation\": 0, \"more\": 1"), "has members that are not of this search");
  expect(said_of("\"rows\": 4", "\"rows\": 3"), "state.best: has a number of values that its rows do not divide");
  expect(said_of("\"rows\": 4", "\"rows\": 2"), "state.best: must have one column");
  expect(said_of("\"rows\": 4", "\"rows\": -4"), "state.best: has a number of values that its rows do not divide");
  expect(said_of("\"positions\": {\n   \"rows\": 4", "\"positions\": {\n   \"rows\": 2"),
         "state: has members of inconsistent sizes");
  expect(said_of("\"rng\": [", "\"rng\": [1, "), "state.rng: must be a list of 4 whole numbers");
  expect(said_of("\"evaluations\": 4", "\"evaluations\": \"4\""), "evaluations: must be a whole number");
  expect(said_of("}\n}", "}"), "JSON");

  // another algorithm's state, a missing file
  save_state(folder / "pso.json", start_search(Pso{.particles = 4}, objective, box, 9));
  EXPECT_NE(complaint([] { load_state<DifferentialEvolution>(folder / "pso.json"); }).find("are not of this search"),
            std::string::npos);
  EXPECT_NE(complaint([] { load_state<CmaEs>(folder / "pso.json"); }).find("state.mean: is missing"),
            std::string::npos);
  EXPECT_NE(complaint([] { load_state<Pso>(folder / "nowhere.json"); }).find("nowhere.json"), std::string::npos);
  EXPECT_THROW(save_state(folder / "no" / "such.json", start_search(Pso{.particles = 4}, objective, box, 9)),
               std::runtime_error);
}

/// What is said of a saved search whose member at a JSON pointer became `value`.
std::string said_of_member(const char* pointer, const nlohmann::ordered_json& value) {
  save_state(folder / "right.json", start_search(CmaEs{.generations = 5}, objective, box, 9));
  auto document = nlohmann::ordered_json::parse(content("right.json"));
  const nlohmann::ordered_json::json_pointer at(pointer);
  EXPECT_TRUE(document.contains(at)) << pointer;
  document[at] = value;
  std::ofstream(folder / "wrong.json") << document.dump();
  const std::string said = complaint([] { load_state<CmaEs>(folder / "wrong.json"); });
  const std::size_t place = said.find("wrong.json: ");
  return place == std::string::npos ? said : said.substr(place + 12);
}

TEST(SearchState, MembersOfTheWrongKindAreNamed) {
  using Json = nlohmann::ordered_json;
  EXPECT_EQ(said_of_member("/state/converged", true), "");
  EXPECT_EQ(said_of_member("/state/converged", 1), "state.converged: must be true or false");
  EXPECT_EQ(said_of_member("/state/rng", {0, 0, 0, 0}), "state.rng: must not be all zero");
  EXPECT_EQ(said_of_member("/state/rng", {0, 0, 1, 0}), "");
  EXPECT_EQ(said_of_member("/state/rng", 1), "state.rng: must be a list of 4 whole numbers");
  EXPECT_EQ(said_of_member("/state/sigma", "large"), "state.sigma: must be a number");
  EXPECT_EQ(said_of_member("/state/mean/values/0", nullptr), "state.mean: must be a number");
  const std::string lists = "state.mean: must have 'rows' and a list of 'values'";
  EXPECT_EQ(said_of_member("/state/mean", 3), lists);
  EXPECT_EQ(said_of_member("/state/mean", Json{{"rows", 4}}), lists);
  EXPECT_EQ(said_of_member("/state/mean", Json{{"values", {1, 2, 3, 4}}}), lists);
  EXPECT_EQ(said_of_member("/state/mean", Json{{"rows", 4}, {"values", 4}}), lists);
  EXPECT_EQ(said_of_member("/state/mean", Json{{"rows", 0}, {"values", {1}}}),
            "state.mean: has a number of values that its rows do not divide");
  EXPECT_EQ(said_of_member("/state/mean/rows", 4.5), "state.mean.rows: must be a whole number");
  EXPECT_EQ(said_of_member("/state", 3), "state: must be an object");
  EXPECT_EQ(said_of_member("/evaluations", -1), "state: has negative counts");
  EXPECT_EQ(said_of_member("/schema_version", std::int64_t{1} << 40), "schema_version: is too large or too small");
  EXPECT_EQ(said_of_member("", Json::array()), "schema_version: is missing");
  EXPECT_EQ(said_of_member("", Json{{"schema_version", 1}}), "evaluations: is missing");
}

}  // namespace
}  // namespace vernier::search_state_test
