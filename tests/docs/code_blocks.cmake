# SPDX-License-Identifier: BSD-3-Clause
# The ```cpp blocks of a page, as files that its test includes: what a page shows is compiled and run.

# vernier_code_blocks(<page> <folder>) writes block k of <page>.md to <folder>/<page>_<k>.inc, compilers' complaints about
# which name the page and its line, and their number to <folder>/<page>_blocks.hpp as `<page>_blocks`. Editing the page
# configures again. Text is cut by position, because a list of CMake ends an element at a semicolon.
function(vernier_code_blocks page folder)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${page}")
  cmake_path(GET page STEM name)
  file(READ "${page}" rest)
  set(line 1)
  set(count 0)
  while(TRUE)
    string(FIND "${rest}" "```cpp\n" begin)
    if(begin EQUAL -1)
      break()
    endif()
    math(EXPR begin "${begin} + 7")
    string(SUBSTRING "${rest}" 0 ${begin} before)
    string(SUBSTRING "${rest}" ${begin} -1 rest)
    string(FIND "${rest}" "```" end)
    if(end EQUAL -1)
      message(FATAL_ERROR "Vernier: a block of code in ${page} has no end")
    endif()
    string(SUBSTRING "${rest}" 0 ${end} block)
    math(EXPR end "${end} + 3")
    string(SUBSTRING "${rest}" ${end} -1 rest)

    string(REGEX REPLACE "[^\n]" "" newlines "${before}")
    string(LENGTH "${newlines}" newlines)
    math(EXPR line "${line} + ${newlines}")
    math(EXPR count "${count} + 1")
    file(CONFIGURE OUTPUT "${folder}/${name}_${count}.inc" CONTENT "#line @line@ \"@page@\"\n@block@" @ONLY)
    string(REGEX REPLACE "[^\n]" "" newlines "${block}")
    string(LENGTH "${newlines}" newlines)
    math(EXPR line "${line} + ${newlines}")
  endwhile()
  file(CONFIGURE OUTPUT "${folder}/${name}_blocks.hpp"
       CONTENT "#pragma once\n\ninline constexpr int @name@_blocks = @count@;  // blocks of code in @name@.md\n" @ONLY)
endfunction()

# vernier_add_pages(<test>): the blocks of all pages with a test, in front of it, and the README's program.
function(vernier_add_pages test)
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/docs")
  foreach(page README.md docs/guide.md docs/robot_files.md docs/your_own.md)
    vernier_code_blocks("${PROJECT_SOURCE_DIR}/${page}" "${folder}")
  endforeach()
  target_include_directories(${test} PRIVATE "${folder}")

  file(CONFIGURE OUTPUT "${folder}/readme_program.cpp" CONTENT "#include \"README_1.inc\"\n")
  add_executable(readme_program "${folder}/readme_program.cpp")
  target_link_libraries(readme_program PRIVATE vernier_internal vernier::compiled_io)
  add_dependencies(${test} readme_program)
  target_compile_definitions(${test} PRIVATE VERNIER_README_PROGRAM="$<TARGET_FILE:readme_program>")
  if(TARGET MPI::MPI_CXX)
    target_link_libraries(${test} PRIVATE vernier::compiled_mpi)
    target_compile_definitions(${test} PRIVATE VERNIER_DOCS_MPI)
  endif()
endfunction()
