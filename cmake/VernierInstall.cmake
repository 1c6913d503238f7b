# The headers, and a package for find_package(vernier [COMPONENTS io ceres tbb mpi]).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(vernier_package_dir "${CMAKE_INSTALL_DATADIR}/cmake/vernier")

foreach(target vernier vernier_io vernier_ceres vernier_tbb vernier_mpi)
  string(REPLACE "_" "-" export ${target})
  install(TARGETS ${target} EXPORT ${export} FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  install(EXPORT ${export} NAMESPACE vernier:: FILE ${export}-targets.cmake DESTINATION "${vernier_package_dir}")
endforeach()

configure_package_config_file(cmake/vernierConfig.cmake.in "${PROJECT_BINARY_DIR}/vernierConfig.cmake"
                              INSTALL_DESTINATION "${vernier_package_dir}"
                              NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/vernierConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES "${PROJECT_BINARY_DIR}/vernierConfig.cmake" "${PROJECT_BINARY_DIR}/vernierConfigVersion.cmake"
        DESTINATION "${vernier_package_dir}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
