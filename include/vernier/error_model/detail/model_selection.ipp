// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/data/ordered_rows.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_model/detail/fit_input.hpp"
#include "vernier/error_model/detail/model_selection.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// Adds the time of its life to a sum [s].
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { sum_ += steady_seconds() - began_; }

 private:
  double& sum_;
  double began_ = steady_seconds();  // [s]
};

VERNIER_IMPL ModelSelection::ModelSelection(CalibrationProblem start, const ErrorModelOptions& options,
                                            std::vector<HarmonicSpectrum> spectra_of_joints, ChainTable nominal)
    : problem(std::move(start)),
      spectra(std::move(spectra_of_joints)),
      stride(std::max<Index>(1, problem.num_validation_blocks() / options.num_validation_poses)),
      options_(options),
      nominal_(std::move(nominal)) {
  const std::vector<Index> poses = problem.system().poses;
  const Index validated = problem.num_validation_blocks();
  const bool ordered = rows_are_ordered(problem.joints().topRows(validated));
  for (Index b = 0; b < problem.num_blocks(); ++b)
    clusters_.push_back(b < validated && !poses.empty() ? poses[static_cast<std::size_t>(b)] : b);
  if (!ordered) return;
  constexpr Index independent = 40, folds = 10, most = 100;  // clusters; blocks left out, and their poses
  for (Index b = 0; b < validated; ++b) {
    clusters_[static_cast<std::size_t>(b)] = b * independent / validated;
    left_together_.push_back(b * (std::max)(folds, validated / most) / validated);
  }
}

VERNIER_IMPL const ModelSelection::Linearised& ModelSelection::linearised() const {
  if (linearised_) return *linearised_;
  const VectorX all = problem.arm.scales();
  std::vector<double> scales(all.begin() + problem.arm.num_dense(), all.end());
  const std::vector<Fourier>& now = problem.arm.terms().transmission;
  const bool same = before_ && now == harmonics_ && scales == harmonic_scales_;
  linearised_.emplace(Linearised{problem.system(), problem.normal_equations(same ? &*before_ : nullptr),
                                 problem.arm.steps(), problem.drift_steps()});
  before_.reset();
  harmonics_ = now;
  harmonic_scales_ = std::move(scales);
  return *linearised_;
}

VERNIER_IMPL void ModelSelection::extended() {
  if (linearised_ && !problem.prior) before_ = std::move(linearised_->normal);
  linearised_.reset();
}

VERNIER_IMPL void ModelSelection::solve() {
  converged = problem.solve() && converged;
  changed();
}

VERNIER_IMPL void ModelSelection::steps(int count) {
  problem.solve(count);
  changed();
}

VERNIER_IMPL LeftOutBlocks ModelSelection::left_out(const Linearised& at, const VectorX& precisions) const {
  return left_out(at, FactorisedEquations(at.normal, precisions, at.steps, at.local_steps));
}

VERNIER_IMPL LeftOutBlocks ModelSelection::left_out(const Linearised& at, const FactorisedEquations& solved) const {
  const Stopwatch watch(leave_one_out_seconds);
  if (left_together_.empty()) return leave_one_out(at.system, solved, stride);
  BlockSystem system = at.system;
  system.poses = left_together_;
  return leave_one_out(system, solved, stride);
}

VERNIER_IMPL VectorX ModelSelection::left_out_errors() const {
  return error_norms(left_out(linearised(), problem.arm.precisions()).errors);
}

VERNIER_IMPL Eigen::Matrix3Xd ModelSelection::left_out_errors(const FactorisedEquations& solved) const {
  const Stopwatch watch(leave_one_out_seconds);
  return leave_one_out_errors(linearised().system, solved, stride);
}

VERNIER_IMPL void ModelSelection::extend_terms(const JointTerms& terms) {
  const JointTerms before = problem.arm.terms();
  const VectorX old_precisions = VERNIER_LATER(problem.arm.precisions()).tail(before.size());
  VectorX precisions = VectorX::Ones(terms.size());
  visit_common_terms(before, terms, [&](Index old, Index now) { precisions(now) = old_precisions(old); });
  VectorX sizes = expected_sizes(terms, options_, spectra);
  problem.arm.set_terms(terms, sizes, precisions);
  constexpr double held = 1e-9;
  const std::vector<Index> hidden = hidden_terms(problem, nominal_);
  for (const Index k : hidden) sizes(k) *= held;
  if (!hidden.empty()) problem.arm.set_terms(terms, sizes, precisions);
  extended();
}

VERNIER_IMPL bool ModelSelection::add(Block block, const JointTerms& terms) {
  const ArmParameterisation before = problem.arm;
  std::vector<JointTermBlock> additional;
  for (const JointTermBlock& now : terms.blocks()) {
    bool known = false;
    for (const JointTermBlock& old : before.terms().blocks())
      known = known || (old.kind == now.kind && old.joint == now.joint);
    if (known) continue;
    additional.push_back(now);
  }
  extend_terms(terms);
  UnknownGroup group;
  for (const JointTermBlock& now : additional)
    for (const Index k : unknowns(now.begin, now.count)) group.push_back(k);
  if (choose_by_evidence(block, group)) return true;
  problem.arm = before;
  extended();
  return false;
}

/// Unknowns of coefficients first .. first + count - 1.
VERNIER_IMPL UnknownGroup ModelSelection::unknowns(Index first, Index count) const {
  UnknownGroup out;
  const Index at = static_cast<Index>(problem.arm.geometric().size()) + first;
  for (Index k = 0; k < count; ++k) out.push_back(at + k);
  return out;
}

VERNIER_IMPL UnknownGroup ModelSelection::harmonics(int first, int last) const {
  UnknownGroup out;
  const Index geometric = static_cast<Index>(problem.arm.geometric().size());
  for (const JointTermBlock& block : problem.arm.terms().blocks())
    for (Index k = 0; block.joint >= 0 && k < block.count; ++k) {
      const int order = problem.arm.terms().transmission[static_cast<std::size_t>(block.joint)].order(k);
      if (order >= first && order <= last) out.push_back(geometric + block.begin + k);
    }
  return out;
}

VERNIER_IMPL UnknownGroup ModelSelection::of_kinds(std::initializer_list<JointTermBlock::Kind> kinds) const {
  UnknownGroup out;
  for (const JointTermBlock& block : problem.arm.terms().blocks())
    if (std::find(kinds.begin(), kinds.end(), block.kind) != kinds.end())
      for (const Index k : unknowns(block.begin, block.count)) out.push_back(k);
  return out;
}

VERNIER_IMPL std::vector<VectorX> ModelSelection::shapes_of(Block block, const ScoreTest& score) const {
  if (block != Block::jointwise) return {};
  const auto geometric = static_cast<Index>(problem.arm.geometric().size());
  VectorX shape = VectorX::Ones(problem.arm.size());
  for (const JointTermBlock& row : problem.arm.terms().blocks())
    for (Index k = 0; row.joint >= 0 && k < row.count; ++k)
      shape(geometric + row.begin + k) =
          1.0 / problem.arm.terms().transmission[static_cast<std::size_t>(row.joint)].order(k);
  VectorX tested(static_cast<Index>(score.tested.size()));
  for (Index k = 0; k < tested.size(); ++k) tested(k) = shape(score.tested[static_cast<std::size_t>(k)]);
  return {tested, VERNIER_LATER(tested).cwiseAbs2()};
}

VERNIER_IMPL BlockChoice ModelSelection::choice_between(Block block, ScoreTest score, const VectorX& with,
                                                        const VectorX& without, double precision) const {
  constexpr double looks = 12, level = 0.05 / looks;  // at one arm
  constexpr double nothing = 1e6;  // evidence for sizes of a thousandth of the expected ones is evidence for none
  const double sigma = problem.set_of(0).sigma().length;
  const double relevance =
      options_.relevant_size > 0 ? options_.relevant_size : (std::max)(0.1 * without.mean(), sigma);
  const Index poses = problem.num_validation_poses();
  BlockChoice out{block, without.mean(), with.mean(), false, suppressing_precision, {}};
  const std::vector<VectorX> shapes = shapes_of(block, score);
  out.existence = existence(score, level, relevance, poses, shapes);
  if (out.existence.answer == Answer::found && !(precision < nothing)) {
    constexpr double never = 0;  // is it found; the number of poses that would decide stays
    const Index decisive = out.existence.poses;
    out.existence = existence(score, never, relevance, poses, shapes);
    out.existence.poses = decisive;
  }
  out.used = out.existence.answer == Answer::found && !predicts_worse(with, without);
  if (out.used) out.precision = precision;
  return out;
}

VERNIER_IMPL ScoreTest ModelSelection::test(Block block, const UnknownGroup& group, const VectorX& sized,
                                            const FactorisedEquations& with, const FactorisedEquations& without) const {
  const Linearised& at = linearised();
  constexpr int low = 3;
  constexpr double none = 1e-6;
  VectorX precisions = sized;
  bool any = false;
  if (block != Block::elastic_again && problem.num_validation_poses() < many_poses)
    for (const Index k : harmonics(1, low)) {
      if (std::find(group.begin(), group.end(), k) != group.end() || precisions(k) >= suppressing_precision) continue;
      precisions(k) = none;
      any = true;
    }
  if (!any) return score_test(at.system, with, without, sized, at.steps, group, clusters_);
  return score_test(at.system, at.normal, precisions, at.steps, group, clusters_, at.local_steps);
}

VERNIER_IMPL bool ModelSelection::choose_by_evidence(Block block, const UnknownGroup& group,
                                                     std::optional<ScoreTest> score) {
  const Linearised& at = linearised();
  const VectorX before = problem.arm.precisions();
  const VectorX sized = scale_priors(at.normal, before, at.steps, problem.measured_values(), group, at.local_steps);
  VectorX suppressed = sized;
  for (const Index k : group) suppressed(k) = suppressing_precision;
  const FactorisedEquations with(at.normal, sized, at.steps, at.local_steps), without = with.with(suppressed, at.steps);
  if (!score) score = test(block, group, sized, with, without);
  blocks.push_back(choice_between(block, *score, error_norms(left_out(at, with)), error_norms(left_out(at, without)),
                                  sized(group.front())));
  const bool used = blocks.back().used;
  problem.arm.set_precisions(used ? sized : suppressed);
  return used;
}

VERNIER_IMPL void ModelSelection::measure_again(Block block, const UnknownGroup& group) {
  const auto choice = std::find_if(blocks.begin(), blocks.end(),
                                   [&](const BlockChoice& one) { return one.block == block && one.used; });
  if (choice == blocks.end()) return;
  const Linearised& at = linearised();
  const VectorX precisions = problem.arm.precisions();
  const ScoreTest score = score_test(at.system, at.normal, precisions, at.steps, group, clusters_, at.local_steps);
  constexpr double known = 1;  // level at which an effect is found in any case
  const Existence now =
      existence(score, known, choice->existence.relevance, problem.num_validation_poses(), shapes_of(block, score));
  choice->existence.size = now.size;
  choice->existence.interval = now.interval;
}

VERNIER_IMPL void ModelSelection::size_by_evidence(const UnknownGroup& group) {
  if (group.empty() || problem.arm.precisions()(group.front()) >= suppressing_precision) return;
  const Linearised& at = linearised();
  problem.arm.set_precisions(
      scale_priors(at.normal, problem.arm.precisions(), at.steps, problem.measured_values(), group, at.local_steps));
}

VERNIER_IMPL void ModelSelection::learn_spectrum(int iterations) {
  const Linearised& at = linearised();
  const Index values = problem.measured_values();
  std::vector<int> edges{1};
  for (const HarmonicSpectrum& spectrum : spectra)
    for (const HarmonicBand& band : spectrum) edges.insert(edges.end(), {band.first, band.last + 1});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<UnknownGroup> bands;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (auto band = harmonics(edges[i], edges[i + 1] - 1); !band.empty()) bands.push_back(std::move(band));
  const auto evidence = [&](const VectorX& precisions) {
    return log_evidence(at.normal, FactorisedEquations(at.normal, precisions, at.steps, at.local_steps), precisions,
                        at.steps, values, at.local_steps);
  };
  if (bands.empty()) return;
  VectorX precisions = problem.arm.precisions();
  constexpr double clearly = 10;
  if (problem.num_validation_poses() < many_poses)
    precisions = scale_priors(at.normal, precisions, at.steps, values, harmonics(1, (std::numeric_limits<int>::max)()),
                              at.local_steps);
  const VectorX learned = learn_priors(at.normal, precisions, at.steps, values, bands, iterations, at.local_steps);
  if (problem.num_validation_poses() >= many_poses || evidence(learned) > evidence(precisions) + clearly)
    precisions = learned;
  problem.arm.set_precisions(precisions);
  for (BlockChoice& choice : blocks)
    if (choice.block == Block::jointwise) choice.precision = precisions(bands.front().front());
}

}  // namespace vernier::detail
