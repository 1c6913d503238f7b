# The headers, the compiled libraries, and a package for find_package(vernier [COMPONENTS io ceres cholmod tbb mpi]).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(vernier_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/vernier")

# vernier_install(<target> [FILE_SET <set> DESTINATION <folder>]...): the target, in an export of its own
function(vernier_install target)
  string(REPLACE "_" "-" export ${target})
  install(TARGETS ${target} EXPORT ${export} ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" ${ARGN})
  install(EXPORT ${export} NAMESPACE vernier:: FILE ${export}-targets.cmake DESTINATION "${vernier_package_dir}")
endfunction()

foreach(component vernier ${vernier_components})
  if(component STREQUAL "vernier")
    set(target vernier)
    set(compiled vernier_compiled)
  else()
    set(target vernier_${component})
    set(compiled vernier_compiled_${component})
  endif()
  set(file_sets)
  get_target_property(sets ${target} INTERFACE_HEADER_SETS)
  foreach(set IN LISTS sets)
    list(APPEND file_sets FILE_SET ${set} DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  endforeach()
  vernier_install(${target} ${file_sets})
  if(TARGET ${compiled})
    vernier_install(${compiled})
  endif()
endforeach()

configure_package_config_file(cmake/vernierConfig.cmake.in "${PROJECT_BINARY_DIR}/vernierConfig.cmake"
                              INSTALL_DESTINATION "${vernier_package_dir}"
                              NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
if(VERNIER_COMPILED)
  set(independent)
else()
  set(independent ARCH_INDEPENDENT)
endif()
write_basic_package_version_file("${PROJECT_BINARY_DIR}/vernierConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion ${independent})
install(FILES "${PROJECT_BINARY_DIR}/vernierConfig.cmake" "${PROJECT_BINARY_DIR}/vernierConfigVersion.cmake"
        cmake/FindCHOLMOD.cmake
        DESTINATION "${vernier_package_dir}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
