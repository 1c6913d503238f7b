#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "vernier/core/detail/steady_seconds.hpp"
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
      nominal_(std::move(nominal)) {}

VERNIER_IMPL const ModelSelection::Linearised& ModelSelection::linearised() const {
  if (!linearised_)
    linearised_.emplace(
        Linearised{problem.system(), problem.normal_equations(), problem.arm.steps(), problem.drift_steps()});
  return *linearised_;
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
  const Stopwatch watch(leave_one_out_seconds);
  return leave_one_out(at.system, FactorisedEquations(at.normal, precisions, at.steps, at.local_steps), stride);
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
  changed();
}

VERNIER_IMPL bool ModelSelection::add(Block block, const JointTerms& terms, bool by_evidence) {
  const ArmParameterisation before = problem.arm;
  Index first = terms.size(), count = 0;  // of the additional coefficients, which are contiguous
  for (const JointTermBlock& now : terms.blocks()) {
    bool known = false;
    for (const JointTermBlock& old : before.terms().blocks())
      known = known || (old.kind == now.kind && old.joint == now.joint);
    if (known) continue;
    first = (std::min)(first, now.begin);
    count += now.count;
  }
  extend_terms(terms);
  if (by_evidence)
    choose_by_evidence(block, unknowns(first, count));
  else
    blocks.push_back(choose_by_errors(block, first, count));
  if (blocks.back().used) return true;
  problem.arm = before;
  changed();
  return false;
}

/// Chooses the prior of coefficients first .. first + count - 1 by leave-one-pose-out errors.
VERNIER_IMPL BlockChoice ModelSelection::choose_by_errors(Block block, Index first, Index count) {
  VectorX precisions = problem.arm.precisions();
  const Index at = static_cast<Index>(problem.arm.geometric().size()) + first;
  const Linearised& now = linearised();
  const Stopwatch watch(leave_one_out_seconds);
  const PriorChoice choice = choose_prior(now.system, now.normal, precisions, now.steps, at, count, stride);
  for (Index k = at; k < at + count; ++k) precisions(k) = choice.precision;
  problem.arm.set_precisions(precisions);
  const bool used = choice.precision < suppressing_precision;
  return {block, choice.suppressed_error, used ? choice.chosen_error : choice.smallest_error, used, choice.precision};
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

VERNIER_IMPL UnknownGroup ModelSelection::gravity() const {
  for (const JointTermBlock& block : problem.arm.terms().blocks())
    if (block.kind == JointTermBlock::Kind::gravity) return unknowns(block.begin, block.count);
  return {};
}

VERNIER_IMPL BlockChoice ModelSelection::choice_between(Block block, const LeftOutBlocks& with,
                                                        const LeftOutBlocks& without, double precision) const {
  const bool few = problem.num_validation_poses() < many_poses;
  const bool by_errors = errors_support(with, without);
  const bool by_densities = !by_errors && few && densities_support(with, without);
  const bool used = by_errors || by_densities;
  return {block,
          error_norms(without).mean(),
          error_norms(with).mean(),
          used,
          used ? precision : suppressing_precision,
          by_densities ? with.log_densities.mean() - without.log_densities.mean() : 0};
}

VERNIER_IMPL bool ModelSelection::choose_by_evidence(Block block, const UnknownGroup& group) {
  const Linearised& at = linearised();
  const VectorX before = problem.arm.precisions();
  const VectorX sized = scale_priors(at.normal, before, at.steps, problem.measured_values(), group, at.local_steps);
  VectorX suppressed = sized;
  for (const Index k : group) suppressed(k) = suppressing_precision;
  blocks.push_back(choice_between(block, left_out(at, sized), left_out(at, suppressed), sized(group.front())));
  const bool used = blocks.back().used;
  problem.arm.set_precisions(used ? sized : suppressed);
  return used;
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
