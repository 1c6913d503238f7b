// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/corner_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/detail/csv_table.hpp"

namespace vernier {

namespace detail {

inline constexpr std::array<Quantity::Unit, 1> pixel_unit{{{"_px", 1.0}}};
inline constexpr Quantity pixel_coordinate{pixel_unit, -1e5, 1e5, "beyond any image (1e5 px)"};

/// Numbers of the texts of a column in the order in which they first occur; of none where the file has no such column.
VERNIER_LOCAL std::vector<Index> numbers_of_names(const CsvTable& table, const char* column,
                                                  std::vector<std::string>& names) {
  const Index rows = static_cast<Index>(table.lines().size());
  std::vector<Index> out(static_cast<std::size_t>(rows), 0);
  const auto found = table.find(column, quantities::words);
  if (!found) return out;
  names.clear();
  const std::vector<std::string> texts = table.texts(*found);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i].empty()) table.fail_in_row(static_cast<Index>(i), *found, "no name");
    const auto known = std::find(names.begin(), names.end(), texts[i]);
    out[i] = known - names.begin();
    if (known == names.end()) names.push_back(texts[i]);
  }
  return out;
}

/// The names of images of a file of joints or poses, each once.
VERNIER_LOCAL std::vector<std::string> image_names(const CsvTable& table) {
  const CsvColumn column = table.require_column("image", quantities::words);
  std::vector<std::string> out = table.texts(column);
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i].empty()) table.fail_in_row(static_cast<Index>(i), column, "no name");
    if (!first.emplace(out[i], i).second)
      table.fail_in_row(static_cast<Index>(i), column, "'", printable(out[i]), "' is also in line ",
                        table.lines()[first.at(out[i])].number);
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL Index CornerViews::corners() const {
  Index sum = 0;
  for (const View& view : views) sum += static_cast<Index>(view.corners.size());
  return sum;
}

VERNIER_IMPL CornerViews read_corners(const std::string& path, const Board& board, const CsvFormat& format) {
  board.validate();
  const detail::CsvTable table(path, format);
  CornerViews out;
  out.file = path;
  out.hash = table.origin().hashes.front();
  const detail::CsvColumn image = table.require_column("image", detail::quantities::words);
  const detail::CsvColumn number = table.require_column("corner", detail::quantities::whole_number);
  const detail::CsvColumn u = table.require_column("u", detail::pixel_coordinate),
                          v = table.require_column("v", detail::pixel_coordinate);
  const MatrixX values = table.numbers({number, u, v});
  const std::vector<std::string> images = table.texts(image);
  const std::vector<Index> cameras = detail::numbers_of_names(table, "camera", out.cameras),
                           boards = detail::numbers_of_names(table, "board", out.boards);
  MatrixX places, sizes;
  std::vector<detail::CsvColumn> place_columns, size_columns;
  for (const auto& [names, quantity, columns] :
       {std::tuple{std::array{"board_x", "board_y"}, &detail::quantities::coordinate, &place_columns},
        std::tuple{std::array{"width", "height"}, &detail::pixel_coordinate, &size_columns}})
    for (const char* name : names)
      if (const auto found = table.find(name, *quantity)) columns->push_back(*found);
  if (place_columns.size() == 2) places = table.numbers(place_columns);
  if (size_columns.size() == 2) sizes = table.numbers(size_columns);
  table.remark_unread();

  std::map<std::tuple<std::string, Index, Index>, std::size_t> known;
  for (Index i = 0; i < values.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    if (images[row].empty()) table.fail_in_row(i, image, "no name");
    const auto corner = static_cast<Index>(std::lround(values(i, 0)));
    if (!same_value(values(i, 0), static_cast<double>(corner)))
      table.fail_in_row(i, number, values(i, 0), " is no whole number");
    if (corner < 0 || corner >= board.corners())
      table.fail_in_row(i, number, "the board has corners 0 to ", board.corners() - 1, ", not ", corner);
    if (places.rows() > 0) {
      const Vector3 place = board.corner(corner);
      const double apart = std::hypot(places(i, 0) - place(0), places(i, 1) - place(1));
      if (!(apart < 1e-3 * board.square + 1e-6))
        table.fail_in_row(i, place_columns[0], "corner ", corner, " is ", apart * 1e3,
                          " mm away from where the board has it");
    }
    const auto [at, added] = known.try_emplace({images[row], cameras[row], boards[row]}, out.views.size());
    if (added) {
      View view{images[row], cameras[row], boards[row]};
      view.line = static_cast<Index>(table.lines()[row].number);
      if (sizes.rows() > 0) {
        view.width = static_cast<Index>(std::lround(sizes(i, 0)));
        view.height = static_cast<Index>(std::lround(sizes(i, 1)));
      }
      out.views.push_back(std::move(view));
    }
    View& view = out.views[at->second];
    if (std::find(view.corners.begin(), view.corners.end(), corner) != view.corners.end())
      table.fail_in_row(i, number, "corner ", corner, " of image '", detail::printable(view.image), "' is there twice");
    view.corners.push_back(corner);
    view.pixels.emplace_back(values(i, 1), values(i, 2));
  }
  return out;
}

/// A name in a cell of a file whose cells have no quotes.
VERNIER_LOCAL const std::string& cell_of(const std::string& name) {
  demand(name.find_first_of(",;\t\r\n\"") == std::string::npos && !name.empty(), "the name '", detail::printable(name),
         "' cannot stand in a CSV file: it is empty, or has a separator, a quotation mark or a line end");
  return name;
}

VERNIER_IMPL std::string corners_text(const CornerViews& views) {
  const bool cameras = views.cameras != std::vector<std::string>{"camera"},
             boards = views.boards != std::vector<std::string>{"board"};
  const bool sized = std::all_of(views.views.begin(), views.views.end(),
                                 [](const View& view) { return view.width > 0 && view.height > 0; });
  std::string out = "image,";
  if (cameras) out += "camera,";
  if (boards) out += "board,";
  out += sized ? "corner,u_px,v_px,width_px,height_px\n" : "corner,u_px,v_px\n";
  const auto rounded = [](double pixel) { return std::round(pixel * 1e4) / 1e4; };
  for (const View& view : views.views)
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      out += cell_of(view.image) + ',';
      if (cameras) out += cell_of(views.cameras[static_cast<std::size_t>(view.camera)]) + ',';
      if (boards) out += cell_of(views.boards[static_cast<std::size_t>(view.board)]) + ',';
      out += message(view.corners[k], ',', rounded(view.pixels[k](0)), ',', rounded(view.pixels[k](1)));
      out += sized ? message(',', view.width, ',', view.height, '\n') : "\n";
    }
  return out;
}

VERNIER_IMPL std::string image_joints_text(const ImageRows& rows, std::span<const JointType> types) {
  demand(rows.joints.rows() == rows.size() && (types.empty() || static_cast<Index>(types.size()) == rows.joints.cols()),
         "image_joints_text: ", rows.size(), " images, ", rows.joints.rows(), " rows of ", rows.joints.cols(),
         " joints, ", types.size(), " types");
  std::string out = "image";
  for (Index j = 0; j < rows.joints.cols(); ++j) {
    const bool angle = types.empty() || types[static_cast<std::size_t>(j)] == JointType::revolute;
    out += message(",q", j + 1, angle ? "_rad" : "_m");
  }
  out += '\n';
  for (Index i = 0; i < rows.size(); ++i) {
    out += cell_of(rows.images[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < rows.joints.cols(); ++j) out += message(',', rows.joints(i, j));
    out += '\n';
  }
  return out;
}

VERNIER_IMPL ImageRows read_image_joints(const std::string& path, int joints, std::span<const JointType> types,
                                         const CsvFormat& format) {
  CsvFormat quiet = format;  // the other reader tells of columns that nobody reads
  quiet.remark = [](const std::string&) {};
  const detail::CsvTable table(path, quiet);
  ImageRows out;
  out.images = detail::image_names(table);
  out.origin = table.origin();
  out.joints = detail::read_joint_columns(path, joints, types, format);
  return out;
}

VERNIER_IMPL ImageRows read_flange_poses(const std::string& path, const CsvFormat& format) {
  const detail::CsvTable table(path, format);
  ImageRows out;
  out.images = detail::image_names(table);
  out.origin = table.origin();
  std::vector<detail::CsvColumn> columns;
  for (const char* axis : {"x", "y", "z"})
    columns.push_back(table.require_column(axis, detail::quantities::coordinate));
  for (const char* axis : {"rx", "ry", "rz"})
    columns.push_back(table.require_column(axis, detail::quantities::rotation_angle));
  const MatrixX values = table.numbers(columns);
  table.remark_unread();
  for (Index i = 0; i < values.rows(); ++i)
    out.flanges.push_back(rigid_motion(exp_so3(Vector3(values(i, 3), values(i, 4), values(i, 5))),
                                       Vector3(values(i, 0), values(i, 1), values(i, 2))));
  return out;
}

VERNIER_IMPL MatchedViews match_images(const CornerViews& views, const ImageRows& rows) {
  std::map<std::string, Index> row_of;
  for (std::size_t i = 0; i < rows.images.size(); ++i) row_of.emplace(rows.images[i], static_cast<Index>(i));
  MatchedViews out;
  std::vector<bool> seen(rows.images.size(), false);
  for (std::size_t v = 0; v < views.views.size(); ++v) {
    const std::string& image = views.views[v].image;
    const auto found = row_of.find(image);
    if (found == row_of.end()) {
      if (out.without_row.empty() || out.without_row.back() != image) out.without_row.push_back(image);
      continue;
    }
    out.views.push_back(v);
    out.rows.push_back(found->second);
    seen[static_cast<std::size_t>(found->second)] = true;
  }
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (!seen[i]) out.without_corners.push_back(rows.images[i]);
  if (out.views.empty() && !views.views.empty() && !rows.images.empty())
    throw DataError(message(views.file, ": no image is in the other file: '", views.views.front().image, "' is here, '",
                            rows.images.front(), "' is there"));
  return out;
}

}  // namespace vernier
