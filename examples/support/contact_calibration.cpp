// SPDX-License-Identifier: BSD-3-Clause
#include "contact_calibration.hpp"

#include <fmt/format.h>

#include <vector>

#include "dispatch.hpp"
#include "file_name.hpp"
#include "json_file.hpp"
#include "report_page.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/data/csv.hpp"
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

Json to_json(const vn::ContactReport& report, const std::string& robot) {
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
std::string parameter_table(const vn::ContactReport& report) {
  std::string out = fmt::format("  {:<10}{:>12}{:>12}{:>10}\n", "parameter", "change", "std", "");
  for (const vn::ParameterEstimate& p : report.parameters) {
    if (p.state != vn::ParameterState::identified && p.state != vn::ParameterState::weak) continue;
    out += fmt::format("  {:<10}{:>12.3f}{:>12.3f}  {}{}\n", p.name, (p.identified - p.nominal) * 1e3, p.std * 1e3,
                       p.kind == vn::ParameterKind::length ? "mm" : "mrad",
                       p.state == vn::ParameterState::weak ? ", weak" : "");
  }
  return out;
}

template <int N>
int calibrate_arm(Program& program, const vn::RobotDescription& description, const std::string& file,
                  const vn::CsvFormat& format, const vn::IdentifyOptions& options, const vn::SensorModel& sensors,
                  const std::string& save, const std::string& date) {
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const std::vector<vn::Contact> contacts = vn::read_contacts(file, N, robot.arm.chain().joint_types(), format);
  const auto found = vn::identify_by_contacts(robot.arm, contacts, options, sensors);
  require_usable(found, file);
  vn::Index touches = 0;
  for (const vn::Contact& contact : contacts) touches += contact.size();
  fmt::print("{}: {} joints\n{} touches of {} objects, no measured poses: the geometry alone is identified\n\n{}\n{}",
             robot.name, N, touches, contacts.size(), found.summary(), parameter_table(found));
  if (!program.common().json.empty()) write_json(program.common().json, to_json(found, robot.name));
  if (save.empty()) return 0;
  vn::save(save,
           vn::calibrated_robot(found, vn::RobotInfo<N>{.name = robot.name,
                                                        .limits = robot.limits,
                                                        .data_file = std::filesystem::path(file).filename().string(),
                                                        .date = date,
                                                        .data_sha256 = contacts.front().origin().hashes.front(),
                                                        .controller = robot.controller}));
  fmt::print("Calibrated model: {}; its base frame is the nominal one\n", shown(save));
  return 0;
}

}  // namespace

int calibrate_by_contacts(Program& program, const vernier::RobotDescription& robot, const std::string& contacts,
                          const vernier::CsvFormat& format, vernier::IdentifyOptions options,
                          const vernier::SensorModel& sensors, const std::string& save, const std::string& date) {
  options.frames = vernier::Frames::tool;
  return dispatch_dof(robot.dof(), [&](auto n) {
    return calibrate_arm<n()>(program, robot, contacts, format, options, sensors, save, date);
  });
}

}  // namespace support
