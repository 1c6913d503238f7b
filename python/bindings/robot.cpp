// SPDX-License-Identifier: BSD-3-Clause
#include "robot.hpp"

#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <optional>

#include "arrays.hpp"
#include "bind.hpp"
#include "robot_of.hpp"
#include "vernier/core/check.hpp"

namespace python {

namespace {

namespace vn = vernier;

constexpr int pickle_schema = 1;

/// Answers of inverse kinematics.
struct IkAnswer {
  Array joints, position_error, rotation_error;
  std::vector<vn::IkStatus> status;
  bool single;
};

const char* word(vn::IkStatus status) {
  return status == vn::IkStatus::converged ? "converged" : status == vn::IkStatus::stalled ? "stalled" : "unreachable";
}

Array frame_of(const vn::Isometry3& frame) { return array_of(vn::MatrixX(frame.matrix())); }

vn::Isometry3 frame_of(const py::object& object, const char* name) {
  const Rows rows = poses(object, name);
  vn::Isometry3 out;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) out.matrix()(r, c) = rows.view().row(0)[4 * r + c];
  return out;
}

vn::JointType type_of(const std::string& word) {
  vn::demand(word == "revolute" || word == "prismatic", "joint_types: '", word, "' is neither revolute nor prismatic");
  return word == "revolute" ? vn::JointType::revolute : vn::JointType::prismatic;
}

std::vector<std::string> words(const std::vector<vn::JointType>& types) {
  std::vector<std::string> out;
  for (const vn::JointType type : types) out.push_back(type == vn::JointType::revolute ? "revolute" : "prismatic");
  return out;
}

Robot load(const py::object& name_or_file, const std::string& base_link, const std::string& tip_link) {
  std::vector<std::string> remarks;
  vn::RobotDescription about = support::robot_of(path_of(name_or_file), base_link, tip_link, remarks);
  return Robot(std::move(about), std::move(remarks));
}

Robot from_rows(const std::string& name, const py::object& rows, const py::object& limits, bool modified,
                const std::vector<std::string>& joint_types, const py::object& base, const py::object& tool) {
  const Array table = numbers(rows, "rows");
  vn::demand(table.ndim() == 2 && (table.shape(1) == 4 || table.shape(1) == 5),
             "rows: an array of shape (joints, 4) or (joints, 5) is expected: a, alpha, d, theta, beta");
  const Rows parameters(rows, "rows", table.shape(1));
  vn::RobotDescription about{name, modified, {}, {}, {}};
  for (vn::Index i = 0; i < parameters.size(); ++i) {
    const double* p = parameters.view().row(i);
    about.rows.push_back({p[0], p[1], p[2], p[3], table.shape(1) == 5 ? p[4] : 0, vn::JointType::revolute});
    about.limits.emplace_back(-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity());
  }
  about.drives.resize(about.rows.size());
  vn::demand(joint_types.empty() || joint_types.size() == about.rows.size(), "joint_types: ", joint_types.size(),
             " types of ", about.rows.size(), " joints");
  for (std::size_t i = 0; i < joint_types.size(); ++i) about.rows[i].joint = type_of(joint_types[i]);
  if (!limits.is_none()) {
    const Rows of_joints(limits, "limits", 2, Values::any);
    vn::demand(of_joints.size() == parameters.size(), "limits: ", of_joints.size(), " rows of ", about.rows.size(),
               " joints");
    for (vn::Index i = 0; i < of_joints.size(); ++i) {
      const double* p = of_joints.view().row(i);
      vn::demand(p[0] < p[1], "limits: row ", i, ": the lower limit ", p[0], " is not below the upper one ", p[1]);
      about.limits[static_cast<std::size_t>(i)] = {p[0], p[1]};
    }
  }
  if (!base.is_none()) about.base = frame_of(base, "base");
  if (!tool.is_none()) about.tool = frame_of(tool, "tool");
  return Robot(std::move(about));
}

Array limits_of(const Robot& robot) {
  vn::MatrixX out(static_cast<vn::Index>(robot.about.limits.size()), 2);
  for (vn::Index i = 0; i < out.rows(); ++i) {
    out(i, 0) = robot.about.limits[static_cast<std::size_t>(i)].first;
    out(i, 1) = robot.about.limits[static_cast<std::size_t>(i)].second;
  }
  return array_of(out);
}

/// Evaluates rows of joint values, the interpreter's lock released, on several threads.
template <class F>
Array over_rows(const Robot& robot, const py::object& q, std::vector<vn::Index> shape, const F& f) {
  const Rows rows(q, "q", robot.arm->joints());
  Array out = new_array(rows.single(), rows.size(), std::move(shape));
  double* to = out.mutable_data();
  const py::gil_scoped_release release;
  const vn::ThreadExecutor executor(threads_for(rows.size(), 30'000));
  f(rows.view(), to, executor);
  return out;
}

IkAnswer ik(const Robot& robot, const py::object& pose, const py::object& q0, const std::optional<bool>& position_only,
            double tolerance, int restarts) {
  const Rows targets = poses(pose, "T"), seeds(q0, "q0", robot.arm->joints());
  vn::demand(seeds.size() == 1 || seeds.size() == targets.size(), "q0: ", seeds.size(), " rows for ", targets.size(),
             " poses");
  vn::demand(tolerance > 0 && restarts >= 0, "ik: tolerance is ", tolerance, " and restarts is ", restarts,
             "; the first must be positive, the second not negative");
  const vn::Index n = targets.size();
  IkAnswer out{new_array(targets.single(), n, {robot.arm->joints()}), Array(n), Array(n),
               std::vector<vn::IkStatus>(static_cast<std::size_t>(n)), targets.single()};
  const support::IkRows to{out.joints.mutable_data(), out.status.data(), out.position_error.mutable_data(),
                           out.rotation_error.mutable_data()};
  const support::IkSettings settings{position_only.value_or(robot.arm->joints() < 6), tolerance, restarts};
  const py::gil_scoped_release release;
  const vn::ThreadExecutor executor(threads_for(n, 200));
  robot.arm->inverse(targets.view(), seeds.view(), settings, to, executor);
  return out;
}

py::object branches(const Robot& robot, const py::object& pose, const py::object& close_to,
                    const std::optional<int>& held) {
  const Rows target = poses(pose, "T");
  vn::demand(target.single(), "branches: one pose of shape (4, 4) is expected");
  Rows near_to;
  if (!close_to.is_none()) near_to = Rows(close_to, "close_to", robot.arm->joints());
  vn::demand(!held || (near_to.size() == 1 && *held >= 0 && *held < robot.arm->joints()),
             "branches: `held` is a joint, from 0, and stays at its value in `close_to`");
  const support::BranchRows found = robot.arm->branches(target.view().data, near_to.view().data, held.value_or(-1));
  vn::MatrixX joints(static_cast<vn::Index>(found.joints.size()), robot.arm->joints());
  for (vn::Index i = 0; i < joints.rows(); ++i)
    for (vn::Index j = 0; j < joints.cols(); ++j)
      joints(i, j) = found.joints[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return py::module_::import("vernier.results")
      .attr("Branches")(array_of(joints), py::cast(found.within_limits), py::cast(found.branch), found.reach);
}

py::tuple state_of(const Robot& robot) {
  const vn::RobotDescription& about = robot.about;
  py::list rows, drives, files;
  for (const vn::DhRow& row : about.rows)
    rows.append(py::make_tuple(row.a, row.alpha, row.d, row.theta, row.beta, row.joint == vn::JointType::revolute));
  for (const vn::JointDrive& drive : about.drives)
    drives.append(py::make_tuple(drive.gear_ratio, drive.encoder_periods));
  for (const vn::SourceFile& file : about.files) files.append(py::make_tuple(file.name, file.hash));
  py::object controller = py::none();
  if (!about.controller.same()) controller = py::cast(about.controller.formulas(about.joint_types()));
  return py::make_tuple(
      pickle_schema, about.name, about.modified, rows, py::cast(about.limits), drives, frame_of(about.base),
      frame_of(about.tool), about.joint_names, files, controller, about.base_known, about.tool_known,
      py::make_tuple(about.down.x(), about.down.y(), about.down.z()), robot.remarks, about.controller.motor_errors());
}

Robot robot_of_state(const py::tuple& state) {
  vn::demand(state.size() == 16 && state[0].cast<int>() == pickle_schema,
             "Robot: pickled by another version of this module");
  vn::RobotDescription about{state[1].cast<std::string>(), state[2].cast<bool>(), {}, {}, {}};
  for (const py::handle& item : state[3].cast<py::list>()) {
    const auto row = item.cast<py::tuple>();
    about.rows.push_back({row[0].cast<double>(), row[1].cast<double>(), row[2].cast<double>(), row[3].cast<double>(),
                          row[4].cast<double>(),
                          row[5].cast<bool>() ? vn::JointType::revolute : vn::JointType::prismatic});
  }
  about.limits = state[4].cast<std::vector<std::pair<double, double>>>();
  for (const py::handle& item : state[5].cast<py::list>()) {
    const auto drive = item.cast<py::tuple>();
    about.drives.push_back({drive[0].cast<double>(), drive[1].cast<int>()});
  }
  about.base = frame_of(state[6], "base");
  about.tool = frame_of(state[7], "tool");
  about.joint_names = state[8].cast<std::vector<std::string>>();
  for (const py::handle& item : state[9].cast<py::list>()) {
    const auto file = item.cast<py::tuple>();
    about.files.push_back({file[0].cast<std::string>(), file[1].cast<std::string>()});
  }
  if (!state[10].is_none())
    about.controller = vn::ControllerMap(state[10].cast<std::vector<std::string>>(), about.joint_types())
                           .with_motor_errors(state[15].cast<bool>());
  about.base_known = state[11].cast<bool>();
  about.tool_known = state[12].cast<bool>();
  const auto down = state[13].cast<py::tuple>();
  about.down = vn::Vector3(down[0].cast<double>(), down[1].cast<double>(), down[2].cast<double>());
  return Robot(std::move(about), state[14].cast<std::vector<std::string>>());
}

}  // namespace

void bind_robot(py::module_& module) {
  py::class_<IkAnswer>(module, "IkResult",
                       "Joint values that reach poses, the nearest ones where a pose is out of reach.")
      .def_property_readonly(
          "joints", [](const IkAnswer& a) { return a.joints; }, "Joint values [rad, m].")
      .def_property_readonly(
          "converged",
          [](const IkAnswer& a) -> py::object {
            if (a.single) return py::bool_(a.status.front() == vn::IkStatus::converged);
            py::array_t<bool> out(static_cast<py::ssize_t>(a.status.size()));
            for (std::size_t i = 0; i < a.status.size(); ++i)
              out.mutable_data()[i] = a.status[i] == vn::IkStatus::converged;
            return out;
          },
          "Whether each pose is reached: a bool, or an array of them.")
      .def_property_readonly(
          "status",
          [](const IkAnswer& a) -> py::object {
            if (a.single) return py::str(word(a.status.front()));
            py::list out;
            for (const vn::IkStatus status : a.status) out.append(word(status));
            return out;
          },
          "converged, stalled or unreachable, in words.")
      .def_property_readonly(
          "position_error", [](const IkAnswer& a) { return a.position_error; }, "Distance from each pose [m].")
      .def_property_readonly(
          "rotation_error", [](const IkAnswer& a) { return a.rotation_error; }, "Angle to each pose [rad].")
      .def("__repr__", [](const IkAnswer& a) {
        std::size_t met = 0;
        for (const vn::IkStatus status : a.status) met += status == vn::IkStatus::converged;
        return vn::message("<vernier.IkResult: ", met, " of ", a.status.size(), " poses reached>");
      });

  py::class_<Robot>(module, "Robot", "An arm as designed: a chain between base and tool frames, with joint limits.")
      .def_static(
          "load", &load, py::arg("name_or_file"), py::kw_only(), py::arg("base_link") = "", py::arg("tip_link") = "",
          "An arm by its name in the catalogue, or of a file: JSON, URDF (.urdf), or the kinematics of Universal "
          "Robots' driver (.yaml). Links are those of a URDF file where the arm begins and ends.")
      .def_static(
          "from_rows", &from_rows, py::arg("name"), py::arg("rows"), py::kw_only(), py::arg("limits") = py::none(),
          py::arg("modified") = false, py::arg("joint_types") = std::vector<std::string>(),
          py::arg("base") = py::none(), py::arg("tool") = py::none(),
          "An arm of Denavit-Hartenberg rows a, alpha, d, theta (and Hayati's beta) [m, rad], in the standard or "
          "Craig's modified convention.")
      .def_static(
          "catalogue",
          [] {
            std::vector<std::string> out;
            for (const auto& robot : support::robot_catalogue()) out.push_back(robot.name);
            return out;
          },
          "Names of the arms that `load` knows.")
      .def_property_readonly(
          "name", [](const Robot& r) { return r.about.name; }, "Its name.")
      .def_property_readonly(
          "joints", [](const Robot& r) { return r.arm->joints(); },
          "Number of joints of its controller: columns of joint values.")
      .def_property_readonly(
          "joint_types", [](const Robot& r) { return words(r.about.controller.types(r.about.joint_types())); },
          "revolute [rad] or prismatic [m], of each joint.")
      .def_property_readonly("limits", &limits_of, "Lower and upper joint limits, (joints, 2) [rad, m].")
      .def_property_readonly(
          "remarks", [](const Robot& r) { return r.remarks; }, "What was ignored in its file, a sentence each.")
      .def(
          "fk",
          [](const Robot& r, const py::object& q) {
            return over_rows(r, q, {4, 4}, [&](auto rows, double* out, auto& e) { r.arm->poses(rows, out, e); });
          },
          py::arg("q"), "Poses of the tool at joint values: (4, 4) of one configuration, (n, 4, 4) of n.")
      .def(
          "positions",
          [](const Robot& r, const py::object& q) {
            return over_rows(r, q, {3}, [&](auto rows, double* out, auto& e) { r.arm->positions(rows, out, e); });
          },
          py::arg("q"), "Positions of the tool [m]: (3,) of one configuration, (n, 3) of n.")
      .def(
          "jacobian",
          [](const Robot& r, const py::object& q) {
            return over_rows(r, q, {6, r.arm->joints()},
                             [&](auto rows, double* out, auto& e) { r.arm->jacobians(rows, out, e); });
          },
          py::arg("q"),
          "Geometric Jacobians at the tool point in the base frame, linear rows first: (6, joints), or (n, 6, joints).")
      .def("ik", &ik, py::arg("T"), py::arg("q0"), py::kw_only(), py::arg("position_only") = py::none(),
           py::arg("tolerance") = 1e-9, py::arg("restarts") = 0,
           "Joint values that bring the tool to poses, near q0 and within limits. Arms of fewer than six joints reach "
           "positions alone, unless told otherwise.")
      .def("branches", &branches, py::arg("T"), py::kw_only(), py::arg("close_to") = py::none(),
           py::arg("held") = py::none(),
           "All joint values that bring the tool to a pose, of an arm of six revolute joints that move. Of seven, one "
           "is "
           "held at its value in close_to.")
      .def("__repr__",
           [](const Robot& r) {
             return vn::message("<vernier.Robot '", r.about.name, "': ", r.arm->joints(), " joints, ",
                                r.about.modified ? "modified" : "standard", " Denavit-Hartenberg rows>");
           })
      .def(py::pickle(&state_of, &robot_of_state));
}

}  // namespace python
