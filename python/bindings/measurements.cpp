// SPDX-License-Identifier: BSD-3-Clause
#include "measurements.hpp"

#include <pybind11/stl.h>

#include <map>
#include <set>

#include "arrays.hpp"
#include "bind.hpp"
#include "robot.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"

namespace python {

namespace {

namespace vn = vernier;
using support::MeasuredDistances;
using support::MeasuredPoses;

constexpr int pickle_schema = 1;

using Columns = std::map<std::string, std::string>;  // our names, and those of the file

vn::CsvFormat format_of(const std::string& separator, const std::string& decimal, const Columns& columns) {
  vn::demand(separator.size() == 1 && decimal.size() == 1, "read: separator and decimal are one character each");
  return {.separator = separator[0], .decimal = decimal[0], .columns = {columns.begin(), columns.end()}};
}

/// Rotation vectors, from arrays (n, 3) of them or (n, 3, 3) of matrices.
vn::PointRows rotation_vectors(const py::object& object, vn::Index n) {
  Array array = numbers(object, "orientations");
  if (array.ndim() == 3 && array.shape(1) == 3 && array.shape(2) == 3) {
    const Rows rows = Rows::of(Array(array.reshape({array.shape(0), py::ssize_t{9}})), "orientations", false);
    vn::PointRows out(rows.size(), 3);
    for (vn::Index i = 0; i < rows.size(); ++i) {
      vn::Matrix3 turn;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) turn(r, c) = rows.view().row(i)[3 * r + c];
      vn::demand((turn * turn.transpose() - vn::Matrix3::Identity()).norm() < 1e-6 && turn.determinant() > 0,
                 "orientations: row ", i, " is no rotation");
      out.row(i) = vn::log_so3(turn).transpose();
    }
    return out;
  }
  const Rows rows(object, "orientations", 3);
  vn::demand(rows.size() == n, "orientations: ", rows.size(), " rows of ", n, " poses");
  return matrix_of(rows);
}

/// Covariances, (n, 3, 3) of positions alone or (n, 6, 6).
std::vector<vn::Matrix6> covariances_of(const py::object& object) {
  const Array array = numbers(object, "covariances");
  vn::demand(array.ndim() == 3 && array.shape(1) == array.shape(2) && (array.shape(1) == 3 || array.shape(1) == 6),
             "covariances: an array of shape (n, 3, 3) or (n, 6, 6) is expected");
  const int size = static_cast<int>(array.shape(1));
  std::vector<vn::Matrix6> out(static_cast<std::size_t>(array.shape(0)), vn::Matrix6::Identity());
  const double* at = array.data();
  for (vn::Matrix6& covariance : out)
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c) covariance(r, c) = *at++;
  return out;
}

/// Names of reflectors: texts or whole numbers.
std::vector<std::string> points_of(const py::object& object, vn::Index n) {
  std::vector<std::string> out;
  vn::demand(!py::isinstance<py::str>(object) && py::isinstance<py::iterable>(object),
             "points: a name or a number a row is expected");
  for (const py::handle& item : object) {
    vn::demand(py::isinstance<py::str>(item) || PyIndex_Check(item.ptr()), "points: row ", out.size(),
               " is neither a name nor a whole number");
    out.push_back(py::str(item));
  }
  vn::demand(static_cast<vn::Index>(out.size()) == n, "points: ", out.size(), " names of ", n, " rows");
  return out;
}

Measurements of_arrays(const py::object& joints, const py::object& positions, const py::object& orientations,
                       const py::object& covariances, const py::object& times, const py::object& previous,
                       const py::object& temperatures, const py::object& payloads, const py::object& points,
                       const std::string& name) {
  const Array q = numbers(joints, "joints");
  vn::demand(q.ndim() == 2 && q.shape(1) >= 1, "joints: an array of shape (n, joints) is expected");
  MeasuredPoses out;
  out.joints = matrix_of(Rows(joints, "joints", q.shape(1)));
  const vn::Index n = out.joints.rows();
  out.positions = matrix_of(Rows(positions, "positions", 3));
  if (!orientations.is_none()) out.orientations = rotation_vectors(orientations, n);
  if (!covariances.is_none()) out.covariances = covariances_of(covariances);
  if (!times.is_none()) out.times = vector_of(times, "times", n);
  if (!previous.is_none()) out.previous = matrix_of(Rows(previous, "previous", q.shape(1), Values::any));
  if (!temperatures.is_none()) out.temperatures = vector_of(temperatures, "temperatures", n);
  if (!payloads.is_none()) out.payloads = matrix_of(Rows(payloads, "payloads", 4, Values::any));
  if (!points.is_none()) out.points = points_of(points, n);
  out.name = name;
  support::validate(out);
  return {{{std::move(out)}, {}, {}}};
}

Measurements of_distances(const py::object& joints, const py::object& lengths, const std::string& name) {
  const Array q = numbers(joints, "joints");
  vn::demand(q.ndim() == 2 && q.shape(1) >= 1, "joints: an array of shape (n, joints) is expected");
  MeasuredDistances out;
  out.joints = matrix_of(Rows(joints, "joints", q.shape(1)));
  out.lengths = vector_of(lengths, "lengths", out.joints.rows());
  for (vn::Index i = 0; i < out.lengths.size(); ++i)
    vn::demand(out.lengths(i) > 0, "lengths: row ", i, " is ", out.lengths(i), ", must be positive");
  out.name = name;
  return {{{}, {std::move(out)}, {}}};
}

Measurements read(const py::object& path, const Robot& robot, const std::string& separator, const std::string& decimal,
                  const Columns& columns) {
  const vn::CsvFormat format = format_of(separator, decimal, columns);
  return {{{support::read_measured_poses(path_of(path), robot.about, format)}, {}, {}}};
}
Measurements read_distances(const py::object& path, const Robot& robot, const std::string& separator,
                            const std::string& decimal, const Columns& columns) {
  const vn::CsvFormat format = format_of(separator, decimal, columns);
  return {{{}, {support::read_measured_distances(path_of(path), robot.about, format)}, {}}};
}
Measurements read_contacts(const py::object& path, const Robot& robot, const std::string& separator,
                           const std::string& decimal, const Columns& columns) {
  const vn::CsvFormat format = format_of(separator, decimal, columns);
  return {{{}, {}, support::read_measured_contacts(path_of(path), robot.about, format)}};
}

Measurements joined(const Measurements& a, const Measurements& b) {
  Measurements out = a;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(out.data.stations, b.data.stations);
  append(out.data.distances, b.data.distances);
  append(out.data.contacts, b.data.contacts);
  return out;
}

vn::Index size_of(const Measurements& m) {
  vn::Index out = 0;
  for (const MeasuredPoses& poses : m.data.stations) out += poses.size();
  for (const MeasuredDistances& distances : m.data.distances) out += distances.lengths.size();
  for (const vn::Contact& contact : m.data.contacts) out += contact.size();
  return out;
}

/// The poses of measurements that are nothing else and are from one station.
const MeasuredPoses& only_poses(const Measurements& m) {
  vn::demand(m.data.stations.size() == 1 && m.data.distances.empty() && m.data.contacts.empty(),
             "Measurements: ", m.data.stations.size(), " stations, ", m.data.distances.size(), " sets of distances, ",
             m.data.contacts.size(), " touched objects; this is of the poses of one station");
  return m.data.stations.front();
}

Measurements rows_of(const Measurements& m, const py::object& rows) {
  const MeasuredPoses& poses = only_poses(m);
  return {{{support::rows_of(poses, row_numbers(rows, "rows", poses.size()))}, {}, {}}};
}

void write(const Measurements& m, const py::object& path, const Robot& robot) {
  vn::demand(only_poses(m).joints.cols() == robot.arm->joints(), "write: measurements of ", only_poses(m).joints.cols(),
             " joints, ", robot.about.name, " has ", robot.arm->joints());
  support::write_measured_poses(path_of(path), only_poses(m), robot.about);
}

std::string shown(const Measurements& m) {
  std::string out = "<vernier.Measurements:";
  const auto part = [&](const std::string& text) { out += (out.back() == ':' ? " " : ", ") + text; };
  for (const MeasuredPoses& poses : m.data.stations) {
    const std::set<std::string> points(poses.points.begin(), poses.points.end());
    part(vn::message(poses.size(), poses.orientations.rows() > 0 ? " poses" : " positions", " of ", poses.joints.cols(),
                     " joints"));
    if (points.size() > 1) out += vn::message(" and ", points.size(), " reflectors");
  }
  for (const MeasuredDistances& distances : m.data.distances) part(vn::message(distances.lengths.size(), " distances"));
  for (const vn::Contact& contact : m.data.contacts) part(vn::message(contact.size(), " touches of ", contact.name()));
  return out + ">";
}

py::tuple state_of_origin(const vn::RowOrigin& origin) {
  return py::make_tuple(origin.files, origin.file, origin.line, origin.hashes);
}
vn::RowOrigin origin_of_state(const py::handle& object) {
  const auto state = object.cast<py::tuple>();
  vn::RowOrigin out;
  out.files = state[0].cast<std::vector<std::string>>();
  out.file = state[1].cast<std::vector<int>>();
  out.line = state[2].cast<std::vector<vn::Index>>();
  out.hashes = state[3].cast<std::vector<std::string>>();
  return out;
}

Array covariances_array(const MeasuredPoses& poses) {
  Array out({static_cast<py::ssize_t>(poses.covariances.size()), py::ssize_t{6}, py::ssize_t{6}});
  double* at = out.mutable_data();
  for (const vn::Matrix6& covariance : poses.covariances)
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) *at++ = covariance(r, c);
  return out;
}

py::tuple state_of(const Measurements& m) {
  py::list stations, distances, contacts;
  for (const MeasuredPoses& p : m.data.stations)
    stations.append(py::make_tuple(array_of(p.joints), array_of(vn::MatrixX(p.positions)),
                                   array_of(vn::MatrixX(p.orientations)), array_of(p.previous), array_of(p.times),
                                   array_of(p.temperatures), array_of(p.payloads), covariances_array(p),
                                   state_of_origin(p.origin), p.name, p.points));
  for (const MeasuredDistances& d : m.data.distances)
    distances.append(py::make_tuple(array_of(d.joints), array_of(d.lengths), state_of_origin(d.origin), d.name));
  for (const vn::Contact& c : m.data.contacts)
    contacts.append(py::make_tuple(c.name(), static_cast<int>(c.kind()), array_of(c.joints()), array_of(c.known()),
                                   state_of_origin(c.origin())));
  return py::make_tuple(pickle_schema, stations, distances, contacts);
}

vn::MatrixX matrix_of_state(const py::handle& object) {
  const auto array = object.cast<Array>();
  vn::MatrixX out(array.shape(0), array.shape(1));
  for (vn::Index i = 0; i < out.rows(); ++i)
    for (vn::Index k = 0; k < out.cols(); ++k) out(i, k) = array.at(i, k);
  return out;
}
vn::VectorX vector_of_state(const py::handle& object) {
  const auto array = object.cast<Array>();
  return Eigen::Map<const vn::VectorX>(array.data(), array.size());
}

Measurements of_state(const py::tuple& state) {
  vn::demand(state.size() == 4 && state[0].cast<int>() == pickle_schema,
             "Measurements: pickled by another version of this module");
  Measurements out;
  for (const py::handle& item : state[1].cast<py::list>()) {
    const auto s = item.cast<py::tuple>();
    MeasuredPoses p;
    p.joints = matrix_of_state(s[0]);
    p.positions = matrix_of_state(s[1]);
    p.orientations = matrix_of_state(s[2]);
    p.previous = matrix_of_state(s[3]);
    p.times = vector_of_state(s[4]);
    p.temperatures = vector_of_state(s[5]);
    p.payloads = matrix_of_state(s[6]);
    p.covariances = covariances_of(s[7]);
    p.origin = origin_of_state(s[8]);
    p.name = s[9].cast<std::string>();
    p.points = s[10].cast<std::vector<std::string>>();
    support::validate(p);
    out.data.stations.push_back(std::move(p));
  }
  for (const py::handle& item : state[2].cast<py::list>()) {
    const auto s = item.cast<py::tuple>();
    out.data.distances.push_back(
        {matrix_of_state(s[0]), vector_of_state(s[1]), origin_of_state(s[2]), s[3].cast<std::string>()});
  }
  for (const py::handle& item : state[3].cast<py::list>()) {
    const auto s = item.cast<py::tuple>();
    const vn::Contact contact(s[0].cast<std::string>(), static_cast<vn::ContactKind>(s[1].cast<int>()),
                              matrix_of_state(s[2]), vector_of_state(s[3]));
    out.data.contacts.push_back(contact.from(origin_of_state(s[4])));
  }
  return out;
}

}  // namespace

void bind_measurements(py::module_& module) {
  const auto none = py::none();
  py::class_<Measurements>(module, "Measurements",
                           "Measured poses of an arm, distances and touches. Joint values are those of the controller "
                           "[rad, m], positions in metres, rows in the order of measuring.")
      .def(py::init(&of_arrays), py::arg("joints"), py::arg("positions"), py::kw_only(), py::arg("orientations") = none,
           py::arg("covariances") = none, py::arg("times") = none, py::arg("previous") = none,
           py::arg("temperatures") = none, py::arg("payloads") = none, py::arg("points") = none, py::arg("name") = "",
           "Poses from one station: joints (n, joints), positions (n, 3), orientations as rotation vectors (n, 3) or "
           "matrices (n, 3, 3), covariances (n, 3, 3) or (n, 6, 6). previous has the joint values from which each pose "
           "was approached, NaN where unknown; without it, those of the row before. points names the reflector of each "
           "row, where there are several.")
      .def_static("from_distances", &of_distances, py::arg("joints"), py::arg("lengths"), py::kw_only(),
                  py::arg("name") = "", "Distances of the tool point from one fixed point [m].")
      .def_static("read", &read, py::arg("path"), py::arg("robot"), py::kw_only(), py::arg("separator") = ",",
                  py::arg("decimal") = ".", py::arg("columns") = Columns(),
                  "Poses of a CSV file: columns q1_rad .., x_mm, y_mm, z_mm, rx_rad .., point .. Columns that the file "
                  "calls otherwise are stated by columns={'q1_deg': 'A1', ..}.")
      .def_static("read_distances", &read_distances, py::arg("path"), py::arg("robot"), py::kw_only(),
                  py::arg("separator") = ",", py::arg("decimal") = ".", py::arg("columns") = Columns(),
                  "Distances of a CSV file.")
      .def_static("read_contacts", &read_contacts, py::arg("path"), py::arg("robot"), py::kw_only(),
                  py::arg("separator") = ",", py::arg("decimal") = ".", py::arg("columns") = Columns(),
                  "Touches of a CSV file.")
      .def_property_readonly(
          "joints", [](const Measurements& m) { return array_of(only_poses(m).joints); },
          "Joint values of the poses of one station (n, joints) [rad, m].")
      .def_property_readonly(
          "positions", [](const Measurements& m) { return array_of(vn::MatrixX(only_poses(m).positions)); },
          "Measured positions of one station (n, 3) [m].")
      .def_property_readonly(
          "orientations",
          [](const Measurements& m) -> py::object {
            if (only_poses(m).orientations.rows() == 0) return py::none();
            return array_of(vn::MatrixX(only_poses(m).orientations));
          },
          "Measured rotation vectors of one station (n, 3) [rad]; None where there are none.")
      .def_property_readonly(
          "points",
          [](const Measurements& m) -> py::object {
            if (only_poses(m).points.empty()) return py::none();
            return py::cast(only_poses(m).points);
          },
          "Names of the reflectors of one station's rows; None where all rows are of one.")
      .def_property_readonly(
          "stations",
          [](const Measurements& m) {
            std::vector<Measurements> out;
            for (const MeasuredPoses& poses : m.data.stations) out.push_back({{{poses}, {}, {}}});
            return out;
          },
          "The poses of each station.")
      .def("rows", &rows_of, py::arg("rows"),
           "The rows of one station whose numbers are given, in the given order; or those where an array of flags is "
           "True.")
      .def("write", &write, py::arg("path"), py::arg("robot"), "Writes the poses of one station as `read` reads them.")
      .def("__add__", &joined, py::arg("other"), "Measurements of both, stations one behind the other.")
      .def("__len__", &size_of)
      .def("__repr__", &shown)
      .def(py::pickle(&state_of, &of_state));
}

}  // namespace python
