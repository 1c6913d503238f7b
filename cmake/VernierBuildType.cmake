# SPDX-License-Identifier: BSD-3-Clause
# One line for a project that uses Vernier and is compiled without optimisation because nobody chose a build type.

get_property(_vernier_configurations GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT _vernier_configurations AND "${CMAKE_BUILD_TYPE}" STREQUAL "" AND NOT "${CMAKE_CXX_FLAGS}" MATCHES "(^| )-O"
   AND NOT vernier_FIND_QUIETLY)
  message(STATUS "vernier: CMAKE_BUILD_TYPE is empty, so this project is compiled without optimisation; "
                 "-DCMAKE_BUILD_TYPE=Release makes it fast")
endif()
