# SPDX-License-Identifier: BSD-3-Clause
# Settings of a build of Vernier itself; whoever embeds it keeps their own.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
endif()

set(CMAKE_CXX_EXTENSIONS OFF)

if(NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(VERNIER_CCACHE ccache)
  mark_as_advanced(VERNIER_CCACHE)
  if(VERNIER_CCACHE)
    # ccache looks into precompiled headers only when told that their macros and time stamps do not matter.
    set(CMAKE_CXX_COMPILER_LAUNCHER
        "${CMAKE_COMMAND};-E;env;CCACHE_DEPEND=1;CCACHE_SLOPPINESS=pch_defines,time_macros;${VERNIER_CCACHE}")
  endif()
endif()
