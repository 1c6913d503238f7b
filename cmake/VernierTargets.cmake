# vernier::vernier (Eigen and threads); vernier::io, ::ceres, ::tbb and ::mpi add a library each.
# INTERFACE targets without a flag: they ask for C++20 and nothing else.

file(GLOB_RECURSE vernier_headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/vernier/*.hpp")
foreach(component io ceres tbb mpi)
  set(vernier_${component}_headers ${vernier_headers})
  list(FILTER vernier_${component}_headers INCLUDE REGEX "/include/vernier/${component}(/.*)?\\.hpp$")
endforeach()
list(FILTER vernier_headers EXCLUDE REGEX "/include/vernier/(io|ceres|tbb|mpi)(/.*)?\\.hpp$")

# vernier_add_interface(<component> HEADERS <file>... LINK <target>...) makes vernier::<component>.
function(vernier_add_interface component)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS;LINK")
  if(component STREQUAL "vernier")
    set(target vernier)
  else()
    set(target vernier_${component})
  endif()
  add_library(${target} INTERFACE)
  add_library(vernier::${component} ALIAS ${target})
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_link_libraries(${target} INTERFACE ${arg_LINK})
  target_sources(${target} INTERFACE FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/include" FILES ${arg_HEADERS})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component})
  # With CMAKE_VERIFY_INTERFACE_HEADER_SETS every header is compiled alone, where its libraries are at hand.
  foreach(library IN LISTS arg_LINK)
    if(NOT TARGET ${library})
      set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS OFF)
      message(STATUS "Vernier: ${library} not found, so vernier::${component} cannot be used in this build")
    endif()
  endforeach()
endfunction()

vernier_add_interface(vernier HEADERS ${vernier_headers} LINK Eigen3::Eigen Threads::Threads)
vernier_add_interface(io HEADERS ${vernier_io_headers} LINK vernier::vernier nlohmann_json::nlohmann_json)
vernier_add_interface(ceres HEADERS ${vernier_ceres_headers} LINK vernier::vernier Ceres::ceres)
vernier_add_interface(tbb HEADERS ${vernier_tbb_headers} LINK vernier::vernier TBB::tbb)
vernier_add_interface(mpi HEADERS ${vernier_mpi_headers} LINK vernier::vernier MPI::MPI_CXX)
