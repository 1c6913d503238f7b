// SPDX-License-Identifier: BSD-3-Clause
#include "contact_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "dispatch.hpp"
#include "file_name.hpp"
#include "held_out_rows.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "parameter_table.hpp"
#include "pose_calibration.hpp"
#include "progress.hpp"
#include "report_page.hpp"
#include "saved_model.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/error_model/known_geometry.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// Refuses what must not be used, with advice.
void require_usable(const vn::ContactReport& report, const std::string& file) {
  constexpr double largest = 3e-3;  // [m]; more than the worst of real arms leaves
  if (!(report.rms_after <= largest))
    throw vn::CalibrationFailure(
        fmt::format("{}: wherever its objects are, touches of the best arm miss them by {:.1f} mm (rms): wrong robot, "
                    "units or columns, touches of another object, or a tool point over 0.2 m away from where it is "
                    "assumed?",
                    file, report.rms_after * 1e3));
  if (report.status == vn::IdentifyStatus::underdetermined)
    throw vn::CalibrationFailure(file + ": " + report.message +
                                 "; touch more, at other joint values, or other objects, or --fix parameters");
  if (report.status == vn::IdentifyStatus::not_converged)
    throw vn::CalibrationFailure(file + ": the identification did not converge: " + report.message +
                                 "; look for touches that slipped, or that are of another object");
}

Json errors_json(const ContactCalibration& found) {
  Json out = Json::array();
  for (std::size_t k = 0; k < found.found.size(); ++k) {
    const vn::ObjectErrors& one = found.found[k];
    Json object{{"contact_id", one.name},
                {"kind", vn::name_of(one.kind)},
                {"touches", one.distances.size()},
                {"rms_designed_mm", found.designed[k].rms() * 1e3},
                {"rms_mm", one.rms() * 1e3}};
    if (std::isfinite(one.length_error)) object["length_error_mm"] = one.length_error * 1e3;
    out.push_back(std::move(object));
  }
  return out;
}

Json to_json(const ContactCalibration& found, const std::string& robot) {
  const vn::ContactReport& report = found.report;
  Json out{{"robot", robot},
           {"touches_rms_before_mm", report.rms_before * 1e3},
           {"touches_rms_after_mm", report.rms_after * 1e3},
           {"condition", report.condition},
           {"object_sigma_mm", report.object_sigma * 1e3},
           {"joint_sigma_mrad", report.joint_sigma * 1e3},
           {"scale_observable", report.scale_observable},
           {"directions", report.singular_values.size()},
           {"unobservable_directions", report.unobservable},
           {"unobserved", report.unobserved()},
           {"weak", report.names(vn::ParameterState::weak)}};
  if (!report.prior.empty()) out["prior"] = {{"model", report.prior}, {"change", report.prior_change}};
  if (!found.held_out.empty()) {
    out["held_out"] = found.held_out;
    out["held_out_objects"] = errors_json(found);
  }
  const auto numbers = [](const vn::Vector3& v, double factor) {
    return std::vector<double>{v.x() * factor, v.y() * factor, v.z() * factor};
  };
  for (const vn::TouchedObject& o : report.objects)
    out["objects"].push_back({{"contact_id", o.name},
                              {"kind", vn::name_of(o.kind)},
                              {"touches", o.touches},
                              {"point_mm", numbers(o.point, 1e3)},
                              {"direction", numbers(o.direction, 1)},
                              {"rms_mm", o.rms * 1e3}});
  out["suspects"] = Json::array();
  for (const vn::SuspectTouch& one : report.suspects)
    out["suspects"].push_back(
        {{"where", one.where}, {"contact_id", one.contact}, {"error_mm", one.error * 1e3}, {"factor", one.factor}});
  for (const vn::ParameterEstimate& p : report.parameters) {
    const bool length = p.kind == vn::ParameterKind::length;
    const bool estimated = p.state == vn::ParameterState::identified || p.state == vn::ParameterState::weak;
    if (!estimated) continue;
    const char* unit = length ? "mm" : "mrad";
    out["parameters"].push_back({{"name", p.name},
                                 {fmt::format("nominal_{}", unit), p.nominal * 1e3},
                                 {fmt::format("identified_{}", unit), p.identified * 1e3},
                                 {fmt::format("std_{}", unit), p.std * 1e3}});
  }
  return out;
}

/// Estimated parameters as a table.
std::string estimated_parameters(const vn::ContactReport& report) {
  std::string out = fmt::format("  {:<10}{:>12}{:>12}{:>10}\n", "parameter", "change", "std", "");
  for (const vn::ParameterEstimate& p : report.parameters) {
    if (p.state != vn::ParameterState::identified && p.state != vn::ParameterState::weak) continue;
    out += fmt::format("  {:<10}{:>12.3f}{:>12.3f}  {}{}\n", p.name, (p.identified - p.nominal) * 1e3, p.std * 1e3,
                       p.kind == vn::ParameterKind::length ? "mm" : "mrad",
                       p.state == vn::ParameterState::weak ? ", weak" : "");
  }
  return out;
}

/// Errors at held-out objects as a table.
std::string held_out_table(const ContactCalibration& found) {
  std::string out = fmt::format("Held-out objects, placed where they fit their touches best: {}\n\n", found.held_out);
  out += fmt::format("  {:<24}{:>9}{:>13}{:>13}{:>14}\n", "rms distance of touches", "touches", "as designed",
                     "identified", "error of length");
  for (std::size_t k = 0; k < found.found.size(); ++k) {
    const vn::ObjectErrors& one = found.found[k];
    out += fmt::format("  {:<24}{:>9}{:>13.3f}{:>13.3f}", one.name.substr(0, 23), one.distances.size(),
                       found.designed[k].rms() * 1e3, one.rms() * 1e3);
    out += std::isfinite(one.length_error) ? fmt::format("{:>15.3f} mm\n", one.length_error * 1e3)
                                           : fmt::format("{:>18}\n", "mm");
  }
  return out + "\n";
}

/// Some of the objects of a file.
std::vector<vn::Contact> objects_of(const std::vector<vn::Contact>& all, const std::vector<vn::Index>& rows) {
  std::vector<vn::Contact> out;
  for (const vn::Index k : rows) out.push_back(all[static_cast<std::size_t>(k)]);
  return out;
}

/// An earlier calibration for contacts.
template <int N>
struct EarlierArm {
  vn::SavedModel file;
  vn::CalibratedRobot<N> robot;
  vn::ArmPrior prior;
  vn::KnownGeometry known;
};

/// The links that were identified, with the joint errors of an earlier calibration, which were held, where it has some.
template <int N>
vn::CalibratedRobot<N> calibrated_arm(const vn::IdentifiedByContacts<vn::DhChain<N>>& found,
                                      const vn::RobotInfo<N>& info, const std::optional<EarlierArm<N>>& earlier) {
  const vn::CalibratedRobot<N> links = vn::calibrated_robot(found, info);
  if (!earlier || earlier->prior.estimate.arm.joint_errors().empty()) return links;
  using Chain = vn::DhChain<N>;
  using Arm = typename vn::ErrorModel<Chain>::Arm;
  const vn::ErrorModel<Chain>& before = earlier->robot.model();
  const auto& identified = found.model.identified();
  const auto moved = [&](const Arm& arm) {  // by what the links have changed
    const typename Chain::Parameters p =
        identified.model().parameters() + arm.chain().parameters() - before.identified().chain().parameters();
    return identified.around(
        vn::WithJointErrors<Chain>(identified.model().with_parameters(p), arm.model().joint_errors()));
  };
  const Chain& nominal = found.model.nominal().model();
  const vn::ErrorModel<Chain> model =
      before.fallback() == nullptr
          ? vn::ErrorModel<Chain>(nominal, moved(before.identified()))
          : vn::ErrorModel<Chain>(nominal, moved(before.identified()), moved(*before.fallback()), *before.coverage());
  vn::CalibratedRobot<N> out =
      vn::CalibratedRobot<N>(info.name, model, info.limits, links.provenance()).with_controller(info.controller);
  if (links.estimate() == nullptr) return out;
  return out.with_estimate(vn::with_joint_errors_of(*links.estimate(), earlier->prior.estimate));
}

template <int N>
ContactCalibration identify_arm(const vn::RobotDescription& description, const CalibrationOptions& given,
                                std::uint64_t seed) {
  CalibrationOptions o = options_for(given, description, 1);
  vn::IdentifyOptions& options = o.calibrate.geometry;
  options.frames = options.tool_free() ? vn::Frames::tool : vn::Frames::none;
  const vn::SensorModel& sensors = o.calibrate.sensors;
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const auto types = robot.arm.chain().joint_types();
  const std::vector<vn::Contact> all = vn::read_contacts(o.contacts, N, types, o.csv.format());

  std::optional<EarlierArm<N>> earlier;
  if (!o.prior.empty()) {
    vn::SavedModel file = vn::read_model(o.prior);
    vn::ArmPrior prior = prior_of(file, N);
    vn::KnownGeometry known = vn::known_geometry(prior, vn::ArmGeometry(robot.arm));
    const auto arm = file.as<N>();
    earlier.emplace(EarlierArm<N>{std::move(file), arm, std::move(prior), std::move(known)});
  }
  const auto effective = [&](const std::vector<vn::Contact>& touched) {
    if (!earlier) return touched;
    try {
      return vn::at_effective_joints(touched, earlier->prior.estimate.arm.joint_errors());
    } catch (const std::invalid_argument& error) {
      throw UsageError(o.prior + ": " + error.what());
    }
  };

  ContactCalibration out{.nominal = vn::ArmGeometry(robot.arm), .identified = vn::ArmGeometry(robot.arm)};
  out.inputs.push_back(file_of(all.front().origin()));
  out.inputs.back().rows = 0;  // of several objects
  std::vector<vn::Contact> train = all, test;
  if (!o.test.empty()) {
    test = vn::read_contacts(o.test.front(), N, types, o.csv.format());
    out.inputs.push_back(file_of(test.front().origin()));
    out.inputs.back().rows = 0;
    out.held_out = "those of " + o.test.front();
  } else if (o.holds_out) {
    const vn::detail::SplitRows rows =
        held_out_rows(static_cast<vn::Index>(all.size()), o, seed, o.contacts, "object", out.held_out);
    train = objects_of(all, rows.train);
    test = objects_of(all, rows.test);
  }
  train = objects_of(train, training_rows(static_cast<vn::Index>(train.size()), o, seed, o.contacts, "objects"));

  const std::vector<vn::Contact> seen = effective(train);
  Working working("identifying the arm");
  const auto found = vn::identify_by_contacts(robot.arm, seen, options, sensors, earlier ? &earlier->known : nullptr);
  working.finish();
  require_usable(found, o.contacts);
  out.report = found;
  out.identified = vn::ArmGeometry(found.model.identified());
  out.objects = static_cast<vn::Index>(train.size());
  for (const vn::Contact& contact : train) out.touches += contact.size();

  vn::IdentifyOptions tool_alone = options;
  tool_alone.geometry = false;
  out.assessed = out.held_out.empty() ? train : test;
  const auto errors_by = [](const vn::ArmGeometry& arm, const std::vector<vn::Contact>& touched) {
    std::vector<vn::ObjectErrors> errors;
    for (const vn::Contact& contact : touched) errors.push_back(vn::object_errors(arm, contact));
    return errors;
  };
  const auto with_its_tool = [train, tool_alone, sensors](const vn::RobotDescription& arm) {
    return vn::ArmGeometry(vn::identify_by_contacts(arm.arm<N>().arm, train, tool_alone, sensors).model.identified());
  };
  out.designed = errors_by(with_its_tool(description), out.assessed);
  out.found = errors_by(out.identified, effective(out.assessed));
  out.error_of = [assessed = out.assessed, errors_by, with_its_tool](const vn::RobotDescription& arm) {
    return vn::ErrorStatistics::of(touch_errors(errors_by(with_its_tool(arm), assessed)));
  };
  if (earlier) out.inputs.push_back({earlier->file.file(), 0, earlier->file.hash()});
  for (const vn::SourceFile& file : description.files) out.inputs.push_back({file.name, 0, file.hash});
  if (o.save.empty()) return out;
  const vn::RobotInfo<N> info{.name = robot.name,
                              .limits = robot.limits,
                              .data_file = file_name(o.contacts),
                              .date = o.date,
                              .held_out_error = out.held_out.empty() ? 0 : touch_errors(out.found).mean(),
                              .data_sha256 = all.front().origin().hashes.front(),
                              .controller = robot.controller};
  out.model = {o.save, vn::save(o.save, calibrated_arm(found, info, earlier))};
  return out;
}

/// The page of `--report`.
vn::ReportInput page_of(const ContactCalibration& found, const CalibrationOptions& o, const std::string& robot) {
  vn::ReportInput page;
  page.robot = robot;
  page.what = "touches";
  page.title = "Calibration by contacts";
  page.held_out = !found.held_out.empty();
  page.rule = page.held_out ? found.held_out : "of the objects that it was fitted to";
  page.train_poses = page.held_out ? found.touches : 0;
  page.after = vn::Stage::geometry;
  page.stages.emplace_back(vn::Stage::frames, "as designed", touch_errors(found.designed), vn::VectorX());
  page.stages.emplace_back(vn::Stage::geometry, touch_errors(found.found), vn::VectorX());
  page.parameters = found.report.parameters;
  page.correlated = found.report.strongly_correlated();
  page.sentences = found.report.unobserved();
  for (std::string& sentence : page.sentences) sentence = "Not observed: " + sentence + ".";
  if (o.accept_mm > 0) page.accept = o.accept_mm * 1e-3;
  vn::ReportTable objects{.title = "Objects",
                          .note =
                              "Touches of each object from it, wherever it is [mm]; the error of its longest known "
                              "length as the arm measures it.",
                          .head = {"object", "kind", "touches", "as designed", "identified", "error of length"}};
  const vn::Index joints = found.nominal.joints();
  const vn::Index n = page.stages.front().position.size();
  page.poses.positions.resize(n, 3);
  page.poses.joints.resize(n, joints);
  vn::Index at = 0;
  for (std::size_t k = 0; k < found.found.size(); ++k) {
    const vn::ObjectErrors& one = found.found[k];
    objects.rows.push_back({one.name, vn::name_of(one.kind), fmt::format("{}", one.distances.size()),
                            fmt::format("{:.3f}", found.designed[k].rms() * 1e3),
                            fmt::format("{:.3f}", one.rms() * 1e3),
                            std::isfinite(one.length_error) ? fmt::format("{:.3f}", one.length_error * 1e3) : ""});
    const vn::RowOrigin& origin = found.assessed[k].origin();
    const int first = static_cast<int>(page.poses.files.size());
    for (const std::string& file : origin.files) page.poses.files.push_back(file_name(file));
    for (vn::Index i = 0; i < one.distances.size(); ++i, ++at) {
      page.poses.positions.row(at) = one.points.row(i);
      page.poses.joints.row(at) = found.assessed[k].joints().row(i);
      page.poses.file.push_back(first + origin.file[static_cast<std::size_t>(i)]);
      page.poses.line.push_back(origin.line[static_cast<std::size_t>(i)]);
    }
  }
  page.tables.push_back(std::move(objects));
  page.left_out = found.touches;
  for (const vn::SuspectTouch& one : found.report.suspects)
    page.suspects.push_back({one.where, one.error, one.factor, "touch of " + one.contact});
  page.provenance.inputs = found.inputs;
  return page;
}

}  // namespace

vernier::VectorX touch_errors(const std::vector<vernier::ObjectErrors>& objects) {
  vernier::Index n = 0;
  for (const vernier::ObjectErrors& one : objects) n += one.distances.size();
  vernier::VectorX out(n);
  n = 0;
  for (const vernier::ObjectErrors& one : objects) {
    out.segment(n, one.distances.size()) = one.distances;
    n += one.distances.size();
  }
  return out;
}

ContactCalibration identify_from_contacts(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                          std::uint64_t seed) {
  return dispatch_dof(robot.dof(), [&](auto n) { return identify_arm<n()>(robot, options, seed); });
}

int calibrate_by_contacts(Program& program, const vernier::RobotDescription& robot, const CalibrationOptions& o) {
  const ContactCalibration found = identify_from_contacts(robot, o, program.common().seed);
  fmt::print("{}: {} joints\n{} touches of {} objects, no measured poses: the geometry alone is identified\n\n{}\n",
             robot.name, robot.dof(), found.touches, found.objects, found.report.summary());
  if (!found.held_out.empty()) fmt::print("{}", held_out_table(found));
  fmt::print("{}", estimated_parameters(found.report));
  if (o.parameters) fmt::print("\nFrames and links\n\n{}", parameter_table(found.report));
  const Json json = to_json(found, robot.name);
  if (!program.common().json.empty()) write_json(program.common().json, json);
  if (!o.report.empty()) {
    vn::ReportInput page = page_of(found, o, robot.name);
    page.results = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    write_report(program, o.report, page, o.date, found.model);
  }
  if (!o.save.empty()) fmt::print("Calibrated model: {}; its base frame is the nominal one\n", shown(o.save));
  if (!o.report.empty()) fmt::print("Report: {}\n", shown(o.report));
  return 0;
}

}  // namespace support
