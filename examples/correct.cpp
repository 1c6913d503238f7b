// A calibrated model and a file of targets in, corrected joint commands out.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "dispatch.hpp"
#include "figures.hpp"
#include "json_file.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/general_six_axis.hpp"

namespace {

namespace vn = vernier;

/// What the command line says.
struct Settings {
  std::string model, targets, out;
  bool poses = false;     ///< of a file with joints and poses, the poses are the targets
  bool approach = true;   ///< commands are executed in their order
  bool linear = false;    ///< all moves are linear
  bool branches = false;  ///< all branches of each target instead of a path
  bool radius = true;     ///< the radius of 95 % of each command
  std::optional<double> temperature{};
  double tolerance_mm = 0.05, max_step_deg = 30;
  std::vector<double> start{};
};

/// One row of the output.
struct Row {
  std::vector<double> command;
  vn::Index target;  ///< counted from 1
  std::string kind, status;
  double error, rotation, deviation, ends_only, gate;
  vn::SingularityDistances singularities;
  double radius = std::nan("");
};

/// What became of the targets.
struct CorrectionReport {
  std::string robot{};                  ///< name in the model
  std::vector<vn::JointType> joints{};  ///< types of its joints
  std::vector<Row> rows{};              ///< commands
  vn::Index targets = 0;                ///< number of targets
  bool linear = false;                  ///< whether there are linear moves
  double before = 0, after = 0;         ///< largest deviation from them [m]
  std::optional<double> temperature{};  ///< for which commands are corrected [deg C], where that matters
  bool clamped = false;                 ///< whether the temperature asked for is not that
};

const char* words(vn::PointStatus status) {
  switch (status) {
    case vn::PointStatus::met: return "converged";
    case vn::PointStatus::jump: return "jump";
    case vn::PointStatus::off_path: return "off_path";
    case vn::PointStatus::beyond_limits: return "beyond_limits";
    case vn::PointStatus::proven_out: return "proven_out";
    case vn::PointStatus::invalid_target: return "invalid_target";
    default: return "not_found";
  }
}

template <class Values>
auto list(const Values& values) {
  return std::vector<std::remove_cvref_t<decltype(*values.begin())>>(values.begin(), values.end());
}

/// The targets of a file.
/// @throws vn::DataError on a malformed file, or one without what the settings ask for
template <int N>
std::vector<vn::PathTarget<N>> read_targets(const Settings& settings, const vn::CalibratedRobot<N>& robot) {
  const auto file = vn::read_targets<N>(settings.targets, robot.nominal().chain().joint_types());
  const bool joints = file.joints.rows() > 0, poses = file.positions.rows() > 0 && (settings.poses || !joints);
  if (settings.poses && file.positions.rows() == 0)
    throw vn::DataError(settings.targets + ": no columns x_mm, y_mm, z_mm");
  if (poses && N >= 6 && file.orientations.rows() == 0)
    throw vn::DataError(vn::message(settings.targets, ": no columns rx_rad, ry_rad, rz_rad; a pose of an arm of ", N,
                                    " joints has an orientation"));
  std::vector<vn::PathTarget<N>> out;
  for (vn::Index i = 0; i < file.size(); ++i) {
    vn::PathTarget<N> target{.pose = vn::Isometry3::Identity()};
    if (joints) {
      target.joints = file.joints.row(i).transpose();
      target.pose = robot.nominal().pose(target.joints);
    }
    if (poses) {
      target.pose.translation() = file.positions.row(i).transpose();
      if (file.orientations.rows() > 0)
        target.pose.linear() = vn::exp_so3(vn::Vector3(file.orientations.row(i).transpose()));
    }
    const bool linear = file.linear.empty() ? settings.linear : file.linear[static_cast<std::size_t>(i)];
    target.motion = linear ? vn::Motion::linear : vn::Motion::joint;
    out.push_back(target);
  }
  return out;
}

/// Calls `use` with what finds the branches of an arm of six joints; with null for others, whose branch is followed.
template <int N, class Use>
void with_branches(const vn::CalibratedRobot<N>& robot, const Use& use) {
  if constexpr (N == 6) {
    const auto made = [&]<class Roots>(std::optional<Roots>& roots) {
      try {
        roots.emplace(robot.nominal());
      } catch (const std::invalid_argument&) {  // another geometry
      }
      return roots.has_value();
    };
    if (std::optional<vn::ClosedForm<N>> closed_form; made(closed_form)) return use(*closed_form);
    if (std::optional<vn::GeneralSixAxis<N>> general; made(general)) return use(*general);
  }
  use(nullptr);
}

/// All branches of each target.
template <int N, class Roots>
void list_branches(const vn::CalibratedRobot<N>& robot, const Roots& roots,
                   const std::vector<vn::PathTarget<N>>& targets, CorrectionReport& report) {
  for (const auto& target : targets) {
    const vn::Index number = static_cast<vn::Index>(&target - targets.data()) + 1;
    vn::BranchOptions<N> options{.limits = robot.limits()};
    if (target.joints.allFinite()) options.near = target.joints;
    const vn::Branches<N> found = vn::all_branches(roots, robot, target.pose, options);
    for (const auto& b : found)
      report.rows.push_back({list(b.joints), number, vn::message("branch ", b.singularities.branch()),
                             words(b.within_limits ? vn::PointStatus::met : vn::PointStatus::beyond_limits),
                             b.position_error, b.rotation_error, 0, 0, robot.gate(b.joints), b.singularities});
    if (found.count == 0)
      report.rows.push_back(
          {std::vector<double>(N, std::nan("")),
           number,
           "target",
           words(found.reach == vn::Reach::proven_out ? vn::PointStatus::proven_out : vn::PointStatus::not_found),
           std::nan(""),
           std::nan(""),
           0,
           0,
           1,
           {}});
  }
}

/// Corrects all targets.
/// @throws vn::DataError on a malformed file
template <int N>
CorrectionReport correct_arm(const Settings& settings) {
  const vn::CalibratedRobot<N> saved = vn::load<N>(settings.model);
  const vn::CalibratedRobot<N> robot = settings.temperature ? saved.at_temperature(*settings.temperature) : saved;
  const std::vector<vn::PathTarget<N>> targets = read_targets(settings, robot);
  CorrectionReport report{.robot = robot.name(),
                          .joints = list(robot.nominal().chain().joint_types()),
                          .targets = static_cast<vn::Index>(targets.size())};
  if (const vn::ThermalRates* thermal = robot.model().thermal()) {
    report.temperature = thermal->reference;
    report.clamped = settings.temperature && *settings.temperature != thermal->reference;
  } else if (settings.temperature) {
    report.clamped = true;
  }
  vn::PathOptions<N> options{.limits = robot.limits(),
                             .tolerance = settings.tolerance_mm * 1e-3,
                             .max_joint_step = settings.max_step_deg * std::numbers::pi / 180,
                             .approach = settings.approach};
  if (!settings.start.empty()) {
    if (settings.start.size() != N) throw support::UsageError(fmt::format("--start needs {} values", N));
    options.start = Eigen::Map<const vn::JointVector<N>>(settings.start.data());
  }
  vn::CorrectedPath<N> path;
  with_branches(robot, [&](const auto& roots) {
    if constexpr (std::is_null_pointer_v<std::remove_cvref_t<decltype(roots)>>) {
      if (settings.branches) throw support::UsageError("--all-branches: needs an arm of six revolute joints");
      if (!targets.front().joints.allFinite() && settings.start.empty())
        throw support::UsageError(fmt::format("poses of an arm of {} joints need joints q1_rad .. or --start", N));
      path = vn::correct_path(robot, targets, options);
    } else if (settings.branches) {
      list_branches(robot, roots, targets, report);
    } else {
      path = vn::correct_path(robot, roots, targets, options);
    }
  });
  if (!settings.branches)
    for (const auto& target : targets) report.linear = report.linear || target.motion == vn::Motion::linear;
  report.before = path.before;
  report.after = path.after;
  vn::JointRows<N> commands(static_cast<vn::Index>(path.points.size()), N);
  for (const auto& p : path.points) {
    commands.row(static_cast<vn::Index>(report.rows.size())) = p.command.transpose();
    report.rows.push_back({list(p.command), p.target + 1, p.inserted ? "inserted" : "target", words(p.status),
                           p.position_error, p.rotation_error, p.deviation, p.ends_only, p.gate, p.singularities});
  }
  if (settings.radius && !settings.branches && saved.estimate() != nullptr) {
    const std::vector<double> radii = robot.radii_95(commands);
    for (std::size_t i = 0; i < radii.size(); ++i) report.rows[i].radius = radii[i];
  }
  return report;
}

/// The commands as CSV: columns q1_rad .. (q1_m for a prismatic joint), then what became of each.
std::string csv(const CorrectionReport& report) {
  std::string text;
  for (std::size_t j = 0; j < report.joints.size(); ++j)
    text += vn::message("q", j + 1, report.joints[j] == vn::JointType::revolute ? "_rad," : "_m,");
  text +=
      "status,predicted_error_mm,gate,target,point,predicted_rotation_mrad,deviation_mm,radius95_mm,"
      "singularity,singularity_deg\n";
  for (const Row& row : report.rows) {
    for (const double q : row.command) text += vn::message(q, ',');
    text +=
        vn::message(row.status, ',', row.error * 1e3, ',', row.gate, ',', row.target, ',', row.kind, ',',
                    row.rotation * 1e3, ',', row.deviation * 1e3, ',', row.radius * 1e3, ',',
                    row.singularities.nearest(), ',', row.singularities.nearest_angle() * 180 / std::numbers::pi, '\n');
  }
  return text;
}

/// Deviation of linear moves over the targets, before and after.
bool plot_deviation(const std::filesystem::path& path, const CorrectionReport& report) {
  support::Series before{"ends corrected alone", {}, {}, support::Style::steps}, after{"with inserted points", {}, {}};
  double position = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    if (report.rows[i].kind != "target") continue;
    const auto pieces = static_cast<double>(i - first + 1);
    for (std::size_t k = first; k <= i; ++k) {
      position = static_cast<double>(report.rows[i].target - 1) + static_cast<double>(k - first + 1) / pieces;
      after.x.push_back(position);
      after.y.push_back(report.rows[k].deviation * 1e3);
    }
    before.x.push_back(position);
    before.y.push_back(report.rows[i].ends_only * 1e3);
    first = i + 1;
  }
  bool any = false;
  for (support::Series* series : {&before, &after})
    for (double& y : series->y) {
      if (!(y > 0)) y = std::nan("");  // joint moves have no line
      any = any || std::isfinite(y);
    }
  if (!any) return false;
  return support::plot_svg(path, "Deviation of the tool from its lines, as the model predicts", "target",
                           "deviation [mm]", {before, after}, {.log_y = true});
}

int run(support::Program& program) {
  Settings settings;
  bool no_approach = false, no_radius = false;
  CLI::App& app = program.app();
  app.add_option("--model", settings.model, "calibrated model that calibrate saved")->required()->type_name("FILE");
  app.add_option("--targets", settings.targets,
                 "joints q1_rad.. at which the nominal arm stands where the actual one is to go, or poses x_mm, y_mm, "
                 "z_mm, rx_rad, ry_rad, rz_rad in the frame of the measurements; a column move says how the arm goes "
                 "there: j (joint move) or l (linear move)")
      ->required()
      ->type_name("FILE");
  app.add_flag("--poses", settings.poses,
               "of a file with joints and poses, the poses are the targets; the joints choose the branch");
  app.add_flag("--linear", settings.linear, "all moves are linear, where the file has no column move");
  app.add_option("--tolerance-mm", settings.tolerance_mm,
                 "points are inserted in a linear move until the tool stays so near to the line")
      ->check(CLI::PositiveNumber)
      ->type_name("MM")
      ->capture_default_str();
  app.add_option("--max-step-deg", settings.max_step_deg, "largest change of a joint between points of a linear move")
      ->check(CLI::PositiveNumber)
      ->type_name("DEG")
      ->capture_default_str();
  app.add_option("--start", settings.start, "joint values before the first target [rad, m], separated by commas")
      ->delimiter(',')
      ->type_name("Q1,..");
  app.add_flag("--all-branches", settings.branches, "all joint values of each target, not a path");
  app.add_flag("--no-approach", no_approach,
               "the commands are not executed in the order of the file: correct for the middle of both directions of "
               "approach, not for the approach from the command before");
  app.add_flag("--no-radius", no_radius, "leave out the radius of 95 %, which takes longest");
  app.add_option("--temperature-c", settings.temperature,
                 "temperature of the arm [deg C], for a model that changes with it; by default the mean of its "
                 "measurements")
      ->type_name("T");
  program.parse("", "write the commands to this file", "FILE");
  settings.out = program.common().out;
  settings.approach = !no_approach;
  settings.radius = !no_radius;
  if (settings.out.empty()) throw support::UsageError("--out is required");
  support::require_writable(settings.out);

  const CorrectionReport report =
      support::dispatch_dof(vn::saved_arm(settings.model).dof, [&](auto n) { return correct_arm<n()>(settings); });
  vn::write_file(settings.out, csv(report));

  std::vector<vn::Index> missed, displaced;
  vn::Index met = 0, extrapolated = 0, inserted = 0, not_found = 0, proven_out = 0, jumps = 0;
  double mean = 0, largest = 0, counted = 0;
  std::vector<bool> reached(static_cast<std::size_t>(report.targets) + 1, false);
  for (const Row& row : report.rows) {
    if (row.status == "converged" && row.kind != "inserted") reached[static_cast<std::size_t>(row.target)] = true;
    if (std::isfinite(row.error)) {
      mean += row.error * 1e3;
      largest = std::max(largest, row.error * 1e3);
      ++counted;
    }
    inserted += row.kind == "inserted" ? 1 : 0;
    if (row.kind == "inserted") continue;
    extrapolated += row.gate < 1 ? 1 : 0;
    not_found += row.status == "not_found" ? 1 : 0;
    proven_out += row.status == "proven_out" ? 1 : 0;
    jumps += row.status == "jump" ? 1 : 0;
    if (row.status == "jump" || row.status == "off_path") displaced.push_back(row.target);
  }
  mean /= std::max(counted, 1.0);
  for (vn::Index i = 1; i <= report.targets; ++i) {
    const bool moved = std::find(displaced.begin(), displaced.end(), i) != displaced.end();
    met += reached[static_cast<std::size_t>(i)] ? 1 : 0;
    if (!reached[static_cast<std::size_t>(i)] && !moved) missed.push_back(i);
  }
  fmt::print("{}: {} of {} targets corrected; the model predicts errors of {:.2g} mm (mean), {:.2g} mm (largest)\n",
             report.robot, met, report.targets, mean, largest);
  if (report.linear)
    fmt::print(
        "Linear moves: the tool leaves their lines by {:.2g} mm at most, with {} points inserted; by {:.2g} mm "
        "without\n",
        report.after * 1e3, inserted, report.before * 1e3);
  if (report.temperature)
    fmt::print("Corrected for {:.4g} deg C{}\n", *report.temperature,
               report.clamped         ? ", the nearest that was measured"
               : settings.temperature ? ""
                                      : ", the mean of the measurements");
  else if (report.clamped)
    fmt::print("The model does not change with temperature; --temperature-c has no effect\n");
  if (extrapolated > 0)
    fmt::print("{} of them lie outside the measured joint ranges, where the learned part fades out\n", extrapolated);
  fmt::print("Commands: {}\n", settings.out);
  if (report.linear) {
    const auto figure = std::filesystem::path(settings.out).replace_extension(".svg");
    if (plot_deviation(figure, report)) fmt::print("Deviation along the path: {}\n", figure.string());
  }
  if (!program.common().json.empty())
    support::write_json(program.common().json,
                        {{"robot", report.robot},
                         {"targets", report.targets},
                         {"points", report.rows.size()},
                         {"inserted", inserted},
                         {"corrected", met},
                         {"met", met},
                         {"not_found", not_found},
                         {"proven_out", proven_out},
                         {"jumps", jumps},
                         {"missed_rows", missed},
                         {"extrapolated", extrapolated},
                         {"predicted_error", {{"mean_mm", mean}, {"max_mm", largest}}},
                         {"max_residual_um", largest * 1e3},
                         {"path", {{"before_max_mm", report.before * 1e3}, {"after_max_mm", report.after * 1e3}}}});
  const auto rows = [](const std::vector<vn::Index>& numbers) {
    std::string out;
    for (std::size_t i = 0; i < numbers.size() && i < 5; ++i) out += fmt::format("{}{}", i ? ", " : "", numbers[i]);
    return out + (numbers.size() > 5 ? ", ..." : "");
  };
  if (!missed.empty())
    throw std::runtime_error(fmt::format("{} of {} targets cannot be met, their rows in {} say so: row {}",
                                         missed.size(), report.targets, settings.out, rows(missed)));
  if (!displaced.empty())
    throw std::runtime_error(
        fmt::format("{} of {} moves are not as asked: they leave their branch or their line; the "
                    "rows in {} say so: target {}",
                    displaced.size(), report.targets, settings.out, rows(displaced)));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return support::run_program("correct", "Targets in, corrected joint commands out.", argc, argv, run);
}
