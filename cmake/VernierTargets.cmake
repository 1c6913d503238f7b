# SPDX-License-Identifier: BSD-3-Clause
# vernier::vernier (Eigen and threads), header-only; vernier::io, ::ceres, ::cholmod, ::tbb and ::mpi add a library each,
# ::urdf two to those of io. INTERFACE targets without a flag: they ask for C++20 and nothing else.
#
# vernier::compiled is the same with the definitions of the .ipp files in a static library, and vernier::compiled_io,
# ::compiled_urdf, ::compiled_ceres and ::compiled_cholmod are likewise. Where Vernier is embedded they are built only if something links them.

set(vernier_components io urdf ceres cholmod tbb mpi)
list(JOIN vernier_components "|" vernier_component_regex)

# Files in C, JavaScript and CSS are string literals, which headers include: they belong to the headers, and nothing
# compiles them.
file(GLOB_RECURSE vernier_headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/vernier/*.hpp"
     "${PROJECT_SOURCE_DIR}/include/vernier/*.ipp" "${PROJECT_SOURCE_DIR}/include/vernier/*.c"
     "${PROJECT_SOURCE_DIR}/include/vernier/*.js" "${PROJECT_SOURCE_DIR}/include/vernier/*.css")
foreach(component IN LISTS vernier_components)
  set(vernier_${component}_headers ${vernier_headers})
  list(FILTER vernier_${component}_headers INCLUDE REGEX "/include/vernier/${component}[/.]")
endforeach()
list(FILTER vernier_headers EXCLUDE REGEX "/include/vernier/(${vernier_component_regex})[/.]")

# vernier_name_target(<target> <export name>): what users call it, here and behind find_package
function(vernier_name_target target name)
  add_library(vernier::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
endfunction()

# vernier_add_component(<component> HEADERS <file>... LINK <target>...) makes vernier::<component>, and its compiled
# counterpart where the component has .ipp files.
function(vernier_add_component component)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS;LINK")
  if(component STREQUAL "vernier")
    set(target vernier)
    set(compiled compiled)
  else()
    set(target vernier_${component})
    set(compiled compiled_${component})
  endif()
  set(definitions ${arg_HEADERS})
  list(FILTER definitions INCLUDE REGEX "\\.ipp$")
  set(included ${arg_HEADERS})
  list(FILTER included EXCLUDE REGEX "\\.hpp$")
  list(FILTER arg_HEADERS INCLUDE REGEX "\\.hpp$")

  add_library(${target} INTERFACE)
  vernier_name_target(${target} ${component})
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_link_libraries(${target} INTERFACE ${arg_LINK})
  target_sources(${target} INTERFACE FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/include" FILES ${arg_HEADERS})
  set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS OFF)  # see VernierHeaders.cmake
  if(included)
    target_sources(${target} INTERFACE FILE_SET included TYPE HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/include"
                   FILES ${included})
  endif()
  set(missing)
  foreach(library IN LISTS arg_LINK)
    if(NOT TARGET ${library})
      list(APPEND missing ${library})
      message(STATUS "Vernier: ${library} not found, so vernier::${component} cannot be used in this build")
    endif()
  endforeach()
  if(VERNIER_CHECK_HEADERS AND NOT missing)
    vernier_check_headers(${target} ${arg_HEADERS})
  endif()
  if(missing OR NOT VERNIER_COMPILED)
    return()
  endif()

  if(NOT definitions)
    add_library(vernier_${compiled} INTERFACE)
    vernier_name_target(vernier_${compiled} ${compiled})
    target_link_libraries(vernier_${compiled} INTERFACE ${target} vernier::compiled)
    return()
  endif()
  set(sources)
  foreach(file IN LISTS definitions)  # a translation unit each
    cmake_path(RELATIVE_PATH file BASE_DIRECTORY "${PROJECT_SOURCE_DIR}/include" OUTPUT_VARIABLE include)
    string(REGEX REPLACE "[/.]" "_" name "${include}")
    file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/compiled/${name}.cpp" CONTENT "#include \"@include@\"\n" @ONLY)
    list(APPEND sources "${PROJECT_BINARY_DIR}/compiled/${name}.cpp")
  endforeach()
  add_library(vernier_${compiled} STATIC ${sources})
  vernier_name_target(vernier_${compiled} ${compiled})
  target_compile_definitions(vernier_${compiled} PUBLIC VERNIER_COMPILED)
  target_link_libraries(vernier_${compiled} PUBLIC ${target})
  if(NOT component STREQUAL "vernier")
    foreach(library IN LISTS arg_LINK)  # a component may bring another
      string(REPLACE "vernier::" "vernier::compiled_" brought "${library}")
      if(NOT brought STREQUAL library AND TARGET ${brought})
        target_link_libraries(vernier_${compiled} PUBLIC ${brought})
      endif()
    endforeach()
    target_link_libraries(vernier_${compiled} PUBLIC vernier::compiled)
  endif()
  foreach(library IN LISTS arg_LINK)  # components that this one is built on
    if(library MATCHES "^vernier::(.+)$" AND TARGET vernier::compiled_${CMAKE_MATCH_1})
      target_link_libraries(vernier_${compiled} PUBLIC vernier::compiled_${CMAKE_MATCH_1})
    endif()
  endforeach()
  if(TARGET vernier_internal)
    target_link_libraries(vernier_${compiled} PRIVATE $<BUILD_INTERFACE:vernier_internal>)
    list(LENGTH sources count)
    if(count GREATER 16)  # else they are one unit, which parses Eigen as fast
      vernier_precompile(vernier_${compiled} ${vernier_eigen_headers})
    endif()
  endif()
  if(component STREQUAL "vernier" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_definitions(vernier_${compiled} PRIVATE VERNIER_DENSE_KERNELS)
    foreach(set "avx2;-mavx2;-mfma" "avx512;-mavx512f;-mavx512dq;-mavx2;-mfma;-Wno-uninitialized")
      list(POP_FRONT set name)
      set(source "${PROJECT_BINARY_DIR}/compiled/dense_kernels_${name}.cpp")
      file(CONFIGURE OUTPUT "${source}" @ONLY CONTENT "#define Eigen EigenOfKernels_@name@
#define VERNIER_KERNELS @name@_kernels
#include \"vernier/core/detail/dense_kernels.inl\"
")
      target_sources(vernier_${compiled} PRIVATE "${source}")
      set_source_files_properties("${source}" PROPERTIES COMPILE_OPTIONS "${set}" SKIP_UNITY_BUILD_INCLUSION ON
                                  SKIP_PRECOMPILE_HEADERS ON)
    endforeach()
  endif()
  # Parsing Eigen is most of a small file's cost.
  set_target_properties(vernier_${compiled} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD ON
                        UNITY_BUILD_BATCH_SIZE 16)
  if(NOT VERNIER_INSTALL)
    set_target_properties(vernier_${compiled} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()

vernier_add_component(vernier HEADERS ${vernier_headers} LINK Eigen3::Eigen Threads::Threads)
vernier_add_component(io HEADERS ${vernier_io_headers} LINK vernier::vernier nlohmann_json::nlohmann_json)
vernier_add_component(urdf HEADERS ${vernier_urdf_headers}
                      LINK vernier::io nlohmann_json::nlohmann_json tinyxml2::tinyxml2 yaml-cpp::yaml-cpp)
vernier_add_component(ceres HEADERS ${vernier_ceres_headers} LINK vernier::vernier Ceres::ceres)
vernier_add_component(cholmod HEADERS ${vernier_cholmod_headers} LINK vernier::vernier CHOLMOD::CHOLMOD)
vernier_add_component(tbb HEADERS ${vernier_tbb_headers} LINK vernier::vernier TBB::tbb)
vernier_add_component(mpi HEADERS ${vernier_mpi_headers} LINK vernier::vernier MPI::MPI_CXX)
