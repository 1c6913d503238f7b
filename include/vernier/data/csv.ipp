// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/csv.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "vernier/core/same_value.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/csv_table.hpp"
#include "vernier/data/detail/pose_values.hpp"
#include "vernier/data/same_pose.hpp"

namespace vernier::detail {

/// Columns q1 .. qM of the controller behind a prefix: angles, or lengths for prismatic joints. Refuses a file with
/// other joints, and units that do not fit the types of joints, where these are given.
/// @param chain_joints number of joints of the chain
/// @param chain_types  their types, or none
VERNIER_LOCAL std::vector<CsvColumn> joint_columns(const CsvTable& table, int chain_joints,
                                                   std::span<const JointType> chain_types,
                                                   const ControllerMap& controller, std::string_view prefix = "") {
  demand(chain_types.empty() || chain_types.size() == static_cast<std::size_t>(chain_joints),
         "CSV: ", chain_types.size(), " types of joints for ", chain_joints, " joints");
  const int joints = controller.joints(chain_joints);
  const std::vector<JointType> types = controller.types(chain_types);
  for (const std::string_view name : table.header())
    if (const auto joint = joint_of(name, prefix); joint && (*joint < 1 || *joint > joints))
      table.fail_in_header("column ", name, ", but the ", joints < chain_joints ? "controller" : "robot", " has ",
                           joints, " joints", *joint < 1 ? ", counted from 1" : "");
  std::vector<CsvColumn> columns;
  for (int i = 1; i <= joints; ++i) {
    const std::string stem = message(prefix, "q", i);
    const bool known = !types.empty(),
               prismatic = known && types[static_cast<std::size_t>(i - 1)] != JointType::revolute;
    const auto length = table.find(stem, quantities::joint_travel), angle = table.find(stem, quantities::joint_angle);
    if (length && angle) table.fail_in_header("columns ", length->name, " and ", angle->name, " both give ", stem);
    if (!length && !angle)
      (void)table.require_column(stem, prismatic ? quantities::joint_travel : quantities::joint_angle);
    columns.push_back(length ? *length : *angle);
    if (known && prismatic != length.has_value())
      table.fail_in_header("column ", columns.back().name, ", but joint ", i,
                           prismatic ? " is prismatic: a length is needed" : " is revolute: an angle is needed");
  }
  return columns;
}

/// Values of columns, of which those of the controller's joints come first, with the joints of the chain in their
/// place.
VERNIER_LOCAL MatrixX with_chain_joints(MatrixX values, const ControllerMap& controller) {
  if (controller.same()) return values;
  const Index others = values.cols() - controller.joints();
  MatrixX out(values.rows(), controller.chain_joints() + others);
  out.leftCols(controller.chain_joints()) = controller.to_chain(values.leftCols(controller.joints()));
  out.rightCols(others) = values.rightCols(others);
  return out;
}

/// Whether a file has any column of joints behind a prefix.
VERNIER_LOCAL bool has_joints(const CsvTable& table, std::string_view prefix) {
  return std::any_of(table.header().begin(), table.header().end(),
                     [&](std::string_view name) { return joint_of(name, prefix).has_value(); });
}

/// The values of a column, if the file has it.
VERNIER_LOCAL std::optional<VectorX> values_of(const CsvTable& table, std::string_view stem, const Quantity& quantity) {
  const auto found = table.find(stem, quantity);
  return found ? std::optional<VectorX>(table.numbers({*found})) : std::nullopt;
}

/// The joint values of the row before, where a pose was approached from there.
/// @param times empty where the file has none
VERNIER_LOCAL MatrixX approach_by_order(const CsvTable& table, const MatrixX& joints, const VectorX& times) {
  const std::optional<VectorX> segment = values_of(table, "segment", quantities::segment_number);
  MatrixX out = MatrixX::Constant(joints.rows(), joints.cols(), std::numeric_limits<double>::quiet_NaN());
  std::vector<Index> back;
  for (Index i = 1; i < joints.rows(); ++i) {
    if (segment && !same_value((*segment)(i), (*segment)(i - 1))) continue;
    if (times.size() > 0 && times(i) < times(i - 1))
      back.push_back(i);
    else
      for (Index j = 0; j < joints.cols(); ++j) out(i, j) = joints(i - 1, j);
  }
  if (!back.empty())
    table.remark(message(
        ", line ", table.lines()[static_cast<std::size_t>(back[0])].number, ": the time goes back; the approach of ",
        counted(back.size(), "such pose is", "such poses are"),
        " unknown. Rows in another order than that of measuring need columns from_q1_rad .., or --no-approach"));
  return out;
}

/// Payloads as `Dataset::payloads` has them; no rows without a column of masses.
VERNIER_LOCAL MatrixX payloads_of(const CsvTable& table) {
  const auto payload = values_of(table, "payload", quantities::payload);
  if (!payload) return {};
  const Index n = payload->size();
  MatrixX out = MatrixX::Constant(n, 4, std::numeric_limits<double>::quiet_NaN());
  for (Index i = 0; i < n; ++i) out(i, 0) = (*payload)(i);
  Index axis = 0;
  for (const char* stem : {"payload_x", "payload_y", "payload_z"}) {
    ++axis;
    if (const auto centre = values_of(table, stem, quantities::gauge_length))
      for (Index i = 0; i < n; ++i) out(i, axis) = (*centre)(i);
  }
  return out;
}

VERNIER_IMPL MatrixX read_joint_columns(const std::string& path, int joints, std::span<const JointType> types,
                                        const CsvFormat& format, VisitColumns* visits) {
  const CsvTable table(path, format);
  MatrixX out =
      with_chain_joints(table.numbers(joint_columns(table, joints, types, format.controller)), format.controller);
  if (visits != nullptr) {
    visits->payloads = payloads_of(table);
    if (const auto board = table.find("board", quantities::words)) visits->boards = table.texts(*board);
  }
  table.remark_unread();
  return out;
}

/// Covariances of the rows of a file of poses: standard deviations, or entries of matrices; none where it has neither.
VERNIER_LOCAL std::vector<Matrix6> covariances_of(const CsvTable& table, bool oriented) {
  std::vector<CsvColumn> sigmas, entries;
  const int measured = oriented ? 6 : 3;
  constexpr const char* stems[] = {"sx", "sy", "sz", "srx", "sry", "srz"};
  for (int k = 0; k < 6; ++k)
    if (auto found = table.find(stems[k], k < 3 ? quantities::standard_length : quantities::standard_angle))
      sigmas.push_back(std::move(*found));
  for (int r = 1; r <= 6; ++r)
    for (int c = r; c <= 6; ++c)
      if (auto found = table.find(message("cov_", r, c), quantities::covariance_entry))
        entries.push_back(std::move(*found));
  if (sigmas.empty() && entries.empty()) return {};
  if (!sigmas.empty() && !entries.empty())
    table.fail_in_header("columns ", sigmas[0].name, " and ", entries[0].name,
                         ": standard deviations and covariances exclude each other");
  if (!sigmas.empty() && static_cast<int>(sigmas.size()) != measured)
    table.fail_in_header(oriented ? "standard deviations need the columns sx, sy, sz, srx, sry and srz with their units"
                                  : "standard deviations need the columns sx, sy and sz with their units");
  if (!entries.empty() && entries.size() != 21)
    table.fail_in_header("a covariance needs the 21 columns cov_11, cov_12 .. cov_66, there are ", entries.size());
  const MatrixX values = table.numbers(sigmas.empty() ? entries : sigmas);
  std::vector<Matrix6> out;
  for (Index i = 0; i < values.rows(); ++i) {
    Matrix6 one = Matrix6::Identity();
    Index at = 0;
    for (Index r = 0; r < 6 && sigmas.empty(); ++r)
      for (Index c = r; c < 6; ++c) one(r, c) = one(c, r) = values(i, at++) * (r < 3 ? 1e-3 : 1) * (c < 3 ? 1e-3 : 1);
    for (Index k = 0; k < static_cast<Index>(sigmas.size()); ++k) {
      if (!(values(i, k) > 0))
        table.fail_in_row(i, sigmas[static_cast<std::size_t>(k)], "a standard deviation must be positive");
      one(k, k) = values(i, k) * values(i, k);
    }
    if (!positive_definite(one, measured))
      table.fail_in_row(i, sigmas.empty() ? entries[0] : sigmas[0],
                        "the covariance of this row is not positive definite");
    out.push_back(one);
  }
  return out;
}

/// Some rows of a matrix, which may have none.
VERNIER_LOCAL MatrixX chosen_rows(const MatrixX& from, std::span<const Index> rows) {
  MatrixX out(from.rows() > 0 ? static_cast<Index>(rows.size()) : 0, from.cols());
  copy_rows(from, rows, out);
  return out;
}

/// Repeats rows, values apart, one for each point of a line.
VERNIER_LOCAL void choose_rows(PoseColumns& out, const std::vector<Index>& rows) {
  out.previous = chosen_rows(out.previous, rows);
  out.times = chosen_rows(out.times, rows);
  out.temperatures = chosen_rows(out.temperatures, rows);
  out.payloads = chosen_rows(out.payloads, rows);
  std::vector<Matrix6> covariances;
  for (const Index row : rows)
    if (!out.covariances.empty()) covariances.push_back(out.covariances[static_cast<std::size_t>(row)]);
  out.covariances = std::move(covariances);
  out.origin = out.origin.rows(rows);
}

/// Names of the reflectors in a column `point`, one a row; none where the file has no such column.
VERNIER_LOCAL std::vector<std::string> named_points(const CsvTable& table) {
  const auto column = table.find("point", quantities::words);
  if (!column) return {};
  std::vector<std::string> names = table.texts(*column);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty()) table.fail_in_row(static_cast<Index>(i), *column, "no name of a reflector");
  return names;
}

/// Whether names of rows are those of reflectors: one at least is measured at two poses.
/// @param poses number of each row's pose
VERNIER_LOCAL bool names_reflectors(const CsvTable& table, const std::vector<std::string>& names,
                                    const std::vector<Index>& poses, bool oriented) {
  std::map<std::string, std::set<Index>> seen;  // poses at which each is measured
  for (std::size_t i = 0; i < names.size(); ++i) seen[names[i]].insert(poses[i]);
  if (seen.size() < 2) return true;
  std::size_t most = 0;
  for (const auto& [name, at] : seen) most = (std::max)(most, at.size());
  if (most < 2) {
    table.remark(": the column point names poses, each at one configuration; it is not read");
    return false;
  }
  for (const auto& [name, at] : seen)
    if (at.size() < 3)
      table.fail_in_header("the reflector '", printable(name), "' is measured at ",
                           counted(at.size(), "configuration", "configurations"),
                           ", it needs three or more; call the column otherwise if it names no reflectors");
  if (oriented)
    table.fail_in_header("several reflectors (column point) have no orientations; leave the columns of these out");
  return true;
}

VERNIER_IMPL PoseColumns read_pose_columns(const std::string& path, int joints, std::span<const JointType> types,
                                           const CsvFormat& format) {
  const CsvTable table(path, format);
  const MatrixX chain_joints =
      with_chain_joints(table.numbers(joint_columns(table, joints, types, format.controller)), format.controller);
  const PoseValues poses = pose_values(table, format.euler);
  const Index n = chain_joints.rows(), values = poses.values.cols();
  PoseColumns out{MatrixX(poses.values.rows(), joints + values), {}, {}, {}, {}, table.origin(), {}, poses.points};
  out.covariances = covariances_of(table, values > 3);
  const VectorX times = values_of(table, "time", quantities::time_of_measuring).value_or(VectorX());
  out.times = times.size() > 0 ? times : VectorX(VectorX::LinSpaced(n, 0, static_cast<double>(n - 1)));
  out.temperatures = values_of(table, "temperature", quantities::temperature).value_or(VectorX());
  out.payloads = payloads_of(table);
  out.previous = has_joints(table, "from_")
                     ? with_chain_joints(table.numbers(joint_columns(table, joints, types, format.controller, "from_")),
                                         format.controller)
                     : approach_by_order(table, chain_joints, times);
  MatrixX of_rows = chain_joints;
  if (poses.points.empty()) {
    out.points = named_points(table);
  } else {
    of_rows = chosen_rows(chain_joints, poses.rows);
    choose_rows(out, poses.rows);
  }
  for (Index k = 0; k < joints + values; ++k)
    for (Index i = 0; i < of_rows.rows(); ++i)
      out.values(i, k) = k < joints ? of_rows(i, k) : poses.values(i, k - joints);
  if (!out.points.empty()) {
    const std::vector<Index> numbers = pose_numbers(of_rows, {.joint_types = types});
    if (!names_reflectors(table, out.points, numbers, values > 3)) out.points.clear();
  }
  table.remark_unread();
  return out;
}

VERNIER_IMPL void require_one_point(const PoseColumns& columns, const std::string& path) {
  for (const std::string& name : columns.points)
    if (name != columns.points.front())
      throw DataError(message(path, ": several reflectors ('", printable(columns.points.front()), "', '",
                              printable(name), "', ..); only `calibrate` takes these, here one is needed"));
}

VERNIER_IMPL TargetColumns read_target_columns(const std::string& path, int joints, std::span<const JointType> types,
                                               const CsvFormat& format) {
  const CsvTable table(path, format);
  TargetColumns out;
  const bool posed = table.find("x", quantities::coordinate) || table.find("y", quantities::coordinate) ||
                     table.find("z", quantities::coordinate);
  if (!posed || has_joints(table, ""))
    out.joints =
        with_chain_joints(table.numbers(joint_columns(table, joints, types, format.controller)), format.controller);
  if (posed) out.poses = oriented_values(table, format.euler);
  if (const auto move = table.find("move", quantities::words)) {
    const std::vector<std::string> moves = table.texts(*move);
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (moves[i] != "j" && moves[i] != "l")
        table.fail_in_row(static_cast<Index>(i), *move, "'", printable(moves[i]),
                          "', must be j (joint move) or l (linear move)");
      out.linear.push_back(moves[i] == "l");
    }
  }
  table.remark_unread();
  return out;
}

VERNIER_IMPL DistanceColumns read_distance_columns(const std::string& path, int joints,
                                                   std::span<const JointType> types, const CsvFormat& format) {
  const CsvTable table(path, format);
  std::vector<CsvColumn> columns = joint_columns(table, joints, types, format.controller);
  columns.push_back(table.require_column("distance", quantities::measured_distance));
  MatrixX values = with_chain_joints(table.numbers(columns), format.controller);
  for (Index i = 0; i < values.rows(); ++i)
    if (!(values(i, joints) > 0)) table.fail_in_row(i, columns.back(), "a distance must be positive");
  table.remark_unread();
  return {std::move(values), table.origin()};
}

VERNIER_IMPL std::string pose_text(const ConstMatrixRef& chain_joints, const PointRows& positions,
                                   const PointRows& orientations, const ConstMatrixRef& chain_previous,
                                   const VectorX& times, const VectorX& temperatures, const MatrixX& payloads,
                                   std::span<const JointType> chain_types, const ControllerMap& controller,
                                   const std::vector<Matrix6>& covariances, const std::vector<std::string>& points) {
  demand(chain_types.empty() || chain_types.size() == static_cast<std::size_t>(chain_joints.cols()),
         "write_dataset: ", chain_types.size(), " types of joints for ", chain_joints.cols(), " joints");
  const MatrixX joints = controller.to_controller(chain_joints), previous = controller.to_controller(chain_previous);
  const std::vector<JointType> types = controller.types(chain_types);
  const auto name = [&](Index j) {
    const bool angle = types.empty() || types[static_cast<std::size_t>(j)] == JointType::revolute;
    return message('q', j + 1, angle ? "_rad," : "_m,");
  };
  const bool oriented = orientations.rows() > 0;
  bool in_order = true, counted = true;  // whether the order of the rows says it all
  for (Index i = 0; i < joints.rows(); ++i) {
    bool follows = i > 0 || !finite_row(previous, i);
    for (Index j = 0; i > 0 && j < joints.cols(); ++j)
      follows = follows && same_value(previous(i, j), joints(i - 1, j));
    in_order = in_order && follows;
    counted = counted && same_value(times(i), static_cast<double>(i));
  }
  std::string out = points.empty() ? "" : "point,";
  for (Index j = 0; j < joints.cols() && !in_order; ++j) out += "from_" + name(j);
  if (!counted) out += "time_s,";
  if (temperatures.size() > 0) out += "temperature_c,";
  if (payloads.rows() > 0) out += "payload_kg,";
  std::array<bool, 4> centred{};
  for (Index k = 1; k < 4 && payloads.rows() > 0; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    centred[axis] = finite_row(VERNIER_LATER(payloads).col(k).transpose(), 0);
    if (centred[axis]) out += message("payload_", "xyz"[k - 1], "_mm,");
  }
  for (int r = 1; r <= 6 && !covariances.empty(); ++r)
    for (int c = r; c <= 6; ++c) out += message("cov_", r, c, ',');
  for (Index j = 0; j < joints.cols(); ++j) out += name(j);
  out += oriented ? "x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n" : "x_mm,y_mm,z_mm\n";
  for (Index i = 0; i < joints.rows(); ++i) {
    if (!points.empty()) out += points[static_cast<std::size_t>(i)] + ',';
    for (Index j = 0; j < joints.cols() && !in_order; ++j)
      out += message(std::isfinite(previous(i, j)) ? previous(i, j) : joints(i, j), ',');
    if (!counted) out += message(times(i), ',');
    if (temperatures.size() > 0) out += message(temperatures(i), ',');
    if (payloads.rows() > 0) out += message(payloads(i, 0), ',');
    for (Index k = 1; k < 4; ++k)
      if (centred[static_cast<std::size_t>(k)]) out += message(payloads(i, k) * 1e3, ',');
    for (Index r = 0; r < 6 && !covariances.empty(); ++r)
      for (Index c = r; c < 6; ++c)
        out += message(covariances[static_cast<std::size_t>(i)](r, c) * (r < 3 ? 1e3 : 1) * (c < 3 ? 1e3 : 1), ',');
    for (Index j = 0; j < joints.cols(); ++j) out += message(joints(i, j), ',');
    for (Index j = 0; j < 3; ++j) out += message(positions(i, j) * 1e3, j < 2 || oriented ? ',' : '\n');
    if (oriented)
      for (Index j = 0; j < 3; ++j) out += message(orientations(i, j), j < 2 ? ',' : '\n');
  }
  return out;
}

}  // namespace vernier::detail

namespace vernier {

VERNIER_IMPL CsvText read_csv_text(const std::string& path, const CsvFormat& format) {
  const detail::CsvTable table(path, format);
  CsvText out{path, {table.header().begin(), table.header().end()}, {}, {}};
  for (const detail::TextLine& line : table.lines()) {
    const auto fields = table.fields_of(line);
    out.rows.emplace_back(fields.begin(), fields.end());
    for (std::size_t k = 0; k < fields.size(); ++k)
      if (format.decimal != '.' && detail::known_quantity(out.header[k]))
        std::replace(out.rows.back()[k].begin(), out.rows.back()[k].end(), format.decimal, '.');
    out.lines.push_back(static_cast<Index>(line.number));
  }
  return out;
}

VERNIER_IMPL LabelledPoses read_labelled_poses(const std::string& path, std::initializer_list<const char*> labels,
                                               std::initializer_list<const char*> optional, const CsvFormat& format) {
  const detail::CsvTable table(path, format);
  const MatrixX values = detail::oriented_values(table, format.euler);
  LabelledPoses out;
  out.oriented = values.cols() > 3;
  out.labels.setZero(values.rows(), static_cast<Index>(labels.size() + optional.size()));
  Index label = 0;
  for (const auto& names : {labels, optional})
    for (const char* name : names) {
      const bool required = label < static_cast<Index>(labels.size());
      const auto column = required ? table.require_column(name, detail::quantities::whole_number)
                                   : table.find(name, detail::quantities::whole_number);
      const VectorX numbers = column ? VectorX(table.numbers({*column})) : VectorX(VectorX::Zero(values.rows()));
      for (Index i = 0; i < numbers.size(); ++i) {
        if (!same_value(numbers(i), std::floor(numbers(i))))
          table.fail_in_row(i, *column, numbers(i), ", must be a whole number");
        out.labels(i, label) = static_cast<int>(numbers(i));
      }
      ++label;
    }
  out.times = detail::values_of(table, "time", detail::quantities::time_of_measuring)
                  .value_or(VectorX::Constant(values.rows(), std::numeric_limits<double>::quiet_NaN()));
  for (Index i = 0; i < values.rows(); ++i) {
    Matrix3 orientation = Matrix3::Identity();
    if (out.oriented) orientation = exp_so3(Vector3(values(i, 3), values(i, 4), values(i, 5)));
    out.poses.push_back(rigid_motion(orientation, Vector3(values(i, 0), values(i, 1), values(i, 2))));
  }
  table.remark_unread();
  return out;
}

VERNIER_IMPL std::vector<Contact> read_contacts(const std::string& path, int joints,
                                                std::span<const JointType> joint_types, const CsvFormat& format) {
  const detail::CsvTable table(path, format);
  const MatrixX q = detail::with_chain_joints(
      table.numbers(detail::joint_columns(table, joints, joint_types, format.controller)), format.controller);
  const detail::CsvColumn id_column = table.require_column("contact_id", detail::quantities::words),
                          kind_column = table.require_column("kind", detail::quantities::words);
  const std::vector<std::string> ids = table.texts(id_column), kinds = table.texts(kind_column);
  const auto radius_column = table.find("radius", detail::quantities::gauge_length),
             offset_column = table.find("offset", detail::quantities::gauge_length);
  const VectorX none = VectorX::Constant(q.rows(), std::numeric_limits<double>::quiet_NaN());
  const VectorX radii = radius_column ? table.optional_numbers(*radius_column) : none;
  const VectorX offsets = offset_column ? table.optional_numbers(*offset_column) : none;
  table.remark_unread();

  struct Object {
    std::string name;
    ContactKind kind;
    std::vector<Index> rows;
  };
  std::vector<Object> objects;
  std::map<std::string, std::size_t> known_objects;  // by all of the name, of which messages show a part
  VectorX known(q.rows());
  for (Index i = 0; i < q.rows(); ++i) {
    const std::string &id = ids[static_cast<std::size_t>(i)], &word = kinds[static_cast<std::size_t>(i)];
    if (id.empty()) table.fail_in_row(i, id_column, "no name of what is touched");
    ContactKind kind = ContactKind::plane;
    for (const ContactKind k : {ContactKind::ball, ContactKind::socket})
      if (word == name_of(k)) kind = k;
    if (word != name_of(kind))
      table.fail_in_row(i, kind_column, "'", detail::printable(word), "', must be plane, ball or socket");
    const auto [found, fresh] = known_objects.emplace(id, objects.size());
    if (fresh) objects.push_back({detail::printable(id), kind, {}});
    Object& object = objects[found->second];
    if (object.kind != kind)
      table.fail_in_row(i, kind_column, "contact ", object.name, " is a ", word, " here, and a ", name_of(object.kind),
                        " above");
    object.rows.push_back(i);
    const bool ball = kind == ContactKind::ball;
    if (ball && std::isnan(radii(i)))
      throw DataError(message(path, ": contact ", object.name, ": a ball needs its radius, in a column radius_mm"));
    if (ball && !(radii(i) > 0)) table.fail_in_row(i, *radius_column, "a radius must be positive");
    if (ball && !std::isnan(offsets(i)) && !same_value(offsets(i), 0))
      table.fail_in_row(i, *offset_column, "a ball has a radius, but no offset");
    if (!ball && !std::isnan(radii(i))) table.fail_in_row(i, *radius_column, "a ", word, " has no radius");
    known(i) = ball ? radii(i) : std::isnan(offsets(i)) ? 0 : offsets(i);
  }
  std::vector<Contact> out;
  const RowOrigin origin = table.origin();
  for (const Object& object : objects) {
    const auto n = static_cast<Index>(object.rows.size());
    MatrixX of_joints(n, joints);
    VectorX of_known(n);
    detail::copy_rows(q, object.rows, of_joints);
    detail::copy_rows(known, object.rows, of_known);
    try {
      out.push_back(
          Contact(object.name, object.kind, std::move(of_joints), std::move(of_known)).from(origin.rows(object.rows)));
    } catch (const std::invalid_argument& e) {
      throw DataError(message(path, ": ", std::string(e.what())));
    }
  }
  return out;
}

}  // namespace vernier
