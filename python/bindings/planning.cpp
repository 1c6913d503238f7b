// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <numbers>
#include <optional>

#include "arrays.hpp"
#include "bind.hpp"
#include "measurements.hpp"
#include "plan_task.hpp"
#include "robot.hpp"
#include "simulation.hpp"
#include "vernier/core/check.hpp"
#include "watch.hpp"

namespace python {

namespace {

namespace vn = vernier;

vn::Vector3 vector3(const py::object& object, const char* name) {
  const vn::VectorX values = vector_of(object, name, 3);
  return {values(0), values(1), values(2)};
}

py::object plan(const Robot& robot, vn::Index count, vn::Index candidates, const py::object& given,
                const py::object& box, const py::object& tracker, double acceptance, double link_radius, bool oriented,
                const Measurements* measured, std::uint64_t seed, const py::object& progress) {
  support::PlanTask task{.robot = robot.about,
                         .count = count,
                         .candidates = candidates,
                         .acceptance = acceptance,
                         .link_radius = link_radius,
                         .oriented = oriented};
  vn::demand(count >= 1 && candidates >= count, "plan: ", count, " poses of ", candidates, " candidates");
  vn::demand(acceptance > 0 && link_radius >= 0, "plan: acceptance is ", acceptance, " and link_radius ", link_radius,
             "; the first must be positive, the second not negative");
  if (!given.is_none()) task.given = matrix_of(Rows(given, "poses", robot.arm->joints()));
  if (!box.is_none()) {
    const Rows corners(box, "box", 3);
    vn::demand(corners.size() == 2, "box: two corners are expected, the lower and the upper one");
    const double *lower = corners.view().row(0), *upper = corners.view().row(1);
    task.box = vn::ToolBox{{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  }
  if (!tracker.is_none()) task.tracker = vector3(tracker, "tracker");
  if (measured != nullptr) task.measured = measured->data.stations;
  support::PlanOutcome out;
  watched(
      progress, 1, seed, [&](const vn::FitOptions& fit) { out = support::plan(task, fit.seed, fit.observer); },
      Steps::stated);
  return py::module_::import("vernier.results")
      .attr("Plan")(array_of(out.joints), py::cast(out.plan.chosen), py::cast(out.plan.visits),
                    array_of(out.plan.relative_error), array_of(out.plan.log_det), out.plan.unknowns,
                    out.plan.enough());
}

Measurements simulate(const Robot& robot, const py::object& joints, std::uint64_t seed, double position_noise,
                      double orientation_noise, double backlash, double gears, bool orientations, int points,
                      const py::object& progress) {
  vn::demand(position_noise >= 0 && orientation_noise >= 0 && backlash >= 0 && gears >= 0,
             "simulate: sizes of noise and errors must not be negative");
  const vn::MatrixX rows = matrix_of(Rows(joints, "joints", robot.arm->joints()));
  vn::demand(rows.rows() > 0, "simulate: no joint values");
  vn::demand(points >= 1, "simulate: points is ", points, ", must be at least 1");
  support::MeasuredPoses out;
  watched(
      progress, 1, seed,
      [&](const vn::FitOptions& fit) {
        out = support::simulate_poses(robot.about, rows,
                                      {position_noise, orientation_noise, backlash, gears, orientations}, fit.seed,
                                      points, fit.observer);
      },
      Steps::stated);
  return {{{std::move(out)}, {}, {}}};
}

}  // namespace

void bind_planning(py::module_& module) {
  const auto none = py::none();
  module.def("plan", &plan, py::arg("robot"), py::arg("count") = 100, py::kw_only(), py::arg("candidates") = 2000,
             py::arg("poses") = none, py::arg("box") = none, py::arg("tracker") = none,
             py::arg("acceptance") = std::numbers::pi, py::arg("link_radius") = 0.0, py::arg("oriented") = false,
             py::arg("measured") = none, py::arg("seed") = 1, py::arg("progress") = none,
             "Chooses poses whose measurements tell most about the arm, of random candidates within limits or of given "
             "poses. box has two corners [m] between which the tool stays; tracker is a position [m] that must see it. "
             "progress is called ten times a second with a Progress: generation counts chosen poses.");
  const support::SimulationSettings sizes;
  module.def("simulate", &simulate, py::arg("robot"), py::arg("joints"), py::kw_only(), py::arg("seed") = 1,
             py::arg("position_noise") = sizes.position_noise, py::arg("orientation_noise") = sizes.orientation_noise,
             py::arg("backlash") = sizes.backlash, py::arg("gears") = sizes.gears, py::arg("orientations") = true,
             py::arg("points") = 1, py::arg("progress") = none,
             "Measures a virtual arm whose links, gears, compliance and backlash err, drawn from the seed: the same "
             "arm for other joint values. Standard deviations of noise and gears, and half the play [m, rad]. points "
             "is a number of reflectors; each pose is measured with all of them, positions alone where there are "
             "several.");
}

}  // namespace python
