// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Plans: the names of all methods, and the file format.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "cli.hpp"
#include "comparison.hpp"
#include "vernier/io/json.hpp"

namespace support {

namespace {

bool known(const std::vector<Named>& names, const std::string& name) {
  return std::any_of(names.begin(), names.end(), [&](const Named& n) { return name == n.name; });
}

std::string all_of(const std::vector<Named>& names) {
  std::string out;
  for (const Named& n : names) out += (out.empty() ? "" : ", ") + std::string(n.name);
  return out;
}

}  // namespace

const std::vector<Named>& classical_names() {
  static const std::vector<Named> names{
      {"none", "the arm as designed, in the sensor's frame"},
      {"geometry", "Denavit-Hartenberg parameters identified"},
      {"jointwise", "geometry, compliance and functions of single joints, solved together"},
      {"approach", "the same with hysteresis by the direction of approach, the drift of the session taken off"},
  };
  return names;
}

const std::vector<Named>& learner_names() {
  static const std::vector<Named> names{
      {"elm", "extreme learning machine as in the paper: minimum-norm output weights, raw angles"},
      {"ridge_elm", "the same with a ridge chosen by leave-one-out; sines and cosines"},
      {"var_pro_elm", "hidden layer trained by variable projection; sines and cosines"},
      {"bp_lm", "back-propagation network, Levenberg-Marquardt; sines and cosines"},
      {"bp_adam", "the same by Adam"},
      {"kernel_elm", "kernel ELM, length scale and ridge by leave-one-out; raw angles"},
      {"gp", "Gaussian process, a length scale an input by marginal likelihood; raw angles"},
      {"os_elm", "online sequential ELM, here in one batch; sines and cosines"},
      {"op_elm", "ELM pruned by leave-one-out; sines and cosines"},
      {"trig", "tensor products of sines and cosines of all angles, ridge by degree"},
      {"bagged", "20 ridge ELMs, each on 60 % of the poses"},
  };
  return names;
}

const std::vector<Named>& search_names() {
  static const std::vector<Named> names{
      {"random", "points drawn at random: what every other search has to beat"},
      {"pso", "PSO as in the paper: falling inertia, particles may leave the box"},
      {"pso_clamped", "the same, particles kept in the box"},
      {"pso_constriction", "PSO with Clerc's constriction, a ring of neighbours, kept in the box"},
      {"spso2011", "standard PSO 2011"},
      {"ga", "binary genetic algorithm with the paper's constants"},
      {"real_ga", "real-coded genetic algorithm: SBX, polynomial mutation"},
      {"de", "differential evolution, rand/1/bin"},
      {"lshade", "L-SHADE"},
      {"cmaes", "CMA-ES"},
#ifdef VERNIER_HAS_PAGMO
      {"pagmo_pso", "pagmo2's particle swarm, generation by generation"},
      {"pagmo_gaco", "pagmo2's ant colony"},
#endif
  };
  return names;
}

bool Method::classical() const { return known(classical_names(), learner); }

Method Method::parse(const std::string& text) {
  const auto plain = [](char c) { return c >= '!' && c <= '~'; };
  if (text.size() > 60 || !std::all_of(text.begin(), text.end(), plain))
    throw UsageError("the name of a method has at most 60 characters, all of them printable ASCII");
  Method out{.text = text};
  std::string rest = text;
  for (const char* base : {"geometry", "jointwise"})
    if (rest.starts_with(base + std::string("+"))) {
      out.base = base;
      rest = rest.substr(out.base.size() + 1);
      break;
    }
  if (const auto at = rest.find('@'); at != std::string::npos) {
    out.map = rest.substr(at + 1);
    rest = rest.substr(0, at);
    if (out.map != "raw" && out.map != "sincos" && out.map != "products")
      throw UsageError("'" + text + "': no input map is called '" + out.map + "'; there are raw, sincos, products");
  }
  if (const auto colon = rest.find(':'); colon != std::string::npos) {
    out.search = rest.substr(0, colon);
    rest = rest.substr(colon + 1);
    if (!known(search_names(), out.search))
      throw UsageError("'" + text + "': no search is called '" + out.search + "'; there are " + all_of(search_names()));
  }
  out.learner = rest;
  const bool classical = known(classical_names(), rest);
  if (!classical && !known(learner_names(), rest))
    throw UsageError("'" + text + "': no learner is called '" + rest + "'; there are " + all_of(classical_names()) +
                     " and " + all_of(learner_names()));
  if (classical && (!out.base.empty() || !out.map.empty() || !out.search.empty()))
    throw UsageError("'" + text + "': " + rest + " stands alone");
  constexpr const char* tunable[] = {"elm", "ridge_elm", "var_pro_elm"};
  if (!out.search.empty() && std::find(std::begin(tunable), std::end(tunable), rest) == std::end(tunable))
    throw UsageError("'" + text + "': only elm, ridge_elm and var_pro_elm can be searched for");
  return out;
}

Plan Plan::read(const std::filesystem::path& path) {
  const nlohmann::json document = vernier::read_json(path.string());
  constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();  // `prepare` knows the ranges
  try {
    const vernier::JsonNode root(document, path.string());
    root.allow_only({"problems", "methods", "poses", "seeds", "evaluations", "seconds", "nodes"});
    Plan plan;
    const auto each = [](const vernier::JsonNode& list, const auto& take) {
      for (std::size_t k = 0; k < list.size(); ++k) take(list.at(k));
    };
    each(root.at("problems"), [&](const vernier::JsonNode& p) {
      p.allow_only({"name", "robot", "errors", "region", "noise_mm", "data", "split", "separator", "decimal"});
      const auto text = [&](const char* name, const std::string& otherwise) {
        return p.has(name) ? p.at(name).text() : otherwise;
      };
      Problem problem;
      problem.robot = text("robot", problem.robot);
      problem.errors = text("errors", problem.errors);
      problem.region = text("region", problem.region);
      if (p.has("noise_mm")) problem.noise_mm = p.at("noise_mm").number();
      if (p.has("data")) problem.data = path.parent_path() / p.at("data").text();
      problem.csv.separator = text("separator", "");
      problem.csv.decimal = text("decimal", "");
      problem.split = text("split", problem.split);
      problem.name = text("name", problem.robot);
      plan.problems.push_back(problem);
    });
    each(root.at("methods"), [&](const vernier::JsonNode& m) { plan.methods.push_back(Method::parse(m.text())); });
    if (root.has("poses")) {
      plan.poses.clear();
      each(root.at("poses"), [&](const vernier::JsonNode& n) { plan.poses.push_back(n.integer(-any, any)); });
    }
    if (root.has("seeds")) {
      plan.seeds.clear();
      each(root.at("seeds"),
           [&](const vernier::JsonNode& s) { plan.seeds.push_back(static_cast<std::uint64_t>(s.integer(0, any))); });
    }
    if (root.has("evaluations")) plan.evaluations = root.at("evaluations").integer(-any, any);
    if (root.has("seconds")) plan.seconds = root.at("seconds").number();
    if (root.has("nodes")) plan.nodes = static_cast<int>(root.at("nodes").integer(0, 1000000));
    return plan;
  } catch (const vernier::DataError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace support
