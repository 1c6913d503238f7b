# SPDX-License-Identifier: BSD-3-Clause
# The version is written once, in include/vernier/core/version.hpp.

function(vernier_read_version out header)
  set(version "")
  foreach(part MAJOR MINOR PATCH)
    file(STRINGS "${header}" line REGEX "^#define VERNIER_VERSION_${part} +[0-9]+")
    if(NOT line MATCHES "([0-9]+)$")
      message(FATAL_ERROR "${header} does not define VERNIER_VERSION_${part} as a number")
    endif()
    list(APPEND version ${CMAKE_MATCH_1})
  endforeach()
  list(JOIN version "." version)
  set(${out} ${version} PARENT_SCOPE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${header}")
endfunction()
