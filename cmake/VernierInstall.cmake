# SPDX-License-Identifier: BSD-3-Clause
# The headers, the compiled libraries, and packages: for find_package(vernier [COMPONENTS io urdf ceres cholmod tbb mpi]),
# for pkg-config (vernier, header-only, and vernier-compiled), and for Debian (cpack -G DEB).

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
        cmake/FindCHOLMOD.cmake cmake/VernierBuildType.cmake
        DESTINATION "${vernier_package_dir}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")

# vernier_install_pc(<name> <description> <flags> <libraries>): for who compiles with pkg-config; the C++ standard is theirs
function(vernier_install_pc vernier_pc_name vernier_pc_description vernier_pc_cflags vernier_pc_libs)
  set(folder "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
  cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig"
             OUTPUT_VARIABLE vernier_pc_prefix)
  configure_file(cmake/vernier.pc.in "${PROJECT_BINARY_DIR}/${vernier_pc_name}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${vernier_pc_name}.pc" DESTINATION "${folder}")
endfunction()
if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" AND NOT IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
  vernier_install_pc(vernier "${PROJECT_DESCRIPTION}" "" "")
  if(VERNIER_COMPILED)
    vernier_install_pc(vernier-compiled "${PROJECT_DESCRIPTION} (definitions in a library)" " -DVERNIER_COMPILED"
                       "-L\${libdir} -lvernier_compiled ")
  endif()
endif()

# Where Debian's Python looks for packages, below /usr and below /usr/local.
if(VERNIER_WITH_PYTHON)
  set(VERNIER_PYTHON_INSTALL_DIR "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/dist-packages" CACHE PATH
      "Folder of the Python package")
endif()

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_NAME libvernier-dev)
  set(CPACK_PACKAGE_CONTACT "Vernier maintainers")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
  # each is needed by the component of its name alone
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "nlohmann-json3-dev (>= 3.9), libceres-dev (>= 2.0)")
  set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libsuitesparse-dev, libtbb-dev, libtinyxml2-dev, libyaml-cpp-dev, mpi-default-dev, cmake (>= 3.25)")
  if(NOT VERNIER_COMPILED)
    set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE all)
  endif()
  if(VERNIER_WITH_PYTHON)
    # Two packages: python3-vernier has the component `python`, libvernier-dev all others.
    set(CPACK_DEB_COMPONENT_INSTALL ON)
    set(CPACK_STRIP_FILES ON)  # names take a sixth of the module
    set(CPACK_COMPONENTS_ALL Unspecified python)
    set(CPACK_COMPONENTS_GROUPING IGNORE)
    set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME libvernier-dev)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-vernier)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
    math(EXPR next "${Python3_VERSION_MINOR} + 1")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-scipy, python3-matplotlib")
    set(CPACK_COMPONENT_PYTHON_DESCRIPTION "${PROJECT_DESCRIPTION}: the Python module vernier")
  endif()
  include(CPack)
endif()
