# SPDX-License-Identifier: BSD-3-Clause
# The user's program, with the components named in CONSUMER_COMPONENTS (any of io, urdf, ceres, cholmod, tbb, mpi), header-only, or with
# the compiled libraries, or both in one program.

set(CONSUMER_COMPONENTS "" CACHE STRING "Components of Vernier the program uses")
set(CONSUMER_MODE "header_only" CACHE STRING "header_only, compiled or mixed")

function(add_consumer)
  add_executable(consumer "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/main.cpp")
  if(CONSUMER_MODE STREQUAL "compiled")
    set(prefix compiled_)
    target_link_libraries(consumer PRIVATE vernier::compiled)
  else()
    target_link_libraries(consumer PRIVATE vernier::vernier)
  endif()
  foreach(component IN LISTS CONSUMER_COMPONENTS)
    target_link_libraries(consumer PRIVATE vernier::${prefix}${component})
    string(TOUPPER ${component} COMPONENT)
    target_compile_definitions(consumer PRIVATE CONSUMER_${COMPONENT})
  endforeach()
  if(CONSUMER_MODE STREQUAL "mixed")
    add_library(other_unit OBJECT "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/library.cpp")
    target_link_libraries(other_unit PRIVATE vernier::compiled)
    target_compile_definitions(consumer PRIVATE CONSUMER_MIXED)
    # The program links the library, and its main.cpp does not see that.
    target_link_libraries(consumer PRIVATE $<TARGET_OBJECTS:other_unit> $<TARGET_FILE:vernier::compiled>)
    add_dependencies(consumer other_unit)
  endif()
endfunction()
