# Install and export: find_package(springtower) gives springtower::springtower.

include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/springtower")

install(
  TARGETS springtower_api springtower_core springtower_broadphase springtower_narrowphase springtower_solver springtower_scenarios
  EXPORT springtowerTargets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(EXPORT springtowerTargets NAMESPACE springtower:: DESTINATION "${package_dir}")

# The public interface alone; it includes nothing but the standard library.
install(
  DIRECTORY include/springtower
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILES_MATCHING PATTERN "*.h")

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/springtowerConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/springtowerConfig.cmake" INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/springtowerConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/springtowerConfig.cmake" "${PROJECT_BINARY_DIR}/springtowerConfigVersion.cmake"
              "${CMAKE_CURRENT_LIST_DIR}/FindClp.cmake"
        DESTINATION "${package_dir}")
