# SPDX-License-Identifier: BSD-3-Clause
# What Vernier's own tests, programs and benchmarks are built with; never installed, never seen by users.

add_library(vernier_internal INTERFACE)
target_compile_features(vernier_internal INTERFACE cxx_std_20)
target_compile_options(vernier_internal INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wdouble-promotion -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual -Wextra-semi -Wcast-qual
  # g++ 12 raises these after inlining, inside Eigen and std::string, where "system header" no longer counts.
  "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-use-after-free;-Wno-free-nonheap-object;-Wno-dangling-pointer>"
  $<$<BOOL:${VERNIER_WERROR}>:-Werror>)

# The headers of Eigen for `vernier_precompile`.
set(vernier_eigen_headers <Eigen/Core> <Eigen/LU> <Eigen/QR> <Eigen/SVD> <Eigen/Geometry> <Eigen/Eigenvalues>
    <Eigen/Cholesky>)

# What ccache needs to see through a precompiled header.
set(vernier_precompiled_options)
if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  set(vernier_precompiled_options
    $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>
    "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()

# vernier_precompile(<target> <header>...): headers of other libraries, parsed once for all files of a target. Never
# Vernier's own: in a precompiled header they would give no warnings.
function(vernier_precompile target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  target_compile_options(${target} PRIVATE ${vernier_precompiled_options})
endfunction()

# vernier_reuse_precompiled(<target> <other>): takes what another target, with the same options, precompiles.
function(vernier_reuse_precompiled target other)
  target_precompile_headers(${target} REUSE_FROM ${other})
  target_compile_options(${target} PRIVATE ${vernier_precompiled_options})
endfunction()

# vernier_includes(<out> <file> <regex>): whether the file has an #include line whose target starts so. Editing the file
# configures again, so what a program links to follows from what it includes.
function(vernier_includes out file regex)
  file(STRINGS "${file}" lines REGEX "^#include [<\"]${regex}")
  if(lines)
    set(${out} TRUE PARENT_SCOPE)
  else()
    set(${out} FALSE PARENT_SCOPE)
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
endfunction()

# KDL, the peer that kinematics are compared with, as vernier_kdl; its package names a library and no target.
find_package(orocos_kdl QUIET)
if(orocos_kdl_FOUND)
  add_library(vernier_kdl INTERFACE)
  target_include_directories(vernier_kdl SYSTEM INTERFACE ${orocos_kdl_INCLUDE_DIRS})
  target_link_libraries(vernier_kdl INTERFACE ${orocos_kdl_LIBRARIES} Eigen3::Eigen)
endif()

# kdl_parser on urdfdom, the peers that URDF files are compared with, as vernier_kdl_parser; their packages name their
# libraries in as many ways as there are releases.
find_path(KDL_PARSER_INCLUDE_DIR kdl_parser/kdl_parser.hpp)
find_library(KDL_PARSER_LIBRARY kdl_parser)
find_library(URDFDOM_MODEL_LIBRARY urdfdom_model)
mark_as_advanced(KDL_PARSER_INCLUDE_DIR KDL_PARSER_LIBRARY URDFDOM_MODEL_LIBRARY)
if(TARGET vernier_kdl AND KDL_PARSER_INCLUDE_DIR AND KDL_PARSER_LIBRARY AND URDFDOM_MODEL_LIBRARY)
  add_library(vernier_kdl_parser INTERFACE)
  target_include_directories(vernier_kdl_parser SYSTEM INTERFACE "${KDL_PARSER_INCLUDE_DIR}")
  target_link_libraries(vernier_kdl_parser INTERFACE "${KDL_PARSER_LIBRARY}" "${URDFDOM_MODEL_LIBRARY}" vernier_kdl)
endif()
