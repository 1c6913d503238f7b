// SPDX-License-Identifier: BSD-3-Clause
// The extension module vernier._vernier; python/vernier/__init__.py shows its names as those of the package.

#include <pybind11/pybind11.h>

#include <exception>

#include "arrays.hpp"
#include "bind.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/core/version.hpp"

namespace {

namespace py = pybind11;

/// Raises an exception of vernier.errors.
void raise_as(const char* type, const std::exception& error) {
  const py::object exception = py::module_::import("vernier.errors").attr(type);
  PyErr_SetString(exception.ptr(), error.what());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const vernier::DataError& error) {
    raise_as("DataError", error);
  } catch (const vernier::CalibrationFailure& error) {
    raise_as("CalibrationFailure", error);
  }
}

}  // namespace

PYBIND11_MODULE(_vernier, module) {
  module.doc() = "Calibration and error compensation of serial robot arms.";
  module.attr("__version__") =
      vernier::message(VERNIER_VERSION_MAJOR, ".", VERNIER_VERSION_MINOR, ".", VERNIER_VERSION_PATCH);
  py::register_exception_translator(&translate);
  py::class_<vernier::Progress>(module, "Progress", "How far a long computation has come.")
      .def_readonly("generation", &vernier::Progress::generation, "Generations (iterations) done.")
      .def_readonly("evaluations", &vernier::Progress::evaluations, "Evaluations of the objective done.")
      .def_readonly("best", &vernier::Progress::best, "Best value of the objective so far.")
      .def("__repr__", [](const vernier::Progress& p) {
        return vernier::message("<vernier.Progress: generation ", p.generation, ", best ", p.best, ">");
      });
  module.def(
      "_array_reads", [] { return py::make_tuple(python::read_counts().in_place, python::read_counts().converted); },
      "Arrays that were read in place, and those that were converted.");
  python::bind_robot(module);
  python::bind_measurements(module);
  python::bind_model(module);
  python::bind_calibration(module);
  python::bind_planning(module);
  python::bind_learners(module);
  python::bind_minimize(module);
}
