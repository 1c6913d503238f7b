# SPDX-License-Identifier: BSD-3-Clause
# With VERNIER_CHECK_HEADERS the target `headers` compiles every header where the libraries it needs are at hand, the .ipp
# files as the compiled libraries have them, and a program that calls the common functions header-only. Its value says
# whether headers are compiled alone, a translation unit each, or together, which shows the same warnings sooner.
#
# Most of that time would go into parsing Eigen again and again. It is parsed once for the headers that include
# vernier/core/types.hpp, which begins with the same headers of Eigen: an include that such a header forgets is found
# with the precompiled ones exactly when it is found without them. All other headers are compiled without.

add_custom_target(headers)

# vernier_reaches_types(<out> <header>): whether the header includes vernier/core/types.hpp before its own lines, which
# is in other headers, not in the .ipp file at its end.
function(vernier_reaches_types out header)
  get_property(reaches GLOBAL PROPERTY "vernier_reaches_types_${header}")
  if("${reaches}" STREQUAL "")
    set(reaches FALSE)
    file(STRINGS "${PROJECT_SOURCE_DIR}/include/${header}" lines REGEX "^#include \"vernier/.*\\.hpp\"")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"(.*)\"$" "\\1" included "${line}")
      if(NOT reaches)
        vernier_reaches_types(reaches "${included}")
      endif()
      if(included STREQUAL "vernier/core/types.hpp")
        set(reaches TRUE)
      endif()
    endforeach()
    set_property(GLOBAL PROPERTY "vernier_reaches_types_${header}" ${reaches})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/${header}")
  endif()
  set(${out} ${reaches} PARENT_SCOPE)
endfunction()

# vernier_check_headers(<target> <header>...): the target's headers, a translation unit each
function(vernier_check_headers target)
  add_library(${target}_headers OBJECT EXCLUDE_FROM_ALL)
  target_link_libraries(${target}_headers PRIVATE ${target})
  if(VERNIER_CHECK_HEADERS STREQUAL "alone")
    set_target_properties(${target}_headers PROPERTIES UNITY_BUILD OFF)
  endif()
  vernier_precompile(${target}_headers <Eigen/Core> <Eigen/Geometry>)
  add_dependencies(headers ${target}_headers)
  foreach(file IN LISTS ARGN)
    cmake_path(RELATIVE_PATH file BASE_DIRECTORY "${PROJECT_SOURCE_DIR}/include" OUTPUT_VARIABLE header)
    set(source "${PROJECT_BINARY_DIR}/headers/${header}.cpp")
    file(CONFIGURE OUTPUT "${source}" CONTENT "#include \"@header@\"\n" @ONLY)
    target_sources(${target}_headers PRIVATE "${source}")
    vernier_reaches_types(reaches "${header}")
    if(NOT reaches)
      set_source_files_properties("${source}" PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()

# vernier_check_calls(): templates give warnings where they are called, and this program calls them. To be called where
# all targets are known.
function(vernier_check_calls)
  foreach(compiled IN ITEMS vernier_compiled vernier_compiled_io vernier_compiled_urdf vernier_compiled_ceres vernier_compiled_cholmod)
    if(TARGET ${compiled})
      add_dependencies(headers ${compiled})
    endif()
  endforeach()
  if(TARGET nlohmann_json::nlohmann_json AND TARGET tinyxml2::tinyxml2 AND TARGET yaml-cpp::yaml-cpp)
    add_library(common_calls OBJECT EXCLUDE_FROM_ALL "${PROJECT_SOURCE_DIR}/tests/consumer/common_calls.cpp")
    target_link_libraries(common_calls PRIVATE vernier::urdf)
    add_dependencies(headers common_calls)
  endif()
endfunction()
