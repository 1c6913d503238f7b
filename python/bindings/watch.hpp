// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Long computations on a thread of their own, while the caller's thread looks for Ctrl-C and calls back.

#include <pybind11/pybind11.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

#include "vernier/core/fit_options.hpp"

namespace python {

namespace py = pybind11;

/// How `Progress::generation` counts.
enum class Steps {
  reports,  ///< all reports of all searches and fits that are part of the work
  stated    ///< as the work says
};

/// Runs work that knows no Python.
/// @param progress called every tenth of a second with a `Progress`; None: nobody
/// @param threads  of the work
/// @param work     gets options with an observer and an executor, both of which end it where an exception waits
/// @param steps    which are shown
/// @throws the exception of `progress`, KeyboardInterrupt, or that of the work, after the work has ended
void watched(const py::object& progress, int threads, std::uint64_t seed,
             const std::function<void(const vernier::FitOptions&)>& work, Steps steps = Steps::reports);

/// Number of threads: as given, or all processors.
/// @throws std::invalid_argument for none
int threads_of(const py::object& threads);

}  // namespace python
