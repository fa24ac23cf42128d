# Writes core/version.h into the build folder: the version, the commit and how the library was compiled. It is looked at again with
# every build, as a commit or an edit may have come since, and written when something has changed.

include(GNUInstallDirs)
set(SPRINGTOWER_GENERATED_DIR "${PROJECT_BINARY_DIR}/generated")

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
list(JOIN SPRINGTOWER_COMPILE_OPTIONS " " options)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}} ${options}" SPRINGTOWER_COMPILER_FLAGS)
set(SPRINGTOWER_GIT_COMMIT "@SPRINGTOWER_GIT_COMMIT@") # stays for the script
configure_file("${PROJECT_SOURCE_DIR}/core/version.h.in" "${SPRINGTOWER_GENERATED_DIR}/version.h.in" @ONLY)

find_package(Git QUIET)
set(write_version
    "${CMAKE_COMMAND}" -D "GIT=${GIT_EXECUTABLE}" -D "SOURCE_DIR=${PROJECT_SOURCE_DIR}" -D
    "FROM=${SPRINGTOWER_GENERATED_DIR}/version.h.in" -D "TO=${SPRINGTOWER_GENERATED_DIR}/core/version.h" -P
    "${CMAKE_CURRENT_LIST_DIR}/SpringtowerWriteVersion.cmake")
execute_process(COMMAND ${write_version} COMMAND_ERROR_IS_FATAL ANY) # what reads the sources without a build needs it as well
add_custom_target(
  springtower_version
  COMMAND ${write_version}
  BYPRODUCTS "${SPRINGTOWER_GENERATED_DIR}/core/version.h"
  VERBATIM)
