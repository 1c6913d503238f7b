// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The parts of the module, a file each.

#include <pybind11/pybind11.h>

namespace python {

void bind_robot(pybind11::module_& module);
void bind_measurements(pybind11::module_& module);
void bind_model(pybind11::module_& module);
void bind_calibration(pybind11::module_& module);
void bind_planning(pybind11::module_& module);
void bind_learners(pybind11::module_& module);
void bind_minimize(pybind11::module_& module);

}  // namespace python
