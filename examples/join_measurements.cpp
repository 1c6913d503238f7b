// SPDX-License-Identifier: BSD-3-Clause
// Commanded joints and a tracker's table of points in, measured poses as one CSV file out.

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli.hpp"
#include "csv_options.hpp"
#include "dispatch.hpp"
#include "json_file.hpp"
#include "robot_choice.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/pair_points.hpp"

namespace {

namespace vn = vernier;

/// What the command line says.
struct Settings {
  support::RobotOptions robot;
  support::CsvOptions joints_csv;
  std::string joints, points, out, key, preset, unit, separator, decimal, comment;
  std::vector<std::string> columns{};
  vn::Index header_lines = 0;
  bool leave_out = false;
};

vn::PointTableFormat format_of(const Settings& o) {
  const double unit = vn::length_unit(o.unit);
  vn::PointTableFormat format{.unit = unit};
  if (o.preset == "sa") format = vn::PointTableFormat::spatial_analyzer(unit);
  if (o.preset.empty() && (o.columns.empty() || o.separator.empty()))
    throw support::UsageError("the layout of --points is not guessed: --preset, or --columns and --separator");
  if (!o.columns.empty()) format.columns = o.columns;
  if (!o.separator.empty()) format.separator = support::one_character(o.separator, "--separator");
  if (!o.decimal.empty()) format.decimal = support::one_character(o.decimal, "--decimal");
  if (!o.comment.empty()) format.comment = o.comment;
  format.header_lines = o.header_lines;
  return format;
}

/// @throws UsageError for a format that cannot be
vn::PointTable read_points(const Settings& o) {
  const vn::PointTableFormat format = format_of(o);
  try {
    return vn::read_point_table(o.points, format);
  } catch (const vn::DataError&) {
    throw;
  } catch (const std::invalid_argument& e) {
    throw support::UsageError(e.what());
  }
}

/// How the file of joints is written; all of its columns are kept, so nothing is remarked on them.
vn::CsvFormat joints_format(const Settings& o) {
  vn::CsvFormat out = o.joints_csv.format();
  out.remark = [](const std::string&) {};
  return out;
}

/// What a reader makes of the file of joints, whose options have names of their own here.
template <class Read>
auto of_joints(const Read& read) {
  try {
    return read();
  } catch (const vn::DataError& e) {
    std::string said = e.what();
    for (const std::string option : {"--separator", "--decimal", "--columns"})
      if (const auto at = said.find(option); at != std::string::npos) said.insert(at + 2, "joints-");
    throw vn::DataError(said);
  }
}

/// Poses of the nominal flange at all rows.
std::vector<vn::Isometry3> flanges_of(const Settings& o) {
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  return support::dispatch_dof(robot.dof(), [&](auto n) {
    const auto arm = robot.arm<n()>().arm;
    vn::CsvFormat format = joints_format(o);
    format.controller = robot.controller;
    const auto joints = of_joints([&] { return vn::read_joints<n()>(o.joints, arm.model().joint_types(), format); });
    std::vector<vn::Isometry3> out;
    for (vn::Index i = 0; i < joints.rows(); ++i) out.push_back(arm.pose(joints.row(i).transpose()));
    return out;
  });
}

/// Columns with the joints, as in read_dataset.
std::vector<std::size_t> joint_columns(const std::vector<std::string>& header) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < header.size(); ++k)
    if (header[k].size() > 2 && header[k][0] == 'q' && header[k][1] >= '1' && header[k][1] <= '9' &&
        header[k].find('_') != std::string::npos)
      out.push_back(k);
  return out;
}

/// A name or a cell as CSV has it.
/// @throws vn::DataError on one that it cannot have
std::string cell_text(const std::string& cell, const vn::CsvText& of) {
  if (cell.find(',') == std::string::npos) return cell;
  if (cell.find('"') != std::string::npos)
    throw vn::DataError(of.file + ": a cell with a comma and a quotation mark cannot be written");
  return '"' + cell + '"';
}

/// The rows of the joints' file that have a point, as they are, with the point and the lines of both. Where rows are
/// left out, the others keep the joints from which they were approached, and their times.
std::string joined(const vn::CsvText& commanded, const vn::PointTable& table, const vn::Pairing& pairing) {
  const auto column = [&](const char* name) {
    return std::find(commanded.header.begin(), commanded.header.end(), name) - commanded.header.begin();
  };
  const auto has = [&](const char* name) {
    return column(name) < static_cast<std::ptrdiff_t>(commanded.header.size());
  };
  for (const char* name :
       {"x_mm", "y_mm", "z_mm", "x_m", "y_m", "z_m", "x_um", "y_um", "z_um", "joints_line", "points_line"})
    if (has(name))
      throw vn::DataError(vn::message(commanded.file, ": has a column ", name, " already; name it otherwise"));
  const auto joints = joint_columns(commanded.header);
  if (joints.empty()) throw vn::DataError(commanded.file + ": no columns q1_rad .. in the header");
  const bool gaps = pairing.pairs.size() < commanded.rows.size();
  bool approached = false;
  for (const std::string& name : commanded.header) approached = approached || name.starts_with("from_q");
  const bool add_approach = gaps && !approached, add_time = gaps && !has("time_s") && !has("time_ms");
  const auto segment = static_cast<std::size_t>(has("segment") ? column("segment") : 0);

  std::string out;
  for (const std::string& name : commanded.header) out += cell_text(name, commanded) + ',';
  for (const std::size_t k : joints)
    if (add_approach) out += "from_" + commanded.header[k] + ',';
  if (add_time) out += "time_s,";
  out += "x_mm,y_mm,z_mm,joints_line,points_line\n";
  for (const vn::PointPair& pair : pairing.pairs) {
    const auto row = static_cast<std::size_t>(pair.row);
    for (const std::string& cell : commanded.rows[row]) out += cell_text(cell, commanded) + ',';
    // an approach that is unknown is written as no motion
    const bool known = row > 0 && (!has("segment") || commanded.rows[row][segment] == commanded.rows[row - 1][segment]);
    for (const std::size_t k : joints)
      if (add_approach) out += commanded.rows[known ? row - 1 : row][k] + ',';
    if (add_time) out += vn::message(pair.row, ',');
    for (int k = 0; k < 3; ++k) out += vn::message(1e3 * table.points(pair.point, k), ',');
    out += vn::message(commanded.lines[row], ',', table.lines[static_cast<std::size_t>(pair.point)], '\n');
  }
  return out;
}

const char* name_of(vn::PairingFault::Kind kind) {
  switch (kind) {
    case vn::PairingFault::Kind::missing: return "missing";
    case vn::PairingFault::Kind::additional: return "additional";
    case vn::PairingFault::Kind::swapped: return "swapped";
    case vn::PairingFault::Kind::out_of_order: return "out_of_order";
    default: return "misfit";
  }
}

support::Json to_json(const vn::Pairing& pairing, const vn::CsvText& commanded, const vn::PointTable& table) {
  support::Json faults = support::Json::array();
  for (const vn::PairingFault& fault : pairing.faults)
    faults.push_back({{"kind", name_of(fault.kind)}, {"text", vn::describe(fault, commanded, table)}});
  support::Json out{{"rows", commanded.rows.size()},
                    {"points", table.lines.size()},
                    {"pairs", pairing.pairs.size()},
                    {"faults", faults}};
  if (pairing.proof) {
    const vn::PairingProof& proof = *pairing.proof;
    out["proof"] = {{"median_mm", 1e3 * proof.median},
                    {"limit_mm", 1e3 * proof.limit},
                    {"scale", proof.scale},
                    {"indistinct", proof.indistinct},
                    {"offset_mm", {1e3 * proof.offset.x(), 1e3 * proof.offset.y(), 1e3 * proof.offset.z()}}};
  }
  return out;
}

int run(support::Program& program) {
  Settings o;
  program.add_option("--joints", o.joints, "commanded joints, columns q1_rad .. in the order of measuring", "FILE")
      .required();
  program.add_option("--points", o.points, "measured points, as the tracker's program exported them", "FILE")
      .required();
  program.add_option("--unit", o.unit, "of the points: um, mm, cm, m, in, ft", "UNIT")
      .required()
      .one_of({"um", "mm", "cm", "m", "in", "ft"});
  program.add_option("--preset", o.preset, "layout of --points: sa, ASCII points of SpatialAnalyzer", "NAME")
      .one_of({"sa"});
  program.add_option("--columns", o.columns, "columns of --points: name, x, y, z; other words are skipped", "NAME,...")
      .delimiter(',');
  program.add_option("--separator", o.separator,
                     "between the columns of --points: a character, tab, or space for any number of blanks", "C");
  program.add_option("--decimal", o.decimal, "decimal point of --points; . without it", "C");
  program.add_option("--comment", o.comment, "lines that begin with this text are skipped", "TEXT");
  o.joints_csv.add_to(program, "joints-", "--joints");
  program.add_setting("--header-lines", o.header_lines, "number of lines to skip at the beginning", "N")
      .within(0, 1000);
  program.add_option("--key", o.key, "column of --joints with the names of the points; without it they pair by order",
                     "COLUMN");
  program.group(support::Group::model);
  o.robot.add_to(program).description(
      "name in the catalogue, or a file: its nominal kinematics prove the order, or check the names, the unit and the "
      "frame");
  program.group(support::Group::output);
  program.add_flag("--leave-out", o.leave_out,
                   "write the pairs that are proven although something is wrong: rows and points without a partner are "
                   "left out, swapped ones exchanged");
  program.parse("", "write the measured poses to this file", "FILE");
  o.out = program.common().out;
  if (o.key.empty() && o.robot.robot.empty())
    throw support::UsageError("--key pairs by name; without it --robot is needed to prove the order");
  const vn::PointTable table = read_points(o);

  const vn::CsvText commanded = of_joints([&] { return vn::read_csv_text(o.joints, joints_format(o)); });
  vn::Pairing pairing;
  if (o.key.empty()) {
    pairing = vn::pair_by_order(flanges_of(o), table.points);
  } else {
    pairing = vn::pair_by_name(commanded, o.key, table);
    if (!o.robot.robot.empty()) pairing = vn::check_pairs(pairing, flanges_of(o), table.points);
  }
  if (pairing.proof && pairing.proof->status != vn::PairingStatus::proven)
    throw vn::DataError(o.points + ": " + vn::describe(*pairing.proof));
  for (const vn::PairingFault& fault : pairing.faults) fmt::print("{}\n", vn::describe(fault, commanded, table));
  fmt::print("{} pairs of {} rows and {} points, by {}\n", pairing.pairs.size(), commanded.rows.size(),
             table.lines.size(), o.key.empty() ? "order" : "name");
  if (pairing.proof) {
    fmt::print("Distance from the nominal arm: median {:.2f} mm; points more than {:.2f} mm away are found\n",
               pairing.proof->median * 1e3, pairing.proof->limit * 1e3);
    if (pairing.proof->indistinct > 0)
      fmt::print("{} poses are so near the one before that their exchange would not be seen\n",
                 pairing.proof->indistinct);
  } else {
    fmt::print("Neither unit nor frame are checked without --robot\n");
  }
  if (!program.common().json.empty()) support::write_json(program.common().json, to_json(pairing, commanded, table));
  if (pairing.pairs.empty()) throw vn::DataError(o.points + ": no point has a pose");
  if (!pairing.faults.empty() && !o.leave_out)
    throw vn::DataError(vn::message(o.points, ": ", pairing.faults.size(), " departures from ", o.joints,
                                    ", listed above; with --leave-out the other rows are written"));
  vn::write_file(o.out, joined(commanded, table, pairing));
  fmt::print("Measured poses: {}\n", support::shown(o.out));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "join_measurements",
      "Matches a tracker's point list to commanded joint values and writes a pose file for calibrate.",
      {"join_measurements --joints poses.csv --points points.txt --preset sa --unit mm --robot ur10 --out measured.csv",
       "join_measurements --joints poses.csv --key name --points points.csv --columns name,x,y,z --separator , --unit "
       "mm --out measured.csv"},
      "done",
      "not done: rows and points do not match; one line says why"};
  return support::run_program(about, argc, argv, run);
}
