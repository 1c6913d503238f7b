#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_model/detail/periodogram.hpp"
#include "vernier/error_model/detail/prior_transfer.hpp"
#include "vernier/error_model/detail/visit_noise.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/error_model/joint_spectrum.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/evidence.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// The identified arm in every station's own base; that of distances has its origin at their fixed point, that of a
/// contact is the frame of its object.
VERNIER_API std::vector<ArmGeometry> starting_arms(const ErrorModelInput& input) {
  for (const Station& data : input.poses) require(data.size() >= 1, "fit_error_model: a station without poses");
  for (const Station& data : input.distances) require(data.size() >= 1, "fit_error_model: a station without distances");
  if (input.poses.size() + input.distances.size() + input.contacts.size() == 1) return {input.identified};
  const ArmGeometry unregistered = input.identified.with_frames({}, input.identified.tool());
  std::vector<ArmGeometry> out;
  for (const Station& data : input.poses)
    out.push_back(input.identified.with_frames(
        FrameParameters(register_points(unregistered.positions(data.joints()), *data.positions)),
        input.identified.tool()));
  for (const Station& data : input.distances) {
    const Vector3 fixed = trilaterate(unregistered.positions(data.joints()), *data.lengths);
    const Isometry3 base = rigid_motion(Matrix3::Identity(), -fixed);
    out.push_back(input.identified.with_frames(FrameParameters(base), input.identified.tool()));
  }
  for (const Contact& contact : input.contacts) {
    Station station = station_of(contact, {});
    out.push_back(contact_arm(input.identified, contact, station));
    require_spread(out.back(), contact);
  }
  return out;
}

/// What is estimated: what the identification estimated, frames once a station.
VERNIER_API std::vector<GeometricUnknown> geometric_unknowns(const ErrorModelInput& input,
                                                             const ErrorModelOptions& options) {
  const std::size_t of_poses = input.poses.size(), of_objects = of_poses + input.distances.size(),
                    stations = of_objects + input.contacts.size();
  const Index chain_end = 6 + 5 * input.identified.joints();
  std::vector<GeometricUnknown> out;
  for (const Index k : input.identification.free) {
    const ParameterEstimate& p = input.identification.parameters[static_cast<std::size_t>(k)];
    const bool of_chain = k >= 6 && k < chain_end;
    // thirty expected sizes do not affect what is determined
    const double deviation = std::isfinite(p.prior_std) ? p.prior_std / p.scale : 30;
    const double precision = of_chain ? 1 / (deviation * deviation) : 0;
    const bool own = stations > 1 && (k < 6 || (options.tool_per_station && k >= chain_end));  // a base, or a tool
    if (!own) {
      out.push_back({k, -1, p.scale, precision});
      continue;
    }
    const auto last = k < 6 ? of_poses : stations;
    for (std::size_t s = 0; s < last; ++s) out.push_back({k, static_cast<int>(s), p.scale, precision});
  }
  // a fixed point has a position, but no orientation
  const auto add = [&](std::size_t s, Index k) {
    out.push_back({k, static_cast<int>(s), input.identification.parameters[static_cast<std::size_t>(k)].scale, 0});
  };
  for (std::size_t s = of_poses; s < of_objects && stations > 1; ++s)
    for (Index k = 0; k < 3; ++k) add(s, k);
  for (std::size_t s = of_objects; s < stations; ++s)
    for (const Index k : contact_unknowns(input.contacts[s - of_objects])) add(s, k);
  return out;
}

VERNIER_API std::vector<Station> joined_stations(const ErrorModelInput& input, const SensorModel& sensors) {
  std::vector<Station> out = input.poses;
  out.insert(out.end(), input.distances.begin(), input.distances.end());
  for (const Contact& contact : input.contacts) {
    out.push_back(station_of(contact, sensors));
    static_cast<void>(contact_arm(input.identified, contact, out.back()));  // which way its heights count
  }
  return out;
}

/// Adds the time of its life to a sum [s].
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count(); }

 private:
  double& sum_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

/// The steps of `fit_error_model`.
class ErrorModelFit {
 public:
  VERNIER_API ErrorModelFit(const ErrorModelInput& input, const ErrorModelOptions& options, const SensorModel& sensors)
      : input_(input),
        options_(options),
        spectra_(spectra_of(options, input.nominal.joints())),
        problem_(ArmParameterisation(starting_arms(input), geometric_unknowns(input, options)),
                 joined_stations(input, sensors), sensors.loss),
        stride_(std::max<Index>(1, problem_.num_validation_blocks() / options.num_validation_poses)) {
    problem_.executor = options.executor;
  }

  VERNIER_API ErrorModelOutput run(PriorSearch search) {
    ErrorModelOutput out{.estimate = {.arm = problem_.arm}};
    ErrorModelEstimate& estimate = out.estimate;
    estimate.converged = true;
    solve(estimate);
    out.geometry = arms();
    if (!input_.poses.empty())
      estimate.geometry_left_out_errors = error_norms(left_out(linearised(), problem_.arm.precisions()).errors);

    JointTerms elastic(input_.nominal.joints());
    if (options_.compliance) elastic.gravity.emplace(input_.nominal, options_.down);
    if (elastic.size() > 0 && add(estimate, "elastic", elastic, false)) solve(estimate);
    out.elastic = arms();

    JointTerms all = elastic;
    for (int j = 0; j < all.joints; ++j)
      if (input_.nominal.revolute(j))
        all.transmission[static_cast<std::size_t>(j)] =
            orders_of_joint(options_, spectra_, static_cast<std::size_t>(j), problem_.num_blocks());
    out.jointwise = all.size() > elastic.size() && add(estimate, "jointwise", all, true);
    if (out.jointwise) {
      steps(2);
      estimate.fallback_error = estimate.blocks.back().without;
      learn_spectrum(estimate, 6);
      // linear in the joints, so beyond the measured ranges they stay as at their ends
      all.gear_ratio = options_.gear_ratio;
      all.coupling = options_.coupling;
      all.linear_ranges.clear();
      const MatrixX joints = problem_.joints();
      for (Index j = 0; j < joints.cols(); ++j)
        all.linear_ranges.push_back({joints.col(j).minCoeff(), joints.col(j).maxCoeff()});
      if ((all.gear_ratio || all.coupling) && add(estimate, "gears", all, true)) learn_spectrum(estimate, 4);
      if (elastic.size() > 0)  // deflection is clearer once all else is modelled
        estimate.blocks.push_back(choose_by_evidence("elastic_with_jointwise", gravity()));
      solve(estimate);
      if (search) {
        tune(estimate, search);
        solve(estimate);
      }
    }
    out.without_approach = arms();

    JointTerms approached = problem_.arm.terms();
    approached.hysteresis = hysteresis_widths();
    const bool hysteresis = options_.hysteresis && add(estimate, "approach", approached, true);
    if (hysteresis) steps(2);
    std::vector<FittedArm> without_tilt = arms();
    JointTerms tilted = problem_.arm.terms();
    if (options_.tilt) tilted.tilt.emplace(input_.nominal, options_.down);
    const bool tilt = options_.tilt && add(estimate, "tilt", tilted, true);
    if (tilt) {
      out.without_tilt = std::move(without_tilt);
      if (!out.jointwise) estimate.fallback_error = estimate.blocks.back().without;
      steps(2);
      size_by_evidence(gravity());  // the third axis, that of the joint
      solve(estimate);
    }
    bool thermal = options_.temperature && add_temperature(estimate);
    if (thermal) out.temperatures = problem_.temperatures().range;
    const bool inherited = options_.prior != nullptr && inherit(out);
    if (inherited) thermal = problem_.arm.thermal_rates(0).size() > 0;
    const bool drift = options_.drift && add_drift(estimate);
    if ((hysteresis || tilt || thermal || drift) && out.jointwise && !search && !inherited) {
      learn_spectrum(estimate, 4);
      steps(1);
    }
    if (out.jointwise && options_.find_lines && !inherited) find_lines(estimate);
    solve(estimate);
    out.estimate.drift = problem_.drift;
    for (SessionDrift& of_station : out.estimate.drift)
      if (!of_station.empty()) of_station.step_variance = problem_.drift_step_variance();
    out.all = arms();
    // a stage without hysteresis is what is deployed: drift and lines are taken off it, too
    const bool later = hysteresis || tilt || thermal || inherited;
    const bool geometry_alone = !later && !out.jointwise && problem_.arm.terms().size() == 0;
    if (!later) out.without_approach = out.all;
    if (!later && !out.jointwise) (geometry_alone ? out.geometry : out.elastic) = out.all;
    out.joints = problem_.joints();
    for (int s = 0; thermal && s < problem_.arm.stations(); ++s)
      out.thermal_rates.push_back(problem_.arm.thermal_rates(s));
    estimate.drives = options_.drives;
    estimate.arm = problem_.arm;
    assess(estimate);
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
  static constexpr Index many_poses =
      500;  ///< from here on bands of orders are sized apart, and errors suffice to decide

  VERNIER_API std::vector<FittedArm> arms() const {
    std::vector<FittedArm> out;
    for (int s = 0; s < problem_.arm.stations(); ++s)
      out.push_back({problem_.arm.geometry(s), problem_.arm.joint_errors()});
    return out;
  }

  /// Expected sizes of the coefficients of some terms.
  VERNIER_API VectorX prior_stds(const JointTerms& terms) const { return expected_sizes(terms, options_, spectra_); }

  /// Precisions of terms, those that were there before as they were, others 1.
  VERNIER_API static VectorX carried_over(const JointTerms& terms, const JointTerms& before,
                                          const VectorX& precisions) {
    VectorX out = VectorX::Ones(terms.size());
    visit_common_terms(before, terms, [&](Index old, Index now) { out(now) = precisions(old); });
    return out;
  }

  /// Replaces the terms by more, if leave-one-pose-out errors support the additional ones.
  /// @return whether they do
  VERNIER_API bool add(ErrorModelEstimate& estimate, const char* name, const JointTerms& terms, bool by_evidence) {
    const ArmParameterisation before = problem_.arm;
    const VectorX old_precisions = before.precisions().tail(before.terms().size());
    Index first = terms.size(), count = 0;  // of the additional coefficients, which are contiguous
    for (const JointTermBlock& now : terms.blocks()) {
      bool known = false;
      for (const JointTermBlock& old : before.terms().blocks())
        known = known || (old.kind == now.kind && old.joint == now.joint);
      if (known) continue;
      first = std::min(first, now.begin);
      count += now.count;
    }
    problem_.arm.set_terms(terms, prior_stds(terms), carried_over(terms, before.terms(), old_precisions));
    linearised_.reset();
    estimate.blocks.push_back(by_evidence ? choose_by_evidence(name, unknowns(first, count))
                                          : choose(name, first, count));
    if (estimate.blocks.back().used) return true;
    problem_.arm = before;
    linearised_.reset();
    return false;
  }

  /// Chooses the prior of coefficients first .. first + count - 1 by leave-one-pose-out errors.
  VERNIER_API BlockChoice choose(const char* name, Index first, Index count) {
    VectorX precisions = problem_.arm.precisions();
    const Index at = static_cast<Index>(problem_.arm.geometric().size()) + first;
    const Linearised& now = linearised();
    const Stopwatch watch(leave_one_out_seconds_);
    const PriorChoice choice = choose_prior(now.system, now.normal, precisions, now.steps, at, count, stride_);
    for (Index k = at; k < at + count; ++k) precisions(k) = choice.precision;
    problem_.arm.set_precisions(precisions);
    const bool used = choice.precision < suppressing_precision;
    return {name, choice.suppressed_error, used ? choice.chosen_error : choice.smallest_error, used, choice.precision};
  }

  /// Unknowns of coefficients first .. first + count - 1.
  VERNIER_API UnknownGroup unknowns(Index first, Index count) const {
    UnknownGroup out;
    const Index at = static_cast<Index>(problem_.arm.geometric().size()) + first;
    for (Index k = 0; k < count; ++k) out.push_back(at + k);
    return out;
  }

  /// Unknowns of the transmissions, of orders first .. last.
  VERNIER_API UnknownGroup harmonics(int first, int last) const {
    UnknownGroup out;
    const Index geometric = static_cast<Index>(problem_.arm.geometric().size());
    for (const JointTermBlock& block : problem_.arm.terms().blocks())
      for (Index k = 0; block.joint >= 0 && k < block.count; ++k) {
        const int order = problem_.arm.terms().transmission[static_cast<std::size_t>(block.joint)].order(k);
        if (order >= first && order <= last) out.push_back(geometric + block.begin + k);
      }
    return out;
  }

  /// Unknowns of gravity compliance.
  VERNIER_API UnknownGroup gravity() const {
    for (const JointTermBlock& block : problem_.arm.terms().blocks())
      if (block.kind == JointTermBlock::Kind::gravity) return unknowns(block.begin, block.count);
    return {};
  }

  /// The problem, linearised at its present values.
  struct Linearised {
    BlockSystem system;
    NormalEquations normal;
    VectorX steps, local_steps;
  };
  /// Computed again only after the unknowns or their values have changed.
  VERNIER_API const Linearised& linearised() const {
    if (!linearised_)
      linearised_.emplace(
          Linearised{problem_.system(), problem_.normal_equations(), problem_.arm.steps(), problem_.drift_steps()});
    return *linearised_;
  }

  /// Solves the problem as it is.
  VERNIER_API void solve(ErrorModelEstimate& estimate) {
    estimate.converged = problem_.solve() && estimate.converged;
    linearised_.reset();
  }
  /// Steps towards the solution: enough where the unknowns change again soon.
  VERNIER_API void steps(int count) {
    problem_.solve(count);
    linearised_.reset();
  }

  /// Poses left out one at a time, under some priors.
  VERNIER_API LeftOutBlocks left_out(const Linearised& at, const VectorX& precisions) const {
    const Stopwatch watch(leave_one_out_seconds_);
    return leave_one_out(at.system, FactorisedEquations(at.normal, precisions, at.steps, at.local_steps), stride_);
  }

  /// Their mean position error as the problem is [m].
  VERNIER_API double left_out_error() const {
    return error_norms(left_out(linearised(), problem_.arm.precisions()).errors).mean();
  }

  /// A block of unknowns, by the errors with it and without; of few poses also by log predictive densities.
  VERNIER_API BlockChoice choice_between(const char* name, const LeftOutBlocks& with, const LeftOutBlocks& without,
                                         double precision) const {
    const bool few = problem_.num_validation_blocks() < many_poses;
    const bool by_errors = errors_support(with, without);
    const bool by_densities = !by_errors && few && densities_support(with, without);
    const bool used = by_errors || by_densities;
    return {name,
            error_norms(without.errors).mean(),
            error_norms(with.errors).mean(),
            used,
            used ? precision : suppressing_precision,
            by_densities ? with.log_densities.mean() - without.log_densities.mean() : 0};
  }

  /// Sizes of some coefficients by evidence, and their inclusion by leave-one-pose-out errors.
  VERNIER_API BlockChoice choose_by_evidence(const char* name, const UnknownGroup& group) {
    const Linearised& at = linearised();
    const VectorX before = problem_.arm.precisions();
    const VectorX sized = scale_priors(at.normal, before, at.steps, problem_.measured_values(), group, at.local_steps);
    VectorX suppressed = sized;
    for (const Index k : group) suppressed(k) = suppressing_precision;
    const BlockChoice choice =
        choice_between(name, left_out(at, sized), left_out(at, suppressed), sized(group.front()));
    problem_.arm.set_precisions(choice.used ? sized : suppressed);
    return choice;
  }

  /// Sizes of some coefficients by evidence, unless they are suppressed.
  VERNIER_API void size_by_evidence(const UnknownGroup& group) {
    if (group.empty() || problem_.arm.precisions()(group.front()) >= suppressing_precision) return;
    const Linearised& at = linearised();
    problem_.arm.set_precisions(scale_priors(at.normal, problem_.arm.precisions(), at.steps, problem_.measured_values(),
                                             group, at.local_steps));
  }

  /// Sizes of the harmonics by evidence, at the solution: one common factor on the expected sizes; one for every band
  /// where there are poses enough, or where evidence speaks clearly against the expected spectrum.
  VERNIER_API void learn_spectrum(ErrorModelEstimate& estimate, int iterations) {
    const Linearised& at = linearised();
    const Index values = problem_.measured_values();
    std::vector<int> edges{1};
    for (const HarmonicSpectrum& spectrum : spectra_)
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
    VectorX precisions = problem_.arm.precisions();
    constexpr double clearly = 10;
    if (at.system.validation_blocks < many_poses)
      precisions = scale_priors(at.normal, precisions, at.steps, values, harmonics(1, std::numeric_limits<int>::max()),
                                at.local_steps);
    const VectorX learned = learn_priors(at.normal, precisions, at.steps, values, bands, iterations, at.local_steps);
    if (at.system.validation_blocks >= many_poses || evidence(learned) > evidence(precisions) + clearly)
      precisions = learned;
    problem_.arm.set_precisions(precisions);
    for (BlockChoice& block : estimate.blocks)
      if (block.name == "jointwise") block.precision = precisions(bands.front().front());
  }

  /// Lets the geometry change with temperature, if leave-one-pose-out errors support that.
  VERNIER_API bool add_temperature(ErrorModelEstimate& estimate) {
    const double mean = problem_.temperatures().mean, std = problem_.temperatures().std;
    if (!(std > 0.02)) return false;  // not measured, or it did not vary
    const ArmParameterisation before = problem_.arm;
    std::vector<GeometricUnknown> unknowns = before.geometric();
    UnknownGroup added;
    for (const GeometricUnknown& u : before.geometric()) {
      added.push_back(static_cast<Index>(unknowns.size()));
      unknowns.push_back({u.parameter, u.station, options_.thermal_prior_std, 1, true});
    }
    problem_.reference_temperature = mean;
    problem_.arm.set_geometric(std::move(unknowns));
    linearised_.reset();
    estimate.blocks.push_back(choose_by_evidence("temperature", added));
    if (!estimate.blocks.back().used) {
      problem_.arm = before;
      linearised_.reset();
      return false;
    }
    estimate.mean_temperature = mean;
    estimate.temperature_std = std;
    steps(1);
    return true;
  }

  /// Fits again with what an earlier calibration knows as the prior, and keeps that where left-out poses are predicted
  /// better.
  VERNIER_API bool inherit(ErrorModelOutput& out) {
    const ArmPrior& prior = *options_.prior;
    require(prior.nominal.joints() == input_.nominal.joints() && prior.nominal.modified() == input_.nominal.modified(),
            "fit_error_model: the earlier calibration is of an arm of ", prior.nominal.joints(), " joints in the ",
            prior.nominal.modified() ? "modified" : "standard", " convention");
    ErrorModelEstimate& estimate = out.estimate;
    const CalibrationProblem without = problem_;
    const double error_without = left_out_error();

    const ErrorModelEstimate& before = prior.estimate;
    const JointTerms& terms = before.arm.terms();
    problem_.arm =
        ArmParameterisation(starting_arms(input_), with_unknowns_of(prior, geometric_unknowns(input_, options_)));
    problem_.arm.set_terms(terms, before.arm.scales().tail(terms.size()), VectorX::Zero(terms.size()));
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
    linearised_.reset();
    PriorTransfer transfer = likely_transfer(problem_, known);
    problem_.prior = known.prior(problem_.arm.size(), transfer.geometry, transfer.joints);
    converged = problem_.solve() && converged;
    linearised_.reset();

    const double error_with = left_out_error();
    transfer.name = prior.name;
    constexpr double unrelated = 0.6;  // of errors that have nothing to do with each other it would be above 1
    const bool holds = std::min(transfer.geometry, transfer.joints) < unrelated;
    transfer.used = converged && holds && error_with < error_without;
    estimate.prior = transfer;
    estimate.blocks.push_back(
        {"prior", error_without, error_with, transfer.used, 1 / (transfer.joints * transfer.joints)});
    if (!transfer.used) {
      problem_ = without;
      linearised_.reset();
      return false;
    }
    estimate.converged = true;
    if (estimate.fallback_error == 0) estimate.fallback_error = error_without;
    expected_ = before.arm.precisions().tail(terms.size());
    if (before.temperature_std > 0) {
      const double measured_mean = estimate.mean_temperature;
      out.temperatures = estimate.temperature_std > 0 && measured_mean != 0
                             ? std::array{std::min(out.temperatures[0], prior.temperatures[0]),
                                          std::max(out.temperatures[1], prior.temperatures[1])}
                             : prior.temperatures;
      estimate.mean_temperature = before.mean_temperature;
      estimate.temperature_std = before.temperature_std;
    } else {
      estimate.mean_temperature = estimate.temperature_std = 0;
    }
    return true;
  }

  /// Adds orders that stand out of what the model leaves, if leave-one-pose-out errors support them.
  VERNIER_API bool find_lines(ErrorModelEstimate& estimate) {
    constexpr Index enough = 400;
    constexpr int highest = 2500;
    constexpr double expected = 7e-6;
    if (problem_.num_blocks() < enough) return false;
    const std::vector<std::vector<int>> found = lines_beyond(highest);
    JointTerms terms = problem_.arm.terms();
    const JointTerms before = terms;
    bool any = false;
    for (std::size_t j = 0; j < found.size(); ++j)
      for (const int order : found[j]) {
        auto& orders = terms.transmission[j].orders;
        orders.insert(std::lower_bound(orders.begin(), orders.end(), order), order);
        spectra_[j].push_back({order, order, expected});
        any = true;
      }
    if (!any) return false;
    const ArmParameterisation without = problem_.arm;
    problem_.arm.set_terms(terms, prior_stds(terms),
                           carried_over(terms, without.terms(), without.precisions().tail(before.size())));
    linearised_.reset();
    UnknownGroup added;
    const Index geometric = static_cast<Index>(problem_.arm.geometric().size());
    for (std::size_t j = 0; j < found.size(); ++j)
      for (Index k = 0; k < terms.transmission[j].size(); ++k) {
        const int order = terms.transmission[j].order(k);
        if (std::find(found[j].begin(), found[j].end(), order) != found[j].end())
          added.push_back(geometric + terms.transmission_begin(static_cast<int>(j)) + k);
      }
    estimate.blocks.push_back(choose_by_evidence("lines", added));
    if (estimate.blocks.back().used) return true;
    problem_.arm = without;
    linearised_.reset();
    return false;
  }

  /// Orders of each joint that are not in the model and stand out of what it leaves.
  VERNIER_API std::vector<std::vector<int>> lines_beyond(int highest) const {
    const Linearised& at = linearised();
    const JointTerms& terms = problem_.arm.terms();
    const VectorX precisions = problem_.arm.precisions();
    const FactorisedEquations solved(at.normal, precisions, at.steps, at.local_steps);
    const double explained = static_cast<double>(precisions.size()) - solved.inverse_diagonal().dot(precisions);
    const double values = static_cast<double>(problem_.measured_values());
    const double variance = at.normal.cost / std::max(1.0, values - explained);
    const Index joints = terms.joints;
    MatrixX score = MatrixX::Zero(at.system.blocks, joints), weight = score;
    visit_blocks(at.system, 0, 1, at.system.blocks, [&](Index b, const RowBlock& rows) {
      for (Index j = 0; j < rows.factor.cols(); ++j) {
        const Vector6 effect = detail::column_of(rows.factor, j);
        score(b, j) = effect.dot(rows.residual);
        weight(b, j) = effect.squaredNorm();
      }
    });
    const MatrixX angles = problem_.joints();
    const double threshold = line_threshold(joints * highest);
    std::vector<std::vector<int>> out(static_cast<std::size_t>(joints));
    for (Index j = 0; j < joints; ++j) {
      const std::vector<int>& known = terms.transmission[static_cast<std::size_t>(j)].orders;
      if (known.empty() || !tells_orders_apart(angles.col(j), weight.col(j), highest)) continue;
      out[static_cast<std::size_t>(j)] =
          lines_of_residuals(angles.col(j), score.col(j), weight.col(j), known, highest, variance * threshold);
    }
    return out;
  }

  /// Chooses the precisions of random walks, of unknowns first .. end - 1 of each state: their factor by evidence, in
  /// steps of four from 1 down to `lowest` or up to 64, and whether there is such a drift by leave-one-pose-out errors.
  VERNIER_API BlockChoice choose_drift(const char* name, Index first, Index end, double lowest) const {
    Linearised at = linearised();  // the precisions of the random walks are all that changes
    SparseSymmetric& prior = at.normal.local_prior;
    const std::vector<double> expected = prior.values;
    const VectorX precisions = problem_.arm.precisions();
    const auto scale = [&](double factor) {
      for (std::size_t k = 0; k < expected.size(); ++k) {
        const Index unknown = prior.rows[k] % at.system.local_size;
        prior.values[k] = expected[k] * (unknown >= first && unknown < end ? factor : 1);
      }
    };
    const auto evidence = [&](double factor) {
      scale(factor);
      return log_evidence(at.normal, FactorisedEquations(at.normal, precisions, at.steps, at.local_steps), precisions,
                          at.steps, problem_.measured_values(), at.local_steps);
    };
    double best = 1, most = evidence(1);
    for (const double step : {4.0, 0.25})
      for (double factor = step; best == factor / step && factor >= lowest && factor <= 64; factor *= step) {
        const double reached = evidence(factor);
        if (!(reached > most)) break;
        most = reached;
        best = factor;
      }
    scale(suppressing_precision);
    const LeftOutBlocks without = left_out(at, precisions);
    scale(best);
    return choice_between(name, left_out(at, precisions), without, best);
  }

  /// Lets the bases drift, if leave-one-pose-out errors support that.
  VERNIER_API bool add_drift(ErrorModelEstimate& estimate) {
    problem_.start_drift(40);
    problem_.drift_precision = 1;
    if (problem_.system().local_states == 0) {
      problem_.stop_drift();
      return false;
    }
    linearised_.reset();
    const BlockChoice choice = choose_drift("drift", 0, 6, 0.0625);
    estimate.blocks.push_back(choice);
    problem_.drift_precision = choice.precision;
    if (choice.used)
      steps(1);
    else
      problem_.stop_drift();
    linearised_.reset();
    if (choice.used) add_joint_drift(estimate);
    return choice.used;
  }

  /// Lets the joints' zeros drift beside the bases, if leave-one-pose-out errors support that.
  VERNIER_API void add_joint_drift(ErrorModelEstimate& estimate) {
    problem_.start_joint_drift();
    problem_.joint_drift_precision = 1;
    linearised_.reset();
    const BlockChoice choice = choose_drift("joint_drift", 6, 6 + problem_.arm.geometry(0).joints(), 0.25);
    estimate.blocks.push_back(choice);
    problem_.joint_drift_precision = choice.precision;
    if (choice.used)
      steps(1);
    else
      problem_.stop_joint_drift();
    linearised_.reset();
  }

  /// Priors of the joint errors by a search over leave-one-pose-out errors; kept where those are smaller than before.
  VERNIER_API void tune(ErrorModelEstimate& estimate, PriorSearch search) {
    VectorX amplitudes(problem_.arm.size() - problem_.arm.num_dense());
    const Index dense_terms = problem_.arm.terms().num_dense_terms();
    for (const JointTermBlock& block : problem_.arm.terms().blocks())
      for (Index k = 0; block.joint >= 0 && k < block.count; ++k)
        amplitudes(block.begin - dense_terms + k) =
            problem_.arm.scales()(problem_.arm.num_dense() + block.begin - dense_terms + k) /
            problem_.arm.scales()(problem_.arm.num_dense() + block.begin - dense_terms);
    const Linearised& at = linearised();
    const VectorX before = problem_.arm.precisions();
    const PriorObjective objective(at.system, at.normal, before, at.steps, dense_terms, amplitudes, stride_);
    const VectorX after = objective.precisions(search(objective, objective.box()));
    const double without = objective.error(before), with = objective.error(after);
    estimate.blocks.push_back({"tuned_priors", without, with, with < without, 1});
    problem_.arm.set_precisions(with < without ? after : before);
  }

  /// The first block of a block's station.
  VERNIER_API Index first_block(Index block) const {
    Index first = 0;
    for (int s = 0; s < problem_.station_index(block); ++s)
      first += (static_cast<std::size_t>(s) < input_.poses.size()
                    ? input_.poses[static_cast<std::size_t>(s)]
                    : input_.distances[static_cast<std::size_t>(s) - input_.poses.size()])
                   .size();
    return first;
  }

  /// Covariance of the unknowns, and the noise of a visit.
  VERNIER_API void assess(ErrorModelEstimate& estimate) const {
    const Linearised& at = linearised();
    const auto& system = at.system;  // lambdas of clang 14 cannot capture bindings
    const VectorX precisions = problem_.arm.precisions();
    const FactorisedEquations solved(at.normal, precisions, at.steps, at.local_steps);
    const Index p = system.unknowns();
    estimate.covariance = solved.inverse();
    double explained = static_cast<double>(p) - diagonal_of(estimate.covariance).dot(precisions);
    for (Index k = 0; k < at.normal.prior.cols(); ++k)
      explained -= estimate.covariance.col(k).dot(at.normal.prior.col(k));
    const double values = static_cast<double>(problem_.measured_values());
    const double freedom = std::max(1.0, values - explained);
    estimate.residual_variance = estimate.variance_factor = at.normal.cost / freedom;
    estimate.covariance *= estimate.variance_factor;

    // leave-one-pose-out errors contain the noise of a visit and the uncertainty of the unknowns
    constexpr Index batch = 64;  // poses whose rows are multiplied by the covariance at once
    Rows6 all(6, p);
    MatrixX stack(p, 3 * batch);  // the rows of each pose are contiguous columns
    Index stacked = 0;
    double rotation_sum = 0, rotation_values = 0, distance_sum = 0;
    std::vector<LeftOutVisit> visits;
    Eigen::Matrix3Xd errors;
    {
      const Stopwatch watch(leave_one_out_seconds_);
      errors = leave_one_out_errors(system, solved, stride_);
    }
    estimate.leave_one_out_seconds = leave_one_out_seconds_;
    const auto flush = [&] {
      const MatrixX half = matrix_product(estimate.covariance, stack.leftCols(3 * stacked));
      for (Index i = 0; i < stacked; ++i) {
        Matrix3& model = visits[visits.size() - static_cast<std::size_t>(stacked - i)].model;
        for (Index c = 0; c < 3; ++c)
          for (Index r = 0; r < 3; ++r) model(r, c) = stack.col(3 * i + r).dot(half.col(3 * i + c));
      }
      stacked = 0;
    };
    visit_blocks(system, 0, 1, system.blocks, [&](Index b, const RowBlock& rows) {
      const Station& station = problem_.station_of(b);
      if (station.oriented()) {
        const Vector6 residual = rows.unwhiten * rows.residual;
        const Vector3 rotation(residual(3), residual(4), residual(5));
        rotation_sum += rotation.squaredNorm() * station.orientation_sigma * station.orientation_sigma;
        rotation_values += 3;
      }
      if (b % stride_ != 0 || b >= system.validation_blocks) return;
      Vector3 error(errors(0, b / stride_), errors(1, b / stride_), errors(2, b / stride_));
      if (station.lengths == nullptr) {  // what is deployed does not know the drift
        const Isometry3 drift = problem_.drift_motion(b);
        const Vector3 measured = station.position(b - first_block(b));
        error += measured - transformed(drift, measured);
      }
      if (station.lengths != nullptr) {
        distance_sum += error.squaredNorm();
        return;
      }
      rows.expand(system.group_sizes, all);
      const auto position_change = [&](const Rows6& columns, Index k) {
        Vector3 out = Vector3::Zero();
        for (Index s = 0; s < 6; ++s)
          for (Index r = 0; r < 3; ++r) out(r) += rows.unwhiten(r, s) * columns(s, k);
        return Vector3(rows.position_sigma * out);
      };
      const VectorX zeros = problem_.drift_joint_zeros(b);
      Matrix3 joint_noise = Matrix3::Zero();
      for (Index j = 0; j < rows.factor.cols(); ++j) {
        const Vector3 joint = position_change(rows.factor, j);
        if (zeros.size() > 0) error -= zeros(j) * joint;
        for (Index c = 0; c < 3; ++c)
          for (Index r = 0; r < 3; ++r) joint_noise(r, c) += joint(r) * joint(c);
      }
      for (Index k = 0; k < p; ++k) {
        const Vector3 change = position_change(all, k);
        for (Index r = 0; r < 3; ++r) stack(k, 3 * stacked + r) = change(r);
      }
      estimate.left_out_rows.push_back(b);
      visits.push_back({error, Matrix3::Zero(), joint_noise});
      if (++stacked == batch) flush();
    });
    flush();
    if (rotation_values > 0) estimate.orientation_sigma = std::sqrt(rotation_sum / rotation_values * values / freedom);
    estimate.left_out_errors.resize(static_cast<Index>(visits.size()));
    for (std::size_t k = 0; k < visits.size(); ++k)
      estimate.left_out_errors(static_cast<Index>(k)) = visits[k].error.norm();
    if (visits.empty()) {
      estimate.position_sigma = std::sqrt(distance_sum / static_cast<double>(errors.cols()));
      return;
    }
    const VisitNoise noise = visit_noise(visits);
    estimate.position_sigma = noise.position;
    estimate.joint_sigma = noise.joint;
    estimate.covariance *= noise.model;
    estimate.variance_factor *= noise.model;
  }

  const ErrorModelInput& input_;
  const ErrorModelOptions& options_;
  std::vector<HarmonicSpectrum> spectra_;  ///< of each joint, with the lines of its drive and those that were found
  CalibrationProblem problem_;
  Index stride_;
  mutable std::optional<Linearised> linearised_{};
  VectorX expected_{};  // precisions of the joint errors by an earlier calibration that is used
  mutable double leave_one_out_seconds_ = 0;
};

VERNIER_IMPL ErrorModelOutput fit_error_model(const ErrorModelInput& input, const ErrorModelOptions& options,
                                              const SensorModel& sensors, PriorSearch search) {
  options.validate();
  sensors.validate();
  require(input.poses.size() + input.distances.size() > 0, "fit_error_model: no stations");
  require(input.contacts.empty() || !input.poses.empty(), "fit_error_model: contacts without poses");
  for (const Contact& contact : input.contacts)
    require(contact.joints().cols() == input.identified.joints(), "contact ", contact.name(), ": ",
            contact.joints().cols(), " joints, the arm has ", input.identified.joints());
  return ErrorModelFit(input, options, sensors).run(search);
}

}  // namespace vernier::detail
