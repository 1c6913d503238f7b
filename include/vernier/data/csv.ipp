#pragma once

#include "vernier/data/csv.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/text_lines.hpp"

namespace vernier::detail {

/// A column found by its stem, with the unit in its name.
struct CsvColumn {
  std::string name;  ///< as in the header
  std::size_t index;
  double factor;  ///< to m or rad
};

/// The lines of a file, its numbers by column name. Quotes are not part of the format.
class CsvTable {
 public:
  explicit CsvTable(const std::string& path) : file_(path) {
    content_ = text_of(path);
    for (const TextLine& line : text_lines(file_, content_)) {
      if (const auto n = 1 + std::count(line.text.begin(), line.text.end(), ',');
          n > static_cast<std::ptrdiff_t>(most_columns))
        throw DataError(message(file_, ", line ", line.number, ": has ", n, " values, more than ", most_columns));
      if (!header_.empty()) {
        lines_.push_back(line);
        continue;
      }
      header_ = cells(line.text);
      header_line_ = line.number;
    }
    if (header_.empty()) throw DataError(message(file_, ": empty, a header line with column names is missing"));
  }

  /// Throws a DataError about the header.
  template <class... Parts>
  [[noreturn]] void fail_in_header(const Parts&... parts) const {
    throw DataError(message(file_, ", line ", header_line_, ": ", parts...));
  }
  /// Where its rows stand.
  RowOrigin origin() const {
    std::vector<Index> lines;
    for (const TextLine& line : lines_) lines.push_back(static_cast<Index>(line.number));
    return RowOrigin::of(file_, std::move(lines), sha256(content_));
  }
  /// Throws a DataError about a value.
  template <class... Parts>
  [[noreturn]] void fail_in_row(Index row, const CsvColumn& column, const Parts&... parts) const {
    throw DataError(message(file_, ", line ", lines_[static_cast<std::size_t>(row)].number, ", column ", column.name,
                            ": ", parts...));
  }

  /// The column `stem` + `_unit`; empty where there is none.
  std::optional<CsvColumn> find(std::string_view stem, bool length) const {
    constexpr std::array<std::pair<std::string_view, double>, 3> lengths{{{"_mm", 1e-3}, {"_m", 1.0}, {"_um", 1e-6}}};
    constexpr std::array<std::pair<std::string_view, double>, 3> angles{
        {{"_rad", 1.0}, {"_deg", std::numbers::pi / 180}, {"_mrad", 1e-3}}};
    std::optional<CsvColumn> found;
    for (const auto& [unit, factor] : length ? lengths : angles)
      for (std::size_t i = 0; i < header_.size(); ++i) {
        if (header_[i].size() != stem.size() + unit.size() || !header_[i].starts_with(stem) ||
            !header_[i].ends_with(unit))
          continue;
        if (found) fail_in_header("columns ", found->name, " and ", header_[i], " both give ", stem);
        found = CsvColumn{std::string(header_[i]), i, factor};
      }
    return found;
  }

  /// A column without unit; empty where there is none.
  std::optional<CsvColumn> find_plain(std::string_view name) const {
    for (std::size_t i = 0; i < header_.size(); ++i)
      if (header_[i] == name) return CsvColumn{std::string(name), i, 1};
    return {};
  }

  /// As `find`, but its absence is an error that lists the columns present.
  CsvColumn require_column(std::string_view stem, bool length) const {
    if (auto column = find(stem, length)) return *column;
    std::string present;
    for (std::size_t i = 0; i < header_.size() && i < 12; ++i) present += (i ? ", " : "") + printable(header_[i]);
    if (header_.size() > 12) present += ", ...";
    throw DataError(message(file_, ": no column ", stem, length ? "_mm or " : "_rad or ", stem, length ? "_m" : "_deg",
                            " in the header (", present, ")"));
  }

  /// The text of a column as it is, one entry a row.
  std::vector<std::string> texts(const CsvColumn& column) const {
    std::vector<std::string> out;
    for (const auto& [number, line] : lines_) {
      const auto fields = cells(line);
      out.emplace_back(column.index < fields.size() ? fields[column.index] : std::string_view());
    }
    return out;
  }

  /// All values of some columns, rows x columns, in m and rad; at least one row.
  MatrixX numbers(const std::vector<CsvColumn>& columns) const {
    if (lines_.empty()) throw DataError(message(file_, ": a header, but no rows of data"));
    MatrixX out(static_cast<Index>(lines_.size()), static_cast<Index>(columns.size()));
    for (std::size_t row = 0; row < lines_.size(); ++row) {
      const auto fields = fields_of(lines_[row]);
      for (std::size_t k = 0; k < columns.size(); ++k)
        out(static_cast<Index>(row), static_cast<Index>(k)) =
            value(fields[columns[k].index], lines_[row].number, columns[k].name) * columns[k].factor;
    }
    return out;
  }

  /// Header and rows as they are.
  CsvText text() const {
    CsvText out{file_, {header_.begin(), header_.end()}, {}, {}};
    for (const TextLine& line : lines_) {
      const auto fields = fields_of(line);
      out.rows.emplace_back(fields.begin(), fields.end());
      out.lines.push_back(static_cast<Index>(line.number));
    }
    return out;
  }

  /// A column of numbers, NaN where a cell is empty.
  VectorX optional_numbers(const CsvColumn& column) const {
    VectorX out = VectorX::Constant(static_cast<Index>(lines_.size()), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t row = 0; row < lines_.size(); ++row) {
      const auto fields = cells(lines_[row].text);
      if (column.index < fields.size() && !fields[column.index].empty())
        out(static_cast<Index>(row)) = value(fields[column.index], lines_[row].number, column.name) * column.factor;
    }
    return out;
  }

 private:
  std::vector<std::string_view> fields_of(const TextLine& line) const {
    auto out = cells(line.text);
    if (out.size() != header_.size())
      throw DataError(
          message(file_, ", line ", line.number, ": ", out.size(), " values, the header has ", header_.size()));
    return out;
  }

  static std::vector<std::string_view> cells(std::string_view line) {
    std::vector<std::string_view> out;
    for (;;) {
      const std::size_t comma = line.find(',');
      out.push_back(trimmed(line.substr(0, comma)));
      if (comma == std::string_view::npos) return out;
      line.remove_prefix(comma + 1);
    }
  }

  double value(std::string_view cell, std::size_t line, const std::string& column) const {
    return number_in(cell, '.', [&] { return message(file_, ", line ", line, ", column ", column, ": "); });
  }

  std::string file_, content_;
  std::vector<std::string_view> header_;
  std::size_t header_line_ = 0;  // counted from 1
  std::vector<TextLine> lines_;
};

/// Columns q1 .. qN behind a prefix: angles, or lengths for prismatic joints. Refuses a file with more joints, and
/// units that do not fit the types of joints, where these are given.
VERNIER_LOCAL std::vector<CsvColumn> joint_columns(const CsvTable& table, int joints, std::span<const JointType> types,
                                                   std::string_view prefix = "") {
  demand(types.empty() || types.size() == static_cast<std::size_t>(joints), "CSV: ", types.size(),
         " types of joints for ", joints, " joints");
  std::vector<CsvColumn> columns;
  for (int i = 1; i <= joints; ++i) {
    const std::string stem = message(prefix, "q", i);
    const auto length = table.find(stem, true), angle = table.find(stem, false);
    if (length && angle) table.fail_in_header("columns ", length->name, " and ", angle->name, " both give ", stem);
    columns.push_back(length ? *length : table.require_column(stem, false));
    if (types.empty()) continue;
    const bool prismatic = types[static_cast<std::size_t>(i - 1)] == JointType::prismatic;
    if (prismatic != length.has_value())
      table.fail_in_header("column ", columns.back().name, ", but joint ", i,
                           prismatic ? " is prismatic: a length is needed" : " is revolute: an angle is needed");
  }
  const std::string surplus = message(prefix, "q", joints + 1);
  for (const bool length : {false, true})
    if (const auto next = table.find(surplus, length))
      table.fail_in_header("column ", next->name, ", but the robot has ", joints, " joints");
  return columns;
}

VERNIER_IMPL MatrixX read_joint_columns(const std::string& path, int joints, std::span<const JointType> types) {
  const CsvTable table(path);
  return table.numbers(joint_columns(table, joints, types));
}

VERNIER_IMPL PoseColumns read_pose_columns(const std::string& path, int joints, std::span<const JointType> types) {
  const CsvTable table(path);
  std::vector<CsvColumn> columns = joint_columns(table, joints, types);
  for (const char* axis : {"x", "y", "z"}) columns.push_back(table.require_column(axis, true));
  if (table.find("rx", false) || table.find("ry", false) || table.find("rz", false))
    for (const char* axis : {"rx", "ry", "rz"}) columns.push_back(table.require_column(axis, false));
  PoseColumns out{table.numbers(columns), {}, {}, {}, table.origin()};
  const Index n = out.values.rows();
  const auto column = [&](const char* name) -> std::optional<VectorX> {
    const auto found = table.find_plain(name);
    return found ? std::optional<VectorX>(table.numbers({*found})) : std::nullopt;
  };
  out.times.resize(n);
  std::iota(out.times.begin(), out.times.end(), 0.0);
  if (const auto times = column("time_s")) out.times = *times;
  out.temperatures = column("temperature_c").value_or(VectorX());
  if (table.find("from_q1", false) || table.find("from_q1", true)) {
    out.previous = table.numbers(joint_columns(table, joints, types, "from_"));
    return out;
  }
  const std::optional<VectorX> segment = column("segment");
  out.previous.setConstant(n, joints, std::numeric_limits<double>::quiet_NaN());
  for (Index i = 1; i < n; ++i)
    for (Index j = 0; j < joints && (!segment || same_value((*segment)(i), (*segment)(i - 1))); ++j)
      out.previous(i, j) = out.values(i - 1, j);
  return out;
}

VERNIER_IMPL TargetColumns read_target_columns(const std::string& path, int joints, std::span<const JointType> types) {
  const CsvTable table(path);
  TargetColumns out;
  const bool posed = table.find("x", true) || table.find("y", true) || table.find("z", true);
  if (!posed || table.find("q1", false) || table.find("q1", true))
    out.joints = table.numbers(joint_columns(table, joints, types));
  if (posed) {
    std::vector<CsvColumn> columns;
    for (const char* axis : {"x", "y", "z"}) columns.push_back(table.require_column(axis, true));
    if (table.find("rx", false) || table.find("ry", false) || table.find("rz", false))
      for (const char* axis : {"rx", "ry", "rz"}) columns.push_back(table.require_column(axis, false));
    out.poses = table.numbers(columns);
  }
  if (const auto move = table.find_plain("move")) {
    const std::vector<std::string> words = table.texts(*move);
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] != "j" && words[i] != "l")
        table.fail_in_row(static_cast<Index>(i), *move, "'", printable(words[i]),
                          "', must be j (joint move) or l (linear move)");
      out.linear.push_back(words[i] == "l");
    }
  }
  return out;
}

VERNIER_IMPL DistanceColumns read_distance_columns(const std::string& path, int joints,
                                                   std::span<const JointType> types) {
  const CsvTable table(path);
  std::vector<CsvColumn> columns = joint_columns(table, joints, types);
  columns.push_back(table.require_column("distance", true));
  MatrixX values = table.numbers(columns);
  for (Index i = 0; i < values.rows(); ++i)
    if (!(values(i, joints) > 0)) table.fail_in_row(i, columns.back(), "a distance must be positive");
  return {std::move(values), table.origin()};
}

VERNIER_IMPL std::string pose_text(const ConstMatrixRef& joints, const PointRows& positions,
                                   const PointRows& orientations, const ConstMatrixRef& previous, const VectorX& times,
                                   const VectorX& temperatures) {
  const bool oriented = orientations.rows() > 0;
  bool in_order = true, counted = true;  // whether the order of the rows says it all
  for (Index i = 0; i < joints.rows(); ++i) {
    bool follows = i > 0 || !finite_row(previous, i);
    for (Index j = 0; i > 0 && j < joints.cols(); ++j)
      follows = follows && same_value(previous(i, j), joints(i - 1, j));
    in_order = in_order && follows;
    counted = counted && same_value(times(i), static_cast<double>(i));
  }
  std::string out;
  for (Index j = 1; j <= joints.cols() && !in_order; ++j) out += message("from_q", j, "_rad,");
  if (!counted) out += "time_s,";
  if (temperatures.size() > 0) out += "temperature_c,";
  for (Index j = 1; j <= joints.cols(); ++j) out += message("q", j, "_rad,");
  out += oriented ? "x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n" : "x_mm,y_mm,z_mm\n";
  for (Index i = 0; i < joints.rows(); ++i) {
    for (Index j = 0; j < joints.cols() && !in_order; ++j)
      out += message(std::isfinite(previous(i, j)) ? previous(i, j) : joints(i, j), ',');
    if (!counted) out += message(times(i), ',');
    if (temperatures.size() > 0) out += message(temperatures(i), ',');
    for (Index j = 0; j < joints.cols(); ++j) out += message(joints(i, j), ',');
    for (Index j = 0; j < 3; ++j) out += message(positions(i, j) * 1e3, j < 2 || oriented ? ',' : '\n');
    if (oriented)
      for (Index j = 0; j < 3; ++j) out += message(orientations(i, j), j < 2 ? ',' : '\n');
  }
  return out;
}

}  // namespace vernier::detail

namespace vernier {

VERNIER_IMPL CsvText read_csv_text(const std::string& path) { return detail::CsvTable(path).text(); }

VERNIER_IMPL LabelledPoses read_labelled_poses(const std::string& path, std::initializer_list<const char*> labels,
                                               std::initializer_list<const char*> optional) {
  const detail::CsvTable table(path);
  std::vector<detail::CsvColumn> columns;
  for (const char* axis : {"x", "y", "z"}) columns.push_back(table.require_column(axis, true));
  LabelledPoses out;
  out.oriented = table.find("rx", false) || table.find("ry", false) || table.find("rz", false);
  if (out.oriented)
    for (const char* axis : {"rx", "ry", "rz"}) columns.push_back(table.require_column(axis, false));
  const MatrixX values = table.numbers(columns);
  out.labels.setZero(values.rows(), static_cast<Index>(labels.size() + optional.size()));
  Index label = 0;
  for (const auto& names : {labels, optional})
    for (const char* name : names) {
      const auto column = table.find_plain(name);
      if (!column && label < static_cast<Index>(labels.size())) throw DataError(message(path, ": no column ", name));
      const VectorX numbers = column ? VectorX(table.numbers({*column})) : VectorX(VectorX::Zero(values.rows()));
      for (Index i = 0; i < numbers.size(); ++i) {
        if (!same_value(numbers(i), std::floor(numbers(i))))
          table.fail_in_row(i, *column, numbers(i), ", must be a whole number");
        out.labels(i, label) = static_cast<int>(numbers(i));
      }
      ++label;
    }
  const auto time = table.find_plain("time_s");
  out.times = time ? VectorX(table.numbers({*time}))
                   : VectorX(VectorX::Constant(values.rows(), std::numeric_limits<double>::quiet_NaN()));
  for (Index i = 0; i < values.rows(); ++i) {
    Matrix3 orientation = Matrix3::Identity();
    if (out.oriented) orientation = exp_so3(Vector3(values(i, 3), values(i, 4), values(i, 5)));
    out.poses.push_back(rigid_motion(orientation, Vector3(values(i, 0), values(i, 1), values(i, 2))));
  }
  return out;
}

VERNIER_IMPL std::vector<Contact> read_contacts(const std::string& path, int joints,
                                                std::span<const JointType> joint_types) {
  const detail::CsvTable table(path);
  const MatrixX q = table.numbers(detail::joint_columns(table, joints, joint_types));
  const auto text_column = [&](const char* name) {
    const auto column = table.find_plain(name);
    if (!column) throw DataError(message(path, ": no column ", name));
    return *column;
  };
  const detail::CsvColumn id_column = text_column("contact_id"), kind_column = text_column("kind");
  const std::vector<std::string> ids = table.texts(id_column), kinds = table.texts(kind_column);
  const auto radius_column = table.find("radius", true), offset_column = table.find("offset", true);
  const VectorX none = VectorX::Constant(q.rows(), std::numeric_limits<double>::quiet_NaN());
  const VectorX radii = radius_column ? table.optional_numbers(*radius_column) : none;
  const VectorX offsets = offset_column ? table.optional_numbers(*offset_column) : none;

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
  for (const Object& object : objects) {
    const auto n = static_cast<Index>(object.rows.size());
    MatrixX of_joints(n, joints);
    VectorX of_known(n);
    detail::copy_rows(q, object.rows, of_joints);
    detail::copy_rows(known, object.rows, of_known);
    try {
      out.push_back(Contact(object.name, object.kind, std::move(of_joints), std::move(of_known))
                        .from(table.origin().rows(object.rows)));
    } catch (const std::invalid_argument& e) {
      throw DataError(message(path, ": ", std::string(e.what())));
    }
  }
  return out;
}

}  // namespace vernier
