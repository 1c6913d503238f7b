// SPDX-License-Identifier: BSD-3-Clause
#include "results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>

#include "cli.hpp"
#include "vernier/io/json.hpp"

namespace support {

namespace {

namespace vn = vernier;

constexpr const char* numbers[] = {"mean", "median", "rms", "p95", "max", "before", "seconds", "learned_from"};

std::vector<double*> fields(Outcome& o) {
  return {&o.mean, &o.median, &o.rms, &o.p95, &o.max, &o.before, &o.seconds, &o.learned_from};
}

/// A list of numbers; JSON has null for what is not finite, such as the fitness of what cannot be fitted.
std::vector<double> list(const nlohmann::json& json, const char* name) {
  const auto fail = [&] { throw std::invalid_argument(std::string(name) + " must be a list of numbers"); };
  if (!json.is_array()) fail();
  std::vector<double> out;
  for (const nlohmann::json& value : json) {
    if (!value.is_number() && !value.is_null()) fail();
    out.push_back(value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>());
  }
  return out;
}

/// The same but for times.
bool same_numbers(const Outcome& a, const Outcome& b) {
  return a.mean == b.mean && a.median == b.median && a.rms == b.rms && a.p95 == b.p95 && a.max == b.max &&
         a.quantiles == b.quantiles && a.before == b.before && a.learned_from == b.learned_from &&
         a.convergence.evaluations == b.convergence.evaluations && a.convergence.best == b.convergence.best;
}

/// Whether a limit of time ended a search; such a run cannot be reproduced.
bool decided_by_time(const std::string& key) { return key.find("\"seconds_allowed\":") != std::string::npos; }

void append(const std::filesystem::path& path, const std::string& lines) {
  std::ofstream file(path, std::ios::app | std::ios::binary);
  file << lines;
  file.flush();
  if (!file) throw std::runtime_error(path.string() + ": a result could not be written");
}

std::string cells_words(std::size_t n) { return fmt::format("{} cell{}", n, n == 1 ? "" : "s"); }

Json cell_json(const Plan& plan, const Cell& cell) {
  const Problem& p = plan.problems[cell.problem];
  const Method& m = plan.methods[cell.method];
  Json out{{"robot", std::filesystem::path(p.robot).filename().string()}};
  if (p.measured()) {
    out["data"] = p.data.filename().string();
    out["split"] = p.split;
  } else {
    out["errors"] = p.errors;
    out["region"] = p.region;
    out["noise_mm"] = p.noise_mm;
  }
  if (!p.fingerprint.empty()) out["fingerprint"] = p.fingerprint;
  out["method"] = m.text;
  out["poses"] = cell.poses;
  out["seed"] = cell.seed;
  if (!m.search.empty() || plan.seconds > 0)
    plan.seconds > 0 ? out["seconds_allowed"] = plan.seconds : out["evaluations"] = plan.evaluations;
  out["nodes"] = plan.nodes;
  return out;
}

}  // namespace

std::string cell_key(const Plan& plan, const Cell& cell) { return nlohmann::json(cell_json(plan, cell)).dump(); }

Json to_json(const Outcome& outcome) {
  Json to = Json::object();
  if (outcome.failed()) {
    to["failure"] = outcome.failure;
    return to;
  }
  Outcome copy = outcome;
  const auto all = fields(copy);
  for (std::size_t k = 0; k < all.size(); ++k) to[numbers[k]] = *all[k];
  if (!outcome.quantiles.empty()) to["quantiles"] = outcome.quantiles;
  if (!outcome.convergence.best.empty())
    to["convergence"] = {{"evaluations", outcome.convergence.evaluations},
                         {"seconds", outcome.convergence.seconds},
                         {"best", outcome.convergence.best}};
  return to;
}

Outcome outcome_from_json(const nlohmann::json& json) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument(what);
  };
  require(json.is_object(), "the outcome must be an object");
  Outcome out;
  if (json.contains("failure")) {
    require(json["failure"].is_string(), "failure must be a text");
    out.failure = json["failure"].get<std::string>();
    return out;
  }
  const auto all = fields(out);
  for (std::size_t k = 0; k < all.size(); ++k) {
    require(json.contains(numbers[k]) && json[numbers[k]].is_number(), std::string(numbers[k]) + " must be a number");
    *all[k] = json[numbers[k]].get<double>();
  }
  if (json.contains("quantiles")) out.quantiles = list(json["quantiles"], "quantiles");
  if (json.contains("convergence")) {
    const nlohmann::json& c = json["convergence"];
    for (const char* name : {"evaluations", "seconds", "best"})
      require(c.is_object() && c.contains(name), std::string("convergence must have ") + name);
    out.convergence = {list(c["evaluations"], "evaluations"), list(c["seconds"], "seconds"), list(c["best"], "best")};
    const std::size_t n = out.convergence.best.size();
    require(out.convergence.evaluations.size() == n && out.convergence.seconds.size() == n,
            "the lists of convergence must have one length");
  }
  return out;
}

ResultsFile read_results(const std::filesystem::path& path) {
  const std::string text = vn::read_file(path.string());
  ResultsFile out;
  for (std::size_t end; (end = text.find('\n', out.whole)) != std::string::npos; out.whole = end + 1) {
    ResultLine line{out.lines.size() + 1, {}, {}, text.substr(out.whole, end - out.whole)};
    const auto fail = [&](const std::string& why) {
      throw std::invalid_argument(
          vn::message(path.string(), ", line ", line.number, ": no result of a comparison", why));
    };
    nlohmann::json entry;
    try {
      entry = vn::parse_json(line.text, "");
    } catch (const vn::DataError&) {
      fail("");
    }
    if (!entry.is_object() || !entry.contains("cell") || !entry["cell"].is_object() || !entry.contains("outcome"))
      fail("");
    try {
      line.outcome = outcome_from_json(entry["outcome"]);
    } catch (const std::invalid_argument& error) {
      fail(std::string(" (") + error.what() + ")");
    }
    if (line.outcome.failed()) fail(" (failures are not kept)");
    line.key = entry["cell"].dump();
    out.lines.push_back(std::move(line));
  }
  out.cut_off = out.whole < text.size();
  return out;
}

Results::Results(const std::filesystem::path& path, int rank) : path_(path) {
  if (rank > 0) path_ += fmt::format(".rank{}", rank);
  if (std::error_code error; std::filesystem::exists(path_, error)) {
    const ResultsFile file = read_results(path_);
    for (const ResultLine& line : file.lines) known_.try_emplace(line.key, line.outcome);
    if (file.cut_off) vn::write_file(path_.string(), vn::read_file(path_.string()).substr(0, file.whole));
  }
  (void)vn::writing_of(path_.string());
  if (rank == 0) take_in_ranks();
}

void Results::take_in_ranks() {
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  const std::string begins = path_.filename().string() + ".rank";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begins) || name.find_first_not_of("0123456789", begins.size()) != std::string::npos) continue;
    std::string lines;
    for (const ResultLine& line : read_results(entry.path()).lines)
      if (known_.try_emplace(line.key, line.outcome).second) lines += line.text + '\n';
    append(path_, lines);
    std::filesystem::remove(entry.path());
  }
}

std::optional<Outcome> Results::find(const Plan& plan, const Cell& cell) const {
  const auto at = known_.find(cell_key(plan, cell));
  return at == known_.end() ? std::optional<Outcome>() : at->second;
}

void Results::add(const Plan& plan, const Cell& cell, const Outcome& outcome) {
  append(path_, Json{{"cell", cell_json(plan, cell)}, {"outcome", to_json(outcome)}}.dump() + "\n");
  known_.try_emplace(cell_key(plan, cell), outcome);
}

void Results::remove() const {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

std::vector<std::string> merge_results(const std::vector<std::filesystem::path>& from,
                                       const std::filesystem::path& to) {
  struct Origin {
    std::string place;
    Outcome outcome;
  };
  std::map<std::string, Origin> known;
  std::vector<std::string> said;
  std::string text;
  std::vector<std::filesystem::path> files = from;
  if (std::error_code error; std::filesystem::exists(to, error)) files.insert(files.begin(), to);
  for (const std::filesystem::path& path : files) {
    const ResultsFile file = read_results(path);
    std::size_t twice = 0, other_times = 0;
    for (const ResultLine& line : file.lines) {
      const std::string place = vn::message(path.string(), ", line ", line.number);
      const auto [at, fresh] = known.try_emplace(line.key, Origin{place, line.outcome});
      if (fresh) {
        text += line.text + '\n';
      } else if (same_numbers(at->second.outcome, line.outcome)) {
        ++twice;
      } else if (decided_by_time(line.key)) {
        ++other_times;
      } else {
        throw std::invalid_argument(fmt::format(
            "{}: the cell of {} with another outcome (a mean error of {} mm, there {} mm); remove the line that is "
            "wrong",
            place, at->second.place, line.outcome.mean, at->second.outcome.mean));
      }
    }
    said.push_back(fmt::format("{}: {}", path.string(), cells_words(file.lines.size())));
    if (twice > 0) said.back() += fmt::format(", {} of them there already with the same numbers", twice);
    if (other_times > 0)
      said.push_back(
          fmt::format("{}: {} whose searches end by time {} there already, with other numbers: the first "
                      "outcome is kept",
                      path.string(), cells_words(other_times), other_times == 1 ? "is" : "are"));
    if (file.cut_off)
      said.push_back(
          fmt::format("{}, line {}: the last line is cut off and left out", path.string(), file.lines.size() + 1));
  }
  vn::write_file(to.string(), text);
  said.push_back(fmt::format("{}: {} in all", to.string(), cells_words(known.size())));
  return said;
}

}  // namespace support
