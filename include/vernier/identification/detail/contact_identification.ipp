#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/detail/contact_identification.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/identifiable_parameters.hpp"
#include "vernier/least_squares/estimate_covariance.hpp"
#include "vernier/least_squares/evidence.hpp"

namespace vernier::detail {

/// Adds a row below a matrix.
inline void append_row(MatrixX& matrix, const VectorX& row) {
  matrix.conservativeResize(matrix.rows() + 1, Eigen::NoChange);
  for (Index k = 0; k < row.size(); ++k) matrix(matrix.rows() - 1, k) = row(k);
}

/// The steps of `identify_geometry_by_contacts`.
class ContactIdentification {
 public:
  VERNIER_API ContactIdentification(const ArmGeometry& nominal, std::span<const Contact> contacts,
                                    const IdentifyOptions& options, const SensorModel& sensors)
      : options_(options),
        sensors_(sensors),
        contacts_(contacts),
        plan_(nominal, options),
        nominal_(nominal),
        problem_(registered(translation(nominal.tool().isometry()))) {
    problem_.joint_columns = false;
  }

  VERNIER_API GeometryByContacts run() {
    register_objects();
    require(std::isfinite(residual_rms()), "identify_by_contacts: no places of the objects fit the touches");
    for (int c = 0; c < static_cast<int>(contacts_.size()); ++c)
      require_spread(problem_.arm.geometry(c), contacts_[static_cast<std::size_t>(c)]);
    GeometryByContacts out{nominal_, {}};
    ContactReport& report = out.report;
    report.rms_before = residual_rms();

    // What is dependent exactly at nominal may not be so at the solution.
    const std::vector<GeometricUnknown> objects = unknowns_of_objects(), arm = unknowns_of_arm();
    std::vector<GeometricUnknown> order = objects;
    order.insert(order.end(), arm.begin(), arm.end());
    Selection columns = select(order);
    for (int round = 0; round < 3; ++round) {
      estimate(columns.base, options_.priors ? 1.0 / 9 : 0);
      solve();
      order = columns.base;
      for (const auto& [unknown, absorbed_by] : columns.dependent) order.push_back(unknown);
      Selection again = select(order);
      if (again.base.size() <= columns.base.size()) break;
      columns = std::move(again);
    }
    estimate(columns.base, options_.priors ? 1.0 / 9 : 0);
    for (int round = 0; round < 3 && options_.priors; ++round) {
      solve();
      size_priors();
    }
    solve();

    const ArmGeometry& found = problem_.arm.geometry(0);
    out.arm = found.with_frames(nominal_.base(), found.tool());
    describe(report, out.arm, columns);
    return out;
  }

 private:
  /// Independent unknowns, and what absorbs the others.
  struct Selection {
    std::vector<GeometricUnknown> base;
    std::vector<std::pair<GeometricUnknown, std::vector<GeometricUnknown>>> dependent;
  };

  static constexpr double tool_precision = 1e-2;  // 0.1 m, so that it stays finite where little was touched
  Index chain_end() const { return plan_.chain_end; }
  const Contact& contact(int station) const { return contacts_[static_cast<std::size_t>(station)]; }

  /// Every contact in the frame of its object, by nominal links and a tool point.
  VERNIER_API CalibrationProblem registered(const Vector3& tool_point) const {
    const Isometry3& tool = nominal_.tool().isometry();
    const bool given = (tool_point - translation(tool)).norm() == 0;
    const FrameParameters of_tool = given ? nominal_.tool() : FrameParameters(rigid_motion(rotation(tool), tool_point));
    std::vector<Station> stations;
    std::vector<ArmGeometry> arms;
    for (const Contact& contact : contacts_) {
      stations.push_back(station_of(contact, sensors_));
      arms.push_back(contact_arm(nominal_.with_frames({}, of_tool), contact, stations.back()));
    }
    return CalibrationProblem(ArmParameterisation(std::move(arms), {}), std::move(stations), sensors_.loss);
  }

  /// Frames of the objects and the tool's point, links nominal: from the given tool, and where that does not fit, from
  /// points around it, for many a tool is only roughly known.
  VERNIER_API void register_objects() {
    std::vector<GeometricUnknown> unknowns = unknowns_of_objects();
    for (const GeometricUnknown& unknown : unknowns_of_arm())
      if (unknown.parameter >= chain_end()) {
        unknowns.push_back(unknown);
        unknowns.back().precision = tool_precision;
      }
    problem_.arm.set_geometric(unknowns);
    solve();
    if (!options_.tool_free() || residual_rms() < 5e-3) return;
    const Vector3 start = translation(nominal_.tool().isometry());
    for (int k = 0; k < 12; ++k) {
      Vector3 tool_point = start;
      tool_point(k / 2 % 3) += (k < 6 ? 0.1 : 0.2) * (k % 2 == 0 ? 1 : -1);
      CalibrationProblem other = registered(tool_point);
      other.arm.set_geometric(unknowns);
      std::swap(problem_, other);
      solve();
      if (!(residual_rms() < residual_rms(other))) std::swap(problem_, other);
    }
  }

  VERNIER_API std::vector<GeometricUnknown> unknowns_of_objects() const {
    std::vector<GeometricUnknown> out;
    for (int c = 0; c < static_cast<int>(contacts_.size()); ++c)
      for (const Index k : contact_unknowns(contact(c))) out.push_back({k, c, plan_.scales(k), 0});
    return out;
  }

  /// The tool's point first, so that the ends of the chain yield to it.
  VERNIER_API std::vector<GeometricUnknown> unknowns_of_arm() const {
    std::vector<GeometricUnknown> out;
    for (const bool of_chain : {false, true})
      for (const Index k : plan_.candidates)
        if (of_chain ? plan_.in_chain(k) : k >= chain_end() && k < chain_end() + 3)
          out.push_back({k, -1, plan_.scales(k), 0});
    return out;
  }

  VERNIER_API void solve() {
    if (problem_.arm.size() == 0) return;
    problem_.reset_weights();
    converged_ = problem_.solve(options_.max_iterations);
  }

  /// Names what is estimated; chain parameters have priors of some precision.
  VERNIER_API void estimate(std::vector<GeometricUnknown> unknowns, double precision) {
    for (GeometricUnknown& u : unknowns) {
      u.precision = 0;
      if (plan_.in_chain(u.parameter)) u.precision = precision;
      if (options_.priors && u.parameter >= chain_end()) u.precision = tool_precision;
    }
    problem_.arm.set_geometric(std::move(unknowns));
    problem_.prior.reset();
    if (scale_observable_) return;
    // Residuals of touches shrink with the arm, so its size has to be held: the lengths of its links, taken together.
    const VectorX scale = scale_direction(true);
    const double square = scale.squaredNorm();
    if (!(square > 0)) return;
    constexpr double share = 1e-6;
    const VectorX held = scale / (square * share);
    problem_.prior = JointPrior{matrix_product(held, held.transpose()), VectorX::Zero(problem_.arm.size()), 1};
  }

  /// The step of the unknowns that scales the arm and all objects, or the links alone.
  VERNIER_API VectorX scale_direction(bool links_alone) const {
    const auto& unknowns = problem_.arm.geometric();
    VectorX out = VectorX::Zero(static_cast<Index>(unknowns.size()));
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      const GeometricUnknown& u = unknowns[k];
      const bool of_chain = plan_.in_chain(u.parameter);
      if (plan_.kinds[static_cast<std::size_t>(u.parameter)] != ParameterKind::length || (links_alone && !of_chain))
        continue;
      out(static_cast<Index>(k)) =
          (links_alone ? nominal_ : problem_.arm.geometry(std::max(0, u.station))).parameters()(u.parameter) / u.scale;
    }
    return out;
  }

  /// The Jacobian of touches that lie on their objects exactly: residuals, by noise alone, hide what is unobservable.
  VERNIER_API MatrixX touching_jacobian(const ArmParameterisation& arm) const {
    std::vector<MatrixX> joints;
    std::vector<Station> stations;
    for (int c = 0; c < arm.stations(); ++c) {
      stations.push_back(problem_.station_of(first_block(c)));
      joints.push_back(touching_joints(arm.geometry(c), stations.back()));
    }
    for (std::size_t c = 0; c < stations.size(); ++c) stations[c].joint_values = joints[c].data();
    CalibrationProblem touching(arm, std::move(stations), Loss::squared);
    touching.joint_columns = false;
    return touching.stacked(true).jacobian;
  }

  VERNIER_API Index first_block(int station) const {
    Index out = 0;
    for (int c = 0; c < station; ++c) out += contact(c).size();
    return out;
  }

  /// Separates independent from dependent unknowns at the present values, the scale aside.
  VERNIER_API Selection select(const std::vector<GeometricUnknown>& candidates) {
    problem_.arm.set_geometric(candidates);
    MatrixX jacobian = touching_jacobian(problem_.arm);
    const VectorX scale = scale_direction(false);
    const double effect = product(jacobian, scale).norm();
    const double apart = std::sqrt(weighted_square(squared_column_norms(jacobian), scale));
    scale_observable_ = !(effect <= 1e-7 * apart);
    if (!scale_observable_) {  // held, so known
      const VectorX held = scale_direction(true);
      const double size = jacobian.norm() / std::max(held.norm(), 1e-300);
      append_row(jacobian, size * held);
    }
    const IdentifiableParameters columns(jacobian);
    Selection out;
    const auto unknown = [&](Index k) { return candidates[static_cast<std::size_t>(k)]; };
    for (const Index k : columns.base) out.base.push_back(unknown(k));
    for (const auto& d : columns.dependent) {
      std::vector<GeometricUnknown> absorbed_by;
      for (const Index k : d.absorbed_by) absorbed_by.push_back(unknown(k));
      out.dependent.emplace_back(unknown(d.column), std::move(absorbed_by));
    }
    return out;
  }

  /// Gives the priors of the chain the common width of most evidence.
  VERNIER_API void size_priors() {
    UnknownGroup chain;
    const auto& unknowns = problem_.arm.geometric();
    for (std::size_t k = 0; k < unknowns.size(); ++k)
      if (plan_.in_chain(unknowns[k].parameter)) chain.push_back(static_cast<Index>(k));
    if (chain.empty()) return;
    const NormalEquations normal = problem_.normal_equations();
    VectorX precisions =
        scale_priors(normal, problem_.arm.precisions(), problem_.arm.steps(), problem_.measured_values(), chain);
    constexpr double widest = 10;  // expected sizes, where there is little evidence
    for (const Index k : chain) precisions(k) = std::max(precisions(k), 1 / (widest * widest));
    problem_.arm.set_precisions(precisions);
  }

  /// Of the residuals, per measured value, of one contact or of all [m].
  VERNIER_API static double residual_rms(const CalibrationProblem& problem, int station = -1) {
    CalibrationProblem unweighted = problem;
    unweighted.reset_weights();
    const StackedRows rows = unweighted.stacked(false);
    double sum = 0, count = 0;
    for (Index i = 0; i < rows.residuals.size(); ++i) {
      const Index block = rows.block[static_cast<std::size_t>(i)];
      if (station >= 0 && unweighted.station_index(block) != station) continue;
      const double residual = rows.residuals(i) * unweighted.station_of(block).position_sigma;
      sum += residual * residual;
      ++count;
    }
    return std::sqrt(sum / std::max(count, 1.0));
  }
  VERNIER_API double residual_rms() const { return residual_rms(problem_); }

  /// How many directions of the arm measured positions at the same joints determine, apart from its base.
  VERNIER_API Index rank_by_positions(const ArmGeometry& arm) const {
    Index count = 0;
    for (const Contact& contact : contacts_) count += contact.size();
    MatrixX joints(count, arm.joints());
    count = 0;
    for (const Contact& contact : contacts_) {
      joints.middleRows(count, contact.size()) = contact.joints();
      count += contact.size();
    }
    const PointRows points = arm.positions(joints);
    const Station ideal{.joint_values = joints.data(), .samples = count, .dof = arm.joints(), .positions = &points};
    std::vector<GeometricUnknown> unknowns;
    for (Index k = 0; k < 6; ++k) unknowns.push_back({k, -1, plan_.scales(k), 0});
    for (const GeometricUnknown& unknown : unknowns_of_arm()) unknowns.push_back(unknown);
    const CalibrationProblem measured(ArmParameterisation({arm}, std::move(unknowns)), {ideal}, Loss::squared);
    const IdentifiableParameters columns(measured.stacked(true).jacobian);
    return static_cast<Index>(columns.base.size()) -
           static_cast<Index>(std::count_if(columns.base.begin(), columns.base.end(), [](Index k) { return k < 6; }));
  }

  VERNIER_API std::string name(const GeometricUnknown& unknown) const {
    if (unknown.station >= 0) return message("the place of ", contact(unknown.station).name());
    return plan_.names[static_cast<std::size_t>(unknown.parameter)];
  }

  VERNIER_API void describe(ContactReport& report, const ArmGeometry& identified, const Selection& columns) {
    const CalibrationProblem& solved = problem_;
    report.scale_observable = scale_observable_;
    report.rms_after = residual_rms();

    // singular values of everything: base (which has no effect), objects, tool and chain
    ArmParameterisation all = solved.arm;
    std::vector<GeometricUnknown> unknowns = unknowns_of_objects();
    for (const GeometricUnknown& unknown : unknowns_of_arm()) unknowns.push_back(unknown);
    Index without_effect = 6;
    for (const Index k : plan_.candidates) without_effect += k >= chain_end() + 3;
    all.set_geometric(unknowns);
    const MatrixX jacobian = touching_jacobian(all);
    MatrixX padded = MatrixX::Zero(std::max(jacobian.rows(), jacobian.cols()), jacobian.cols());
    padded.topRows(jacobian.rows()) = jacobian;
    const VectorX values = right_singular(triangular_factor(padded)).values;
    report.singular_values = VectorX::Zero(values.size() + without_effect);
    report.singular_values.head(values.size()) = values;
    report.unobservable = std::count_if(report.singular_values.begin(), report.singular_values.end(),
                                        [&](double value) { return value <= 1e-9 * values(0); });

    // covariance of what is estimated
    const auto& estimated = solved.arm.geometric();
    const StackedRows rows = solved.stacked(true);
    MatrixX stack = rows.jacobian;
    if (solved.prior) {
      const VectorX held = scale_direction(true);
      append_row(stack, std::sqrt(diagonal_of(solved.prior->precision).sum()) / std::max(held.norm(), 1e-300) * held);
    }
    const VectorX precisions = solved.arm.precisions();
    const VectorX ones = VectorX::Ones(stack.rows());
    VectorX variances(precisions.size());
    for (Index k = 0; k < variances.size(); ++k) variances(k) = 1 / std::max(precisions(k), 1e-300);
    const EstimateCovariance unit(stack, ones, precisions, variances);
    double explained = static_cast<double>(precisions.size());
    if (unit.inverse.size() > 0) explained -= diagonal_of(unit.inverse).dot(precisions);
    const double freedom = static_cast<double>(rows.residuals.size()) - explained + (solved.prior ? 1 : 0);
    const double variance = freedom >= 1 ? rows.residuals.squaredNorm() / freedom : 1;
    report.rank = unit.rank;
    report.condition = unit.condition;
    if (unit.singular_values.size() > 0)
      report.observability = Observability::of(unit.singular_values, solved.num_blocks());

    const VectorX before = nominal_.parameters(), now = identified.parameters();
    for (Index k = 0; k < before.size(); ++k)
      report.parameters.push_back({plan_.names[static_cast<std::size_t>(k)],
                                   plan_.kinds[static_cast<std::size_t>(k)],
                                   before(k),
                                   now(k),
                                   0,
                                   ParameterState::fixed,
                                   {},
                                   plan_.scales(k)});
    const auto hide = [&](Index k, std::string remark) {
      ParameterEstimate& p = report.parameters[static_cast<std::size_t>(k)];
      p.state = ParameterState::not_identifiable;
      p.remark = std::move(remark);
    };
    for (Index k = 0; k < 6; ++k) hide(k, "contacts are relative to the arm");
    for (const Index k : plan_.candidates)
      if (k >= chain_end() + 3) hide(k, "no effect on touches");
    for (const auto& [unknown, absorbed_by] : columns.dependent) {
      if (unknown.station >= 0) continue;  // counted as missing
      std::vector<std::string> others;
      for (const GeometricUnknown& other : absorbed_by)
        if (const std::string text = name(other); std::find(others.begin(), others.end(), text) == others.end())
          others.push_back(text);
      std::string remark = others.empty() ? "no effect on touches" : "absorbed by ";
      for (std::size_t j = 0; j < others.size() && j < 4; ++j) remark += (j > 0 ? ", " : "") + others[j];
      hide(unknown.parameter, remark + (others.size() > 4 ? ", ..." : ""));
    }
    std::vector<Index> of_arm;
    for (std::size_t k = 0; k < estimated.size(); ++k)
      if (estimated[k].station < 0) of_arm.push_back(static_cast<Index>(k));
    if (unit.inverse.size() > 0)
      report.covariance.resize(static_cast<Index>(of_arm.size()), static_cast<Index>(of_arm.size()));
    for (std::size_t i = 0; i < of_arm.size(); ++i) {
      const GeometricUnknown& u = estimated[static_cast<std::size_t>(of_arm[i])];
      ParameterEstimate& p = report.parameters[static_cast<std::size_t>(u.parameter)];
      report.free.push_back(u.parameter);
      p.state = ParameterState::identified;
      if (u.precision > 0) p.prior_std = u.scale * std::sqrt(variance / u.precision);
      if (unit.inverse.size() == 0) continue;
      for (std::size_t j = 0; j < of_arm.size(); ++j)
        report.covariance(static_cast<Index>(i), static_cast<Index>(j)) =
            variance * unit.inverse(of_arm[i], of_arm[j]) * u.scale *
            estimated[static_cast<std::size_t>(of_arm[j])].scale;
      p.std = std::sqrt(report.covariance(static_cast<Index>(i), static_cast<Index>(i)));
      if (p.std * p.std > 0.5 * p.prior_std * p.prior_std) p.state = ParameterState::weak;
    }

    Index of_objects = 0;
    for (const GeometricUnknown& u : estimated) of_objects += u.station >= 0;
    report.missing = rank_by_positions(identified.with_frames({}, identified.tool())) -
                     (static_cast<Index>(estimated.size()) - of_objects);
    const Index touches = solved.num_blocks();
    report.message = message(
        touches, " touches of ", counted(static_cast<long long>(contacts_.size()), "object", "objects"), " determine ",
        counted(static_cast<Index>(of_arm.size()), "parameter of the arm", "parameters of the arm"));
    if (!converged_) {
      report.status = IdentifyStatus::not_converged;
      report.message = message("the steps did not vanish within ", options_.max_iterations, " iterations");
    } else if (report.missing > 0) {
      report.status = IdentifyStatus::underdetermined;
      report.message += message("; measured positions at the same joints would determine ", report.missing, " more");
    } else if (solved.measured_values() + (solved.prior ? 1 : 0) <= static_cast<Index>(estimated.size())) {
      report.status = IdentifyStatus::underdetermined;
      report.message = message(touches, " touches give ", solved.measured_values(), " measured values for ",
                               static_cast<Index>(estimated.size()), " unknowns of arm and objects");
    }
    describe_objects(report);
  }

  VERNIER_API void describe_objects(ContactReport& report) const {
    for (int c = 0; c < static_cast<int>(contacts_.size()); ++c) {
      const ArmGeometry& arm = problem_.arm.geometry(c);
      const Isometry3 out_of = composed(nominal_.base().isometry(), inverse_of(arm.base().isometry()));
      Vector3 local = Vector3::Zero();
      if (contact(c).kind() == ContactKind::plane) {
        local = centroid(arm.positions(contact(c).joints()));
        local.z() = 0;
      }
      TouchedObject object{contact(c).name(),          contact(c).kind(), contact(c).size(),
                           transformed(out_of, local), Vector3::Zero(),   residual_rms(problem_, c)};
      if (contact_unknowns(contact(c)) != std::vector<Index>{0, 1, 2})
        object.direction =
            problem_.station_of(first_block(c)).height_sign * Vector3(out_of(0, 2), out_of(1, 2), out_of(2, 2));
      report.objects.push_back(std::move(object));
    }
  }

  const IdentifyOptions& options_;
  const SensorModel& sensors_;
  std::span<const Contact> contacts_;
  IdentificationPlan plan_;
  ArmGeometry nominal_;
  CalibrationProblem problem_;
  bool scale_observable_ = true, converged_ = true;
};

VERNIER_IMPL GeometryByContacts identify_geometry_by_contacts(const ArmGeometry& nominal,
                                                              std::span<const Contact> contacts,
                                                              const IdentifyOptions& options,
                                                              const SensorModel& sensors) {
  sensors.validate();
  require(!contacts.empty(), "identify_by_contacts: no contacts");
  for (const Contact& contact : contacts)
    require(contact.joints().cols() == nominal.joints(), "contact ", contact.name(), ": ", contact.joints().cols(),
            " joints, the arm has ", nominal.joints());
  return ContactIdentification(nominal, contacts, options, sensors).run();
}

}  // namespace vernier::detail
