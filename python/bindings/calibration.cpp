// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "bind.hpp"
#include "calibration_task.hpp"
#include "measurements.hpp"
#include "model.hpp"
#include "robot.hpp"
#include "vernier/core/check.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/model_text.hpp"
#include "watch.hpp"

namespace python {

namespace {

namespace vn = vernier;

vn::Loss loss_of(const std::string& word) {
  vn::demand(word == "huber" || word == "cauchy" || word == "squared", "loss: '", word,
             "' is none of huber, cauchy and squared");
  return word == "huber" ? vn::Loss::huber : word == "cauchy" ? vn::Loss::cauchy : vn::Loss::squared;
}

std::vector<vn::Learner> learners_of(const std::vector<std::string>& words) {
  std::vector<vn::Learner> out;
  for (const std::string& word : words) {
    vn::demand(word == "pso_elm" || word == "ridge_elm" || word == "kernel_elm", "learners: '", word,
               "' is none of pso_elm, ridge_elm and kernel_elm");
    out.push_back(word == "pso_elm"     ? vn::Learner::pso_elm
                  : word == "ridge_elm" ? vn::Learner::ridge_elm
                                        : vn::Learner::kernel_elm);
  }
  return out;
}

/// Which poses are held out. An integer K holds out every K-th row, a share that many rows at random. `Measurements`
/// are the held-out poses themselves.
void hold_out(const py::object& test, support::CalibrationTask& task) {
  if (py::isinstance<Measurements>(test)) {
    task.test = test.cast<const Measurements&>().data;
  } else if (PyIndex_Check(test.ptr())) {
    task.test_every = whole_number(test, "test");
    vn::demand(task.test_every >= 2, "test: every ", task.test_every, "th row cannot be held out; at least 2");
  } else {
    task.test_fraction = PyFloat_AsDouble(test.ptr());
    const bool failed = PyErr_Occurred() != nullptr;
    PyErr_Clear();
    vn::demand(!failed, "test must be Measurements, K for every K-th row (int), or a share of the rows (float)");
    vn::demand(task.test_fraction > 0 && task.test_fraction < 1, "test: a share of ", task.test_fraction,
               ", must be between 0 and 1");
  }
}

py::dict stages_of(const vn::CalibrationReport& report, bool rotations) {
  py::dict out;
  for (const vn::StageErrors& stage : report.stages)
    out[py::str(stage.key())] = array_of(rotations ? stage.rotation : stage.position);
  return out;
}

py::object calibrate(const Robot& robot, const Measurements& data, const py::object& test, std::uint64_t seed,
                     const py::object& threads, const std::optional<double>& accept, const std::string& date,
                     const Model* prior, const std::string& loss, double position_sigma, double orientation_sigma,
                     double distance_sigma, double contact_sigma, double joint_sigma, bool use_orientations,
                     bool keep_outliers, bool refuse_implausible, const std::vector<std::string>& learners,
                     const py::object& progress) {
  support::CalibrationTask task{robot.about, data.data};
  hold_out(test, task);
  task.date = date;
  vn::demand(!accept || *accept > 0, "accept is ", accept.value_or(0), ", must be positive");
  task.accept = accept;
  task.calibrate.sensors = {position_sigma, orientation_sigma, distance_sigma, contact_sigma,
                            joint_sigma,    use_orientations,  loss_of(loss)};
  task.calibrate.keep_outliers = keep_outliers;
  task.calibrate.refuse_implausible = refuse_implausible;
  task.calibrate.remainder.on_geometry = true;
  task.calibrate.remainder.learners = learners_of(learners);
  std::optional<vn::SavedModel> earlier;
  if (prior != nullptr) {
    earlier = vn::parse_model(prior->arm->text(), prior->arm->name());
    task.prior = &*earlier;
  }
  support::CalibrationOutcome out;
  watched(progress, threads_of(threads), seed, [&](const vn::FitOptions& fit) { out = support::calibrate(task, fit); });
  out.page.provenance.command = "vernier.calibrate";
  out.page.provenance.date = date;
  out.page.provenance.seed = seed;

  const vn::CalibrationReport& report = out.report;
  std::string verdict;
  for (const std::string& sentence : report.verdict()) verdict += (verdict.empty() ? "" : "\n") + sentence;
  const py::module_ results = py::module_::import("vernier.results");
  const py::object page =
      results.attr("Report")(vn::report_html(out.page), report.summary(), report.full_summary(), out.results);
  py::dict reflectors;
  for (std::size_t k = 0; k < out.reflectors.size(); ++k) {
    const support::FoundReflector& one = out.reflectors[k];
    const auto three = [](const vn::Vector3& v) { return array_of(vn::VectorX(v)); };
    reflectors[py::str(one.name)] =
        results.attr("Reflector")(three(one.offset), three(one.std), one.rows, py::cast(Model{out.models[k]}));
  }
  return results.attr("CalibrationResult")(py::cast(Model{out.model}), page, verdict, report.chosen.key(),
                                           stages_of(report, false),
                                           report.oriented ? py::object(stages_of(report, true)) : py::dict(),
                                           report.train_poses, report.test_poses(), reflectors);
}

}  // namespace

void bind_calibration(py::module_& module) {
  const vn::SensorModel sensors;
  module.def(
      "calibrate", &calibrate, py::arg("robot"), py::arg("data"), py::kw_only(), py::arg("test") = 5,
      py::arg("seed") = 1, py::arg("threads") = py::none(), py::arg("accept") = py::none(), py::arg("date") = "",
      py::arg("prior") = py::none(), py::arg("loss") = "huber", py::arg("position_sigma") = sensors.position_sigma,
      py::arg("orientation_sigma") = sensors.orientation_sigma, py::arg("distance_sigma") = sensors.distance_sigma,
      py::arg("contact_sigma") = sensors.contact_sigma, py::arg("joint_sigma") = sensors.joint_sigma,
      py::arg("use_orientations") = true, py::arg("keep_outliers") = false, py::arg("refuse_implausible") = true,
      py::arg("learners") = std::vector<std::string>{"pso_elm", "ridge_elm", "kernel_elm"},
      py::arg("progress") = py::none(),
      "Calibrates an arm from measurements and assesses it on held-out poses, as the program calibrate does. test "
      "names "
      "the held-out poses: an int K holds out every K-th row, a float that share of the rows at random; Measurements "
      "are "
      "held-out poses themselves. progress is called with a Progress ten times a second.");
}

}  // namespace python
