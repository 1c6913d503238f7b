# SPDX-License-Identifier: BSD-3-Clause
# Whether the Python module is built (VERNIER_WITH_PYTHON), for which interpreter. Of several interpreters the system's
# is taken, whose packages NumPy and pybind11 are, unless Python3_EXECUTABLE names another.

set(VERNIER_WITH_PYTHON FALSE)
if(VERNIER_PYTHON STREQUAL "OFF" OR NOT VERNIER_PYTHON OR (VERNIER_PYTHON STREQUAL "AUTO" AND NOT PROJECT_IS_TOP_LEVEL))
  return()
endif()
if(NOT Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python3_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module)
if(Python3_Development.Module_FOUND)
  set(PYTHON_EXECUTABLE "${Python3_EXECUTABLE}")
  find_package(pybind11 2.9 QUIET CONFIG)
endif()
if(pybind11_FOUND AND TARGET nlohmann_json::nlohmann_json AND VERNIER_COMPILED)
  set(VERNIER_WITH_PYTHON TRUE)
elseif(VERNIER_PYTHON STREQUAL "ON")
  message(FATAL_ERROR "Vernier: VERNIER_PYTHON is ON, but pybind11 (pybind11-dev), Python's headers (python3-dev), nlohmann-json "
                      "or the compiled library is missing")
else()
  message(STATUS "Vernier: pybind11 or Python's headers not found, the Python module is left out")
endif()
