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
    static_cast<void>(options.controller.joints(input.nominal.joints()));
    JointTerms none(input.nominal.joints());
    none.motors = MotorAngles(options.controller);
    problem_.arm.set_terms(std::move(none), VectorX(), VectorX());
  }

  VERNIER_LOCAL ErrorModelOutput run(PriorSearch search) {
    ErrorModelOutput out{.estimate = {.arm = problem_.arm}};
    ErrorModelEstimate& estimate = out.estimate;
    model_.solve();
    out.stages.push_back({Stage::geometry, true, arms()});
    if (input_.sets.front().locates()) estimate.geometry_left_out_errors = model_.left_out_errors();

    JointTerms elastic = problem_.arm.terms();
    add_to(elastic, JointTermBlock::Kind::gravity, options_.down);
    const std::optional<StatedPayloads> payloads = stated_payloads(problem_);
    if (options_.compliance && payloads && payloads->vary)
      elastic.payload.emplace(input_.nominal, options_.down, payloads->mean);
    const bool deflects = elastic.size() > 0 && model_.add(Block::elastic, elastic);
    if (deflects) model_.solve();
    if (deflects && options_.estimate_down)
      estimate.down_std = estimate_down(model_, elastic, input_.nominal, options_.down);
    const Vector3 down = elastic.gravity ? elastic.gravity->down() : options_.down;
    if (elastic.payload && problem_.arm.terms().payload) {
      JointTerms bends = problem_.arm.terms();
      bends.bend.emplace(input_.nominal, down, payloads->mean);
      if (model_.add(Block::payload_bend, bends)) model_.solve();
      elastic.bend = problem_.arm.terms().bend;
    }
    out.stages.push_back({Stage::elastic, deflects, arms()});

    JointTerms all = elastic;
    for (int j = 0; j < all.joints; ++j)
      if (input_.nominal.revolute(all.motors.row_of(j)))
        all.transmission[static_cast<std::size_t>(j)] =
            orders_of_joint(options_, model_.spectra, static_cast<std::size_t>(j), problem_.num_blocks());
    // linear in the joints, so beyond the measured ranges they stay as at their ends
    JointTerms linear = elastic;
    linear.gear_ratio = options_.gear_ratio;
    linear.coupling = options_.coupling;
    const MatrixX joints = all.motors.angles(problem_.joints());
    for (Index j = 0; j < joints.cols(); ++j)
      linear.linear_ranges.push_back({joints.col(j).minCoeff(), joints.col(j).maxCoeff()});
    const bool periodic = all.size() > elastic.size(), geared = periodic && (linear.gear_ratio || linear.coupling);
    const auto add_joint_functions = [&] {
      const bool harmonics = geared ? add_functions(all, linear) : periodic && model_.add(Block::jointwise, all);
      if (!harmonics) return false;
      model_.steps(2);
      estimate.fallback_error = model_.blocks.back().without;
      model_.size_by_evidence(link_unknowns(problem_.arm));  // less is left than when their priors were chosen
      model_.learn_spectrum(6);
      linear.transmission = all.transmission;
      if (geared && !problem_.arm.terms().gear_ratio && !problem_.arm.terms().coupling &&
          model_.add(Block::gears, linear))
        model_.learn_spectrum(4);
      return true;
    };
    bool harmonics = add_joint_functions();
    const auto geared_already = [&] { return problem_.arm.terms().gear_ratio || problem_.arm.terms().coupling; };
    const bool bent = add_straightness();  // beside the functions, which look like a bend where they are missing
    if (bent && periodic && !harmonics && !geared_already()) {  // and the other way round
      std::erase_if(model_.blocks,
                    [](const BlockChoice& one) { return one.block == Block::jointwise || one.block == Block::gears; });
      all.straightness = linear.straightness = problem_.arm.terms().straightness;
      harmonics = add_joint_functions();
    }
    const bool jointwise = bent || harmonics || geared_already();
    if (jointwise) {
      if (elastic.gravity) {  // deflection is clearer once all else is modelled
        JointTerms deflecting = problem_.arm.terms();
        deflecting.gravity = elastic.gravity;
        deflecting.payload = elastic.payload;
        if (model_.gravity().empty())
          model_.add(Block::elastic_again, deflecting);
        else
          model_.choose_by_evidence(Block::elastic_again, model_.gravity());
      }
      model_.size_by_evidence(link_unknowns(problem_.arm));
      model_.solve();
      if (search && harmonics) {
        tune(search);
        model_.solve();
      }
    }
    out.stages.push_back({Stage::jointwise, jointwise, arms()});

    JointTerms approached = problem_.arm.terms();
    const bool hysteresis =
        add_to(approached, JointTermBlock::Kind::hysteresis, down) && model_.add(Block::approach, approached);
    if (hysteresis) model_.steps(2);
    std::vector<FittedArm> without_tilt = arms();
    JointTerms tilted = problem_.arm.terms();
    const bool tilt = add_to(tilted, JointTermBlock::Kind::tilt, down) && model_.add(Block::tilt, tilted);
    if (tilt) {
      if (!harmonics) estimate.fallback_error = model_.blocks.back().without;
      model_.steps(2);
      model_.size_by_evidence(model_.gravity());  // the third axis, that of the joint
      model_.solve();
    }
    bool thermal = options_.temperature && add_temperature(model_, options_.thermal_prior_std);
    if (thermal) {
      const auto temperatures = problem_.temperatures();
      out.temperatures = temperatures.range;
      estimate.mean_temperature = temperatures.mean;
      estimate.temperature_std = temperatures.std;
    }
    const bool inherited = options_.prior != nullptr && inherit(out);
    if (inherited) thermal = problem_.arm.thermal_rates(0).size() > 0;
    if (options_.drift) add_drift(model_);
    if (harmonics && !search && !inherited) {  // with the weights that outliers have by now
      model_.learn_spectrum(4);
      model_.steps(1);
    }
    if (harmonics && options_.find_lines && !inherited) find_lines(model_);
    if (options_.compliance && payloads && !payloads->vary && !inherited) leave_payload_open(payloads->mean, down);
    model_.solve();
    out.estimate.drift = problem_.drift;
    const std::vector<FittedArm> fitted = arms();
    const auto add = [&](Stage stage, bool included, const std::vector<FittedArm>& with, bool last = true) {
      out.stages.push_back({stage, included, with, last});
    };
    const bool later = hysteresis || tilt || thermal || inherited;
    const bool geometry_alone = !later && !jointwise && problem_.arm.terms().size() == 0;
    if (inherited) {
      add(Stage::prior, true, fitted);
    } else if (later) {
      if (hysteresis || !tilt) add(Stage::approach, hysteresis, tilt ? without_tilt : fitted, !tilt);
      if (tilt) add(Stage::tilt, true, fitted);
      if (thermal) add(Stage::temperature, true, fitted);
    } else {  // what is deployed is a stage of before: drift and lines are taken off it, too
      for (StagedArms& staged : out.stages) {
        const Stage replaced = jointwise ? Stage::jointwise : geometry_alone ? Stage::geometry : Stage::elastic;
        if (staged.stage == replaced || staged.stage == Stage::jointwise) staged.arms = fitted;
      }
      out.stages.back().last = true;
    }
    if (!problem_.drift.empty()) add(Stage::session, true, fitted);
    out.joints = problem_.joints();
    for (int s = 0; thermal && s < problem_.arm.stations(); ++s)
      out.thermal_rates.push_back(problem_.arm.thermal_rates(s));
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
    if (geometry_alone) estimate.geometry_left_out_errors = estimate.left_out_errors;
    if (inherited) {  // for the next to start from
      VectorX precisions = problem_.arm.precisions();
      for (Index k = 0, first = precisions.size() - expected_.size(); k < expected_.size(); ++k)
        precisions(first + k) = expected_(k);
      estimate.arm.set_precisions(precisions);
    }
    return out;
  }

 private:
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
  VERNIER_LOCAL void leave_payload_open(const Payload& reference, const Vector3& down) {
    JointTerms terms = problem_.arm.terms();
    terms.payload.emplace(input_.nominal, down, reference);
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
  VERNIER_LOCAL bool add_functions(const JointTerms& periodic, JointTerms linear) {
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
  VERNIER_LOCAL bool inherit(ErrorModelOutput& out) {
    const ArmPrior& prior = *options_.prior;
    demand(prior.nominal.joints() == input_.nominal.joints() && prior.nominal.modified() == input_.nominal.modified(),
           "fit_error_model: the earlier calibration is of an arm of ", prior.nominal.joints(), " joints in the ",
           prior.nominal.modified() ? "modified" : "standard", " convention");
    ErrorModelEstimate& estimate = out.estimate;
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
      out.temperatures = problem_.temperatures().std > 0
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
  VectorX expected_{};           // precisions of the joint errors by an earlier calibration that is used
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
