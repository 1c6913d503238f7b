// SPDX-License-Identifier: BSD-3-Clause
#include "model.hpp"

#include <pybind11/stl.h>

#include <cmath>
#include <optional>

#include "arrays.hpp"
#include "bind.hpp"
#include "measurements.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/check.hpp"
#include "vernier/io/export_c.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/model_text.hpp"
#include "watch.hpp"

namespace python {

namespace {

namespace vn = vernier;

/// Corrected commands.
struct CorrectionAnswer {
  Array command, predicted_error, gate;
  std::vector<vn::IkStatus> status;
  bool single;

  CorrectionAnswer(bool one, vn::Index n, vn::Index joints)
      : command(new_array(one, n, {joints})),
        predicted_error(n),
        gate(n),
        status(static_cast<std::size_t>(n)),
        single(one) {}
  support::CorrectionRows rows() {
    return {command.mutable_data(), status.data(), predicted_error.mutable_data(), gate.mutable_data()};
  }
};

const char* word(vn::IkStatus status) {
  return status == vn::IkStatus::converged ? "converged" : status == vn::IkStatus::stalled ? "stalled" : "unreachable";
}
const char* word(vn::PointStatus status) {
  switch (status) {
    case vn::PointStatus::met: return "met";
    case vn::PointStatus::jump: return "jump";
    case vn::PointStatus::off_path: return "off_path";
    case vn::PointStatus::beyond_limits: return "beyond_limits";
    case vn::PointStatus::not_found: return "not_found";
    case vn::PointStatus::proven_out: return "proven_out";
    case vn::PointStatus::invalid_target: return "invalid_target";
  }
  return "";
}

Rows previous_of(const py::object& previous, const support::CalibratedArm& arm, vn::Index n) {
  if (previous.is_none()) return {};
  Rows out(previous, "previous", arm.joints(), Values::any);
  vn::demand(out.size() == n, "previous: ", out.size(), " rows of ", n);
  return out;
}

/// Evaluates rows of joint values, the interpreter's lock released, on several threads.
template <class F>
Array over_rows(const Model& model, const py::object& q, const py::object& previous, std::vector<vn::Index> shape,
                const F& f) {
  const Rows rows(q, "q", model.arm->joints()), from = previous_of(previous, *model.arm, rows.size());
  Array out = new_array(rows.single(), rows.size(), std::move(shape));
  double* to = out.mutable_data();
  const py::gil_scoped_release release;
  const vn::ThreadExecutor executor(threads_for(rows.size(), 3'000));
  f(rows.view(), from.view(), to, executor);
  return out;
}

CorrectionAnswer correct(const Model& model, const py::object& q, const py::object& previous, const py::object& seed) {
  if (seed.is_none()) {
    const Rows rows(q, "q", model.arm->joints()), from = previous_of(previous, *model.arm, rows.size());
    CorrectionAnswer out(rows.single(), rows.size(), model.arm->joints());
    const support::CorrectionRows to = out.rows();
    const py::gil_scoped_release release;
    const vn::ThreadExecutor executor(threads_for(rows.size(), 200));
    model.arm->correct(rows.view(), from.view(), to, executor);
    return out;
  }
  const Rows targets = poses(q, "T"), seeds(seed, "seed", model.arm->joints()),
             from = previous_of(previous, *model.arm, targets.size());
  vn::demand(seeds.size() == 1 || seeds.size() == targets.size(), "seed: ", seeds.size(), " rows for ", targets.size(),
             " poses");
  CorrectionAnswer out(targets.single(), targets.size(), model.arm->joints());
  const support::CorrectionRows to = out.rows();
  const py::gil_scoped_release release;
  const vn::ThreadExecutor executor(threads_for(targets.size(), 200));
  model.arm->correct_poses(targets.view(), seeds.view(), from.view(), to, executor);
  return out;
}

py::object correct_path(const Model& model, const py::object& joints, const py::object& given_poses,
                        const py::object& linear, const py::object& start, double tolerance, double max_joint_step,
                        bool approach, const py::object& progress) {
  vn::demand(!joints.is_none() || !given_poses.is_none(), "correct_path: joints, poses or both are the targets");
  support::PathTask task{.tolerance = tolerance, .max_joint_step = max_joint_step, .approach = approach};
  const bool by_poses = !given_poses.is_none();
  Rows targets, near_to;
  if (by_poses) targets = poses(given_poses, "poses");
  if (!joints.is_none()) near_to = Rows(joints, "joints", model.arm->joints(), by_poses ? Values::any : Values::finite);
  vn::demand(!by_poses || joints.is_none() || near_to.size() == targets.size(), "correct_path: ", near_to.size(),
             " rows of joints for ", targets.size(), " poses");
  task.poses = targets.view();
  task.joints = near_to.view();
  const vn::Index n = by_poses ? targets.size() : near_to.size();
  if (!linear.is_none()) task.linear = flags_of(linear, "linear", n);
  Rows from;
  if (!start.is_none()) {
    from = Rows(start, "start", model.arm->joints());
    vn::demand(from.size() == 1, "start: one row of joint values is expected");
    task.start.assign(from.view().data, from.view().data + model.arm->joints());
  }
  support::PathRows path;
  watched(
      progress, 1, 0,
      [&](const vn::FitOptions& fit) {
        task.observer = fit.observer;
        path = model.arm->correct_path(task);
      },
      Steps::stated);
  Array commands({static_cast<py::ssize_t>(path.target.size()), static_cast<py::ssize_t>(model.arm->joints())},
                 path.commands.data());
  py::list status;
  for (const vn::PointStatus each : path.status) status.append(word(each));
  return py::module_::import("vernier.results")
      .attr("CorrectedPath")(commands, path.target, path.inserted, status, array_of(path.predicted_error),
                             array_of(path.deviation), path.before, path.after);
}

Array covariance(const Model& model, const py::object& q, const py::object& previous) {
  const Rows rows(q, "q", model.arm->joints()), from = previous_of(previous, *model.arm, rows.size());
  Array out = new_array(rows.single(), rows.size(), {6, 6});
  double* to = out.mutable_data();
  const py::gil_scoped_release release;
  model.arm->covariances(rows.view(), from.view(), to);
  return out;
}

py::object verify(const Model& model, const Measurements& measured, bool base, bool tool, double level,
                  const std::optional<double>& accept, bool use_orientations) {
  vn::demand(measured.data.stations.size() == 1 && measured.data.distances.empty() && measured.data.contacts.empty(),
             "verify: the poses of one station are expected");
  const support::MeasuredPoses& poses = measured.data.stations.front();
  vn::demand(poses.joints.cols() == model.arm->joints(), "verify: measurements of ", poses.joints.cols(), " joints, ",
             model.arm->name(), " has ", model.arm->joints());
  vn::demand(!accept || *accept > 0, "accept is ", accept.value_or(0), ", must be positive");
  vn::VerifyOptions options{.base = base, .tool = tool, .level = level, .accept = accept};
  options.sensors.use_orientations = use_orientations;
  vn::VerificationReport report;
  std::string html;
  watched(py::none(), 1, 0, [&](const vn::FitOptions&) { report = model.arm->verify(poses, options); });
  py::dict joints;
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    py::dict joint;
    joint["determined"] = report.joints[j].determined;
    joint["zero_change"] = report.joints[j].zero_change;
    joint["zero_std"] = report.joints[j].zero_std;
    joint["zero_changed"] = report.joints[j].zero_changed;
    joint["transmission_changed"] = report.joints[j].transmission_changed;
    joints[py::int_(j)] = joint;
  }
  return py::module_::import("vernier.results")
      .attr("Verification")(report.valid, report.consistent, report.verdict(), report.advice(), report.summary(),
                            array_of(report.errors), report.p_value, joints);
}

std::string export_c(const Model& model, const std::string& name) {
  const std::string text = model.arm->text();
  return vn::c_source(vn::parse_model(text, model.arm->name()), {.name = name});
}

std::string shown(const Model& model) {
  const vn::Provenance& from = model.arm->provenance();
  std::string out = vn::message("<vernier.Model '", model.arm->name(), "': ", model.arm->joints(),
                                " joints, fitted to ", from.rows, " ", from.measured);
  if (from.held_out_error > 0)
    out += vn::message(", held-out error ", std::round(from.held_out_error * 1e6) / 1e3, " mm");
  return out + ">";
}

}  // namespace

Model model_of_text(const std::string& text, const std::string& name) {
  return {support::calibrated_arm(vn::parse_model(text, name))};
}

void bind_model(py::module_& module) {
  py::class_<CorrectionAnswer>(module, "Correction", "Corrected commands and what the model predicts of them.")
      .def_property_readonly(
          "command", [](const CorrectionAnswer& c) { return c.command; }, "Joint values to send to the arm [rad, m].")
      .def_property_readonly(
          "predicted_error", [](const CorrectionAnswer& c) { return c.predicted_error; },
          "Distance from each target that the model predicts [m].")
      .def_property_readonly(
          "gate", [](const CorrectionAnswer& c) { return c.gate; },
          "Share of what was learned that was used: 1 inside the measured joint ranges.")
      .def_property_readonly(
          "converged",
          [](const CorrectionAnswer& c) -> py::object {
            if (c.single) return py::bool_(c.status.front() == vn::IkStatus::converged);
            py::array_t<bool> out(static_cast<py::ssize_t>(c.status.size()));
            for (std::size_t i = 0; i < c.status.size(); ++i)
              out.mutable_data()[i] = c.status[i] == vn::IkStatus::converged;
            return out;
          },
          "Whether each target is met: a bool, or an array of them.")
      .def_property_readonly(
          "status",
          [](const CorrectionAnswer& c) -> py::object {
            if (c.single) return py::str(word(c.status.front()));
            py::list out;
            for (const vn::IkStatus status : c.status) out.append(word(status));
            return out;
          },
          "converged, stalled or unreachable, in words.")
      .def("__repr__", [](const CorrectionAnswer& c) {
        std::size_t met = 0;
        for (const vn::IkStatus status : c.status) met += status == vn::IkStatus::converged;
        return vn::message("<vernier.Correction: ", met, " of ", c.status.size(), " targets met>");
      });

  const auto none = py::none();
  py::class_<Model>(module, "Model",
                    "A calibrated arm: its nominal chain, its errors, and the frames of its measurements.")
      .def_property_readonly(
          "name", [](const Model& m) { return m.arm->name(); }, "Name of the arm.")
      .def_property_readonly(
          "joints", [](const Model& m) { return m.arm->joints(); },
          "Number of joints of its controller: columns of joint values.")
      .def_property_readonly(
          "has_covariance", [](const Model& m) { return m.arm->has_covariance(); },
          "Whether `covariance` and `verify` can be asked.")
      .def_property_readonly(
          "provenance",
          [](const Model& m) {
            const vn::Provenance& from = m.arm->provenance();
            py::dict out;
            out["data_file"] = from.data_file;
            out["rows"] = from.rows;
            out["date"] = from.date;
            out["measured"] = from.measured;
            out["position_sigma"] = from.position_sigma;
            out["left_out_error"] = from.left_out_error;
            out["held_out_error"] = from.held_out_error;
            return out;
          },
          "Where the calibration comes from; lengths in metres, 0 where unknown.")
      .def(
          "fk",
          [](const Model& m, const py::object& q, const py::object& previous) {
            return over_rows(m, q, previous, {4, 4},
                             [&](auto rows, auto from, double* out, auto& e) { m.arm->poses(rows, from, out, e); });
          },
          py::arg("q"), py::arg("previous") = none,
          "Poses that the tool takes, (4, 4) or (n, 4, 4), in the frame of the measurements. previous has the joint "
          "values from which each is approached.")
      .def(
          "nominal_fk",
          [](const Model& m, const py::object& q) {
            return over_rows(m, q, py::none(), {4, 4},
                             [&](auto rows, auto, double* out, auto& e) { m.arm->nominal_poses(rows, out, e); });
          },
          py::arg("q"), "Poses where the controller believes the tool to be: the targets of `correct`.")
      .def(
          "jacobian",
          [](const Model& m, const py::object& q, const py::object& previous) {
            return over_rows(m, q, previous, {6, m.arm->joints()},
                             [&](auto rows, auto from, double* out, auto& e) { m.arm->jacobians(rows, from, out, e); });
          },
          py::arg("q"), py::arg("previous") = none, "Geometric Jacobians, (6, joints) or (n, 6, joints).")
      .def("correct", &correct, py::arg("q"), py::arg("previous") = none, py::kw_only(), py::arg("seed") = none,
           "Commands that bring the arm where the nominal one is at joint values q. With a seed, which chooses the "
           "branch, q are poses (4, 4) or (n, 4, 4) in the frame of the measurements.")
      .def("correct_path", &correct_path, py::arg("joints") = none, py::kw_only(), py::arg("poses") = none,
           py::arg("linear") = none, py::arg("start") = none, py::arg("tolerance") = 0.05e-3,
           py::arg("max_joint_step") = 0.5, py::arg("approach") = true, py::arg("progress") = none,
           "Commands of a whole path: branches are chosen for all of it, points are inserted where a linear move would "
           "leave its line. progress is called ten times a second with a Progress: generation counts targets that have "
           "their command, evaluations those whose branches are known.")
      .def("covariance", &covariance, py::arg("q"), py::arg("previous") = none,
           "Covariances of the pose, shift [m] and rotation vector [rad]: (6, 6) or (n, 6, 6).")
      .def("verify", &verify, py::arg("measured"), py::kw_only(), py::arg("base") = true, py::arg("tool") = false,
           py::arg("level") = 0.05, py::arg("accept") = none, py::arg("use_orientations") = true,
           "Whether the calibration still holds, from 3 to 1000 fresh poses; base, and tool, say what was set up anew.")
      .def("export_c", &export_c, py::arg("name") = "arm", "The arm as a C header, which predicts and corrects.")
      .def(
          "text", [](const Model& m) { return m.arm->text(); }, "The model file, as text.")
      .def(
          "save", [](const Model& m, const py::object& path) { vn::write_file(path_of(path), m.arm->text()); },
          py::arg("path"), "Saves the model, whole or not at all; `load` returns the same bits.")
      .def("__repr__", &shown)
      .def(py::pickle(
          [](const Model& m) { return py::make_tuple(m.arm->text()); },
          [](const py::tuple& state) { return model_of_text(state[0].cast<std::string>(), "pickled model"); }));

  module.def(
      "load", [](const py::object& path) { return Model{support::calibrated_arm(vn::read_model(path_of(path)))}; },
      py::arg("path"), "A calibrated arm of a model file, as `Model.save` or the program calibrate wrote it.");
}

}  // namespace python
