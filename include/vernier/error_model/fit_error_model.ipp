// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/error_model/detail/assessment.hpp"
#include "vernier/error_model/detail/drift_selection.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_model/detail/gravity_direction.hpp"
#include "vernier/error_model/detail/line_search.hpp"
#include "vernier/error_model/detail/look_alikes.hpp"
#include "vernier/error_model/detail/model_selection.hpp"
#include "vernier/error_model/detail/prior_transfer.hpp"
#include "vernier/error_model/detail/stated_payloads.hpp"
#include "vernier/error_model/detail/temperature_selection.hpp"
#include "vernier/error_model/fit_error_model.hpp"

namespace vernier::detail {

/// The steps of `fit_error_model`.
class ErrorModelFit {
 public:
  VERNIER_LOCAL ErrorModelFit(const ErrorModelInput& input, const ErrorModelOptions& options,
                              const SensorModel& sensors, ExecutorRef executor)
      : input_(input),
        options_(options),
        model_(CalibrationProblem(ArmParameterisation(input.arms, geometric_unknowns(input, options)), input.sets,
                                  sensors.loss, sensors.joint_sigma),
               options, spectra_of(options, input.nominal.joints()), input.nominal),
        problem_(model_.problem) {
    problem_.executor = executor;
    problem_.arm.set_terms(no_terms(options, input.nominal.joints()), VectorX(), VectorX());
  }

  VERNIER_LOCAL ErrorModelOutput run(PriorSearch search) {
    model_.solve();
    out_.stages.push_back({Stage::geometry, true, arms()});
    if (input_.sets.front().locates()) out_.estimate.geometry_left_out_errors = model_.left_out_errors();
    reach(1);
    elastic_step();
    reach(2);
    jointwise_step(search);
    reach(4);
    approach_step();
    reach(5);
    tilt_step();
    reach(6);
    temperature_step();
    reach(7);
    inherited_ = options_.prior != nullptr && inherit();
    if (inherited_) thermal_ = problem_.arm.thermal_rates(0).size() > 0;
    if (options_.drift) add_drift(model_);
    reach(8);
    if (harmonics_ && !search && !inherited_) {  // with the weights that outliers have by now
      model_.learn_spectrum(4);
      model_.steps(1);
    }
    if (harmonics_ && options_.find_lines && !inherited_) find_lines(model_);
    reach(9);
    if (options_.compliance && payloads_ && !payloads_->vary && !inherited_) leave_payload_open(payloads_->mean);
    model_.solve();
    add_last_stages();
    complete_estimate();
    reach(fit_steps);
    return std::move(out_);
  }

 private:
  VERNIER_LOCAL void reach(Index step) const { options_.observer({step, 0, 0}); }

  /// Compliances to gravity and payload, and bends under a payload.
  VERNIER_LOCAL void elastic_step() {
    elastic_ = problem_.arm.terms();
    add_to(elastic_, JointTermBlock::Kind::gravity, options_.down);
    payloads_ = stated_payloads(problem_);
    if (options_.compliance && payloads_ && payloads_->vary)
      elastic_.payload.emplace(input_.nominal, options_.down, payloads_->mean);
    const bool deflects = elastic_.size() > 0 && model_.add(Block::elastic, elastic_);
    if (deflects) model_.solve();
    if (deflects && options_.estimate_down)
      out_.estimate.down_std = estimate_down(model_, elastic_, input_.nominal, options_.down);
    down_ = elastic_.gravity ? elastic_.gravity->down() : options_.down;
    if (elastic_.payload && problem_.arm.terms().payload) {
      JointTerms bends = problem_.arm.terms();
      bends.bend.emplace(input_.nominal, down_, payloads_->mean);
      if (model_.add(Block::payload_bend, bends)) model_.solve();
      elastic_.bend = problem_.arm.terms().bend;
    }
    out_.stages.push_back({Stage::elastic, deflects, arms()});
  }

  /// Harmonics, gear ratios and coupling; guides that are not straight.
  VERNIER_LOCAL void jointwise_step(PriorSearch search) {
    JointTerms periodic = elastic_;
    for (int j = 0; j < periodic.joints; ++j)
      if (input_.nominal.revolute(periodic.motors.row_of(j)))
        periodic.transmission[static_cast<std::size_t>(j)] =
            orders_of_joint(options_, model_.spectra, static_cast<std::size_t>(j), problem_.num_blocks());
    // linear in the joints, so beyond the measured ranges they stay as at their ends
    JointTerms linear = elastic_;
    linear.gear_ratio = options_.gear_ratio;
    linear.coupling = options_.coupling;
    const MatrixX angles = linear.motors.angles(problem_.joints());
    for (Index j = 0; j < angles.cols(); ++j)
      linear.linear_ranges.push_back({angles.col(j).minCoeff(), angles.col(j).maxCoeff()});
    harmonics_ = add_joint_functions(periodic, linear);
    const bool bent = add_straightness();       // beside the functions, which look like a bend where they are missing
    if (bent && !harmonics_ && !has_gears()) {  // and the other way round
      std::erase_if(model_.blocks,
                    [](const BlockChoice& one) { return one.block == Block::jointwise || one.block == Block::gears; });
      periodic.straightness = linear.straightness = problem_.arm.terms().straightness;
      harmonics_ = add_joint_functions(periodic, linear);
    }
    jointwise_ = bent || harmonics_ || has_gears();
    reach(3);
    if (jointwise_) size_again(search);
    JointTerms all = linear;
    all.transmission = periodic.transmission;
    all.straightness = problem_.arm.terms().straightness;
    compare_look_alikes(model_, all);
    out_.stages.push_back({Stage::jointwise, jointwise_, arms()});
  }

  /// Harmonics, and gear ratios and coupling beside them or in their place.
  /// @return whether there are harmonics
  VERNIER_LOCAL bool add_joint_functions(const JointTerms& periodic, JointTerms linear) {
    if (periodic.size() == periodic.num_dense_terms()) return false;
    const bool may_gear = linear.gear_ratio || linear.coupling;
    if (!(may_gear ? add_harmonics_or_gears(periodic, linear) : model_.add(Block::jointwise, periodic))) return false;
    model_.steps(2);
    out_.estimate.fallback_error = model_.blocks.back().without;
    model_.size_by_evidence(link_unknowns(problem_.arm));  // less is left than when their priors were chosen
    model_.learn_spectrum(6);
    linear.transmission = periodic.transmission;
    if (may_gear && !has_gears() && model_.add(Block::gears, linear)) model_.learn_spectrum(4);
    return true;
  }

  /// Sizes deflection and geometry again, which is clearer once functions of joints are modelled; then their priors.
  VERNIER_LOCAL void size_again(PriorSearch search) {
    if (elastic_.gravity) {
      JointTerms deflecting = problem_.arm.terms();
      deflecting.gravity = elastic_.gravity;
      deflecting.payload = elastic_.payload;
      if (model_.gravity().empty())
        model_.add(Block::elastic_again, deflecting);
      else
        model_.choose_by_evidence(Block::elastic_again, model_.gravity());
    }
    model_.size_by_evidence(link_unknowns(problem_.arm));
    model_.solve();
    measure_without_deflection();
    if (!search || !harmonics_) return;
    tune(search);
    model_.solve();
  }

  /// Measures functions of joints once more where deflection stood in for a part of them and is gone.
  VERNIER_LOCAL void measure_without_deflection() {
    using Kind = JointTermBlock::Kind;
    const auto used = [&](Block block) {
      return std::any_of(model_.blocks.begin(), model_.blocks.end(),
                         [&](const BlockChoice& one) { return one.block == block && one.used; });
    };
    if (!used(Block::elastic) || used(Block::elastic_again)) return;
    model_.measure_again(Block::gears, model_.of_kinds({Kind::gear_ratio, Kind::coupling}));
    model_.measure_again(Block::jointwise, model_.of_kinds({Kind::transmission}));
  }

  /// Hysteresis.
  VERNIER_LOCAL void approach_step() {
    JointTerms approached = problem_.arm.terms();
    hysteresis_ =
        add_to(approached, JointTermBlock::Kind::hysteresis, down_) && model_.add(Block::approach, approached);
    if (hysteresis_) model_.steps(2);
    without_tilt_ = arms();
  }

  /// Tilts of the joints' frames under gravity.
  VERNIER_LOCAL void tilt_step() {
    JointTerms tilted = problem_.arm.terms();
    tilt_ = add_to(tilted, JointTermBlock::Kind::tilt, down_) && model_.add(Block::tilt, tilted);
    if (!tilt_) return;
    if (!harmonics_) out_.estimate.fallback_error = model_.blocks.back().without;
    model_.steps(2);
    model_.size_by_evidence(model_.gravity());  // the third axis, that of the joint
    model_.solve();
  }

  /// Change of the geometry with temperature.
  VERNIER_LOCAL void temperature_step() {
    thermal_ = options_.temperature && add_temperature(model_, options_.thermal_prior_std);
    if (!thermal_) return;
    const auto temperatures = problem_.temperatures();
    out_.temperatures = temperatures.range;
    out_.estimate.mean_temperature = temperatures.mean;
    out_.estimate.temperature_std = temperatures.std;
  }

  /// The stages after those of the functions of joints; one has the arms with everything.
  VERNIER_LOCAL void add_last_stages() {
    const std::vector<FittedArm> fitted = arms();
    const auto add = [&](Stage stage, bool included, const std::vector<FittedArm>& with, bool last = true) {
      out_.stages.push_back({stage, included, with, last});
    };
    if (inherited_) {
      add(Stage::prior, true, fitted);
    } else if (hysteresis_ || tilt_ || thermal_) {
      if (hysteresis_ || !tilt_) add(Stage::approach, hysteresis_, tilt_ ? without_tilt_ : fitted, !tilt_);
      if (tilt_) add(Stage::tilt, true, fitted);
      if (thermal_) add(Stage::temperature, true, fitted);
    } else {  // what is deployed is a stage of before: drift and lines are taken off it, too
      for (StagedArms& staged : out_.stages) {
        const Stage replaced = jointwise_ ? Stage::jointwise : geometry_alone() ? Stage::geometry : Stage::elastic;
        if (staged.stage == replaced || staged.stage == Stage::jointwise) staged.arms = fitted;
      }
      out_.stages.back().last = true;
    }
    if (!problem_.drift.empty()) add(Stage::session, true, fitted);
  }

  /// What the fit says of itself, once it is solved.
  VERNIER_LOCAL void complete_estimate() {
    ErrorModelEstimate& estimate = out_.estimate;
    out_.joints = problem_.joints();
    for (int s = 0; thermal_ && s < problem_.arm.stations(); ++s)
      out_.thermal_rates.push_back(problem_.arm.thermal_rates(s));
    estimate.drift = problem_.drift;
    estimate.drives = options_.drives;
    estimate.arm = problem_.arm;
    estimate.blocks = model_.blocks;
    estimate.converged = model_.converged;
    assess(model_, estimate);
    if (model_.ordered() && input_.sets.front().locates()) estimate.block_error = model_.left_out_errors().mean();
    for (SessionDrift& of_station : estimate.drift)
      if (!of_station.empty()) {
        of_station.step_variance = problem_.drift_step_variance(estimate.residual_variance);
        to_chain(of_station);
      }
    if (geometry_alone()) estimate.geometry_left_out_errors = estimate.left_out_errors;
    if (inherited_) {  // for the next to start from
      VectorX precisions = problem_.arm.precisions();
      for (Index k = 0, first = precisions.size() - expected_.size(); k < expected_.size(); ++k)
        precisions(first + k) = expected_(k);
      estimate.arm.set_precisions(precisions);
    }
  }

  /// Whether nothing but geometry and frames is in the model.
  VERNIER_LOCAL bool geometry_alone() const {
    return !hysteresis_ && !tilt_ && !thermal_ && !inherited_ && !jointwise_ && problem_.arm.terms().size() == 0;
  }
  /// Whether gear ratios or coupling are in the model.
  VERNIER_LOCAL bool has_gears() const { return problem_.arm.terms().gear_ratio || problem_.arm.terms().coupling; }

  /// A drift of the motors' zeros as one of the zeros of the chain's joints.
  VERNIER_LOCAL void to_chain(SessionDrift& drift) const {
    const MotorAngles& motors = problem_.arm.terms().motors;
    if (motors.none() || drift.knots.rows() <= 6) return;
    const SessionDrift of_motors = drift;
    const int n = problem_.arm.terms().joints;
    for (int i = 0; i < n; ++i) {
      drift.step_variance(6 + i) = 0;
      for (int j = 0; j < n; ++j)
        drift.step_variance(6 + i) += motors.moved(i, j) * motors.moved(i, j) * of_motors.step_variance(6 + j);
      for (Index c = 0; c < drift.knots.cols(); ++c) {
        drift.knots(6 + i, c) = 0;
        for (int j = 0; j < n; ++j) drift.knots(6 + i, c) += motors.moved(i, j) * of_motors.knots(6 + j, c);
      }
    }
  }

  /// Makes a block present if the options allow it.
  VERNIER_LOCAL bool add_to(JointTerms& terms, JointTermBlock::Kind kind, const Vector3& down) const {
    const auto parameters = options_.parameters(kind, down);
    if (parameters) terms.add(kind, input_.nominal, *parameters);
    return parameters.has_value();
  }

  /// Adds how prismatic joints depart from a straight motion, over the range in which they were measured.
  /// @return whether they do
  VERNIER_LOCAL bool add_straightness() {
    JointTerms terms = problem_.arm.terms();
    const MatrixX joints = problem_.joints();
    std::vector<JointRange> ranges;
    bool any = false, moved = true;
    for (int j = 0; j < input_.nominal.joints(); ++j) {
      ranges.push_back({joints.col(j).minCoeff(), joints.col(j).maxCoeff()});
      if (input_.nominal.revolute(j)) continue;
      any = true;
      moved = moved && ranges.back().lower < ranges.back().upper;
    }
    if (!options_.straightness || !any || !moved) return false;
    terms.straightness.emplace(input_.nominal, std::move(ranges));
    if (!model_.add(Block::straightness, terms)) return false;
    model_.solve();
    return true;
  }

  /// Adds compliances to payload of which one payload says nothing: they stay at their priors, and so does what they
  /// add to the covariance under other payloads. Products of compliance and weight tell how compliant a joint may be.
  VERNIER_LOCAL void leave_payload_open(const Payload& reference) {
    JointTerms terms = problem_.arm.terms();
    terms.payload.emplace(input_.nominal, down_, reference);
    model_.extend_terms(terms);
    constexpr double light = 100;  // weight of the links of a light arm [N]
    const VectorX& coefficients = problem_.arm.joint_errors().coefficients();
    VectorX of_products = VectorX::Zero(terms.joints), precisions = problem_.arm.precisions();
    for (const JointTermBlock& block : terms.blocks()) {
      for (int i = 0; block.kind == JointTermBlock::Kind::gravity && i < terms.joints; ++i)
        for (int j = i; j < terms.joints; ++j)
          of_products(i) += coefficients(block.begin + terms.gravity->index(i, j)) / light;
      for (int i = 0; block.kind == JointTermBlock::Kind::payload && i < terms.joints; ++i) {
        const double ratio = of_products(i) / options_.payload_prior_std;
        precisions(precisions.size() - terms.size() + block.begin + i) = 1 / (1 + ratio * ratio);
      }
    }
    problem_.arm.set_precisions(precisions);
    model_.changed();
  }

  VERNIER_LOCAL std::vector<FittedArm> arms() const {
    std::vector<FittedArm> out;
    for (int s = 0; s < problem_.arm.stations(); ++s)
      out.push_back({problem_.arm.geometry(s), problem_.arm.joint_errors()});
    return out;
  }

  /// Adds harmonics, or gears and then harmonics beside them. What grows with the joint value looks like a function
  /// that repeats, and the other way round. So each is tried alone, and the one that predicts better comes first.
  /// @param periodic terms with harmonics
  /// @param linear   terms with gear ratios and coupling
  /// @return         whether there are harmonics
  VERNIER_LOCAL bool add_harmonics_or_gears(const JointTerms& periodic, JointTerms linear) {
    const CalibrationProblem before = problem_;
    const bool harmonics = model_.add(Block::jointwise, periodic);
    const CalibrationProblem with_harmonics = problem_;
    const std::vector<BlockChoice> choices = model_.blocks;
    problem_ = before;
    model_.changed();
    model_.blocks.pop_back();
    if (model_.add(Block::gears, linear) && (!harmonics || model_.blocks.back().with < choices.back().with)) {
      model_.solve();
      linear.transmission = periodic.transmission;
      return model_.add(Block::jointwise, linear);
    }
    const BlockChoice alone = model_.blocks.back();
    problem_ = with_harmonics;
    model_.changed();
    model_.blocks = choices;
    if (!harmonics) model_.blocks.push_back(alone);
    return harmonics;
  }

  /// Fits again with what an earlier calibration knows as the prior, and keeps that where left-out poses are predicted
  /// better.
  VERNIER_LOCAL bool inherit() {
    const ArmPrior& prior = *options_.prior;
    demand(prior.nominal.joints() == input_.nominal.joints() && prior.nominal.modified() == input_.nominal.modified(),
           "fit_error_model: the earlier calibration is of an arm of ", prior.nominal.joints(), " joints in the ",
           prior.nominal.modified() ? "modified" : "standard", " convention");
    ErrorModelEstimate& estimate = out_.estimate;
    const CalibrationProblem without = problem_;
    const double error_without = model_.left_out_errors().mean();

    const ErrorModelEstimate& before = prior.estimate;
    const JointTerms& terms = before.arm.terms();
    const auto place = [](const JointTerms& of) { return of.motors.none() ? "joints of the chain" : "motors"; };
    demand(terms.motors == problem_.arm.terms().motors, "fit_error_model: gears of the earlier calibration err at ",
           place(terms), ", those of this robot at ", place(problem_.arm.terms()));
    problem_.arm = ArmParameterisation(input_.arms, with_unknowns_of(prior, geometric_unknowns(input_, options_)));
    problem_.arm.set_terms(terms, VERNIER_LATER(before.arm.scales()).tail(terms.size()), VectorX::Zero(terms.size()));
    problem_.reference_temperature = before.mean_temperature;
    const TransferredUnknowns known = transferred_unknowns(prior, problem_.arm, input_.nominal);
    VectorX to_mean = VectorX::Zero(problem_.arm.size());
    for (std::size_t k = 0; k < known.unknowns.size(); ++k)
      to_mean(known.unknowns[k]) = known.mean(static_cast<Index>(k));
    problem_.arm.move(to_mean);
    problem_.reset_weights();
    constexpr double usual = 0.15;  // change of an arm in months
    problem_.prior = known.prior(problem_.arm.size(), usual, usual);
    bool converged = problem_.solve();
    model_.changed();
    PriorTransfer transfer = likely_transfer(problem_, known);
    problem_.prior = known.prior(problem_.arm.size(), transfer.geometry, transfer.joints);
    converged = problem_.solve() && converged;
    model_.changed();

    const double error_with = model_.left_out_errors().mean();
    transfer.name = prior.name;
    constexpr double unrelated = 0.6;  // of errors that have nothing to do with each other it would be above 1
    const bool holds = (std::min)(transfer.geometry, transfer.joints) < unrelated;
    transfer.used = converged && holds && error_with < error_without;
    estimate.prior = transfer;
    model_.blocks.push_back(
        {Block::prior, error_without, error_with, transfer.used, 1 / (transfer.joints * transfer.joints)});
    if (!transfer.used) {
      problem_ = without;
      model_.changed();
      return false;
    }
    model_.converged = true;
    if (same_value(estimate.fallback_error, 0)) estimate.fallback_error = error_without;
    expected_ = VERNIER_LATER(before.arm.precisions()).tail(terms.size());
    if (before.temperature_std > 0) {
      out_.temperatures = problem_.temperatures().std > 0
                              ? std::array{(std::min)(problem_.temperatures().range[0], prior.temperatures[0]),
                                           (std::max)(problem_.temperatures().range[1], prior.temperatures[1])}
                              : prior.temperatures;
      estimate.mean_temperature = before.mean_temperature;
      estimate.temperature_std = before.temperature_std;
    } else {
      estimate.mean_temperature = estimate.temperature_std = 0;
    }
    return true;
  }

  /// Priors of the joint errors by a search over leave-one-pose-out errors; kept where those are smaller than before.
  VERNIER_LOCAL void tune(PriorSearch search) {
    VectorX amplitudes(problem_.arm.size() - problem_.arm.num_dense());
    const Index dense_terms = problem_.arm.terms().num_dense_terms();
    for (const JointTermBlock& block : problem_.arm.terms().blocks())
      for (Index k = 0; block.joint >= 0 && k < block.count; ++k)
        amplitudes(block.begin - dense_terms + k) =
            problem_.arm.scales()(problem_.arm.num_dense() + block.begin - dense_terms + k) /
            problem_.arm.scales()(problem_.arm.num_dense() + block.begin - dense_terms);
    const ModelSelection::Linearised& at = model_.linearised();
    const VectorX before = problem_.arm.precisions();
    const PriorObjective objective(at.system, at.normal, before, at.steps, dense_terms, amplitudes, model_.stride);
    const VectorX after = objective.precisions(search(objective, objective.box()));
    const double without = objective.error(before), with = objective.error(after);
    model_.blocks.push_back({Block::tuned_priors, without, with, with < without, 1});
    problem_.arm.set_precisions(with < without ? after : before);
  }

  const ErrorModelInput& input_;
  const ErrorModelOptions& options_;
  ModelSelection model_;
  CalibrationProblem& problem_;  // that of `model_`
  ErrorModelOutput out_{.estimate = {.arm = problem_.arm}};
  std::optional<StatedPayloads> payloads_{};
  JointTerms elastic_{};          // what may deflect: with compliances, also those that were not supported
  Vector3 down_ = options_.down;  // as it was estimated, where it was
  std::vector<FittedArm> without_tilt_{};
  VectorX expected_{};  // precisions of the joint errors by an earlier calibration that is used
  // what is in the model
  bool harmonics_ = false, jointwise_ = false, hysteresis_ = false, tilt_ = false, thermal_ = false, inherited_ = false;
};

VERNIER_IMPL ErrorModelOutput fit_error_model(ErrorModelInput input, const ErrorModelOptions& options,
                                              const SensorModel& sensors, PriorSearch search, ExecutorRef executor) {
  options.validate();
  sensors.validate();
  demand(!input.sets.empty(), "fit_error_model: no measurements");
  const MeasuredSet& first = input.sets.front();
  for (const MeasuredSet& set : input.sets)
    demand(first.locates() || set.kind() == first.kind(), "fit_error_model: ", set.name, " beside ", first.name,
           ", but without poses");
  input.place();
  return ErrorModelFit(input, options, sensors, executor).run(search);
}

}  // namespace vernier::detail
