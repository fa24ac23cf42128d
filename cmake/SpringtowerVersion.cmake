# Writes core/version.h into the build folder: the version, the commit and how the library was compiled.

include(GNUInstallDirs)
set(SPRINGTOWER_GENERATED_DIR "${PROJECT_BINARY_DIR}/generated")

set(SPRINGTOWER_GIT_COMMIT "unknown")
if(EXISTS "${PROJECT_SOURCE_DIR}/.git")
  find_package(Git QUIET)
  if(Git_FOUND)
    execute_process(
      COMMAND "${GIT_EXECUTABLE}" -C "${PROJECT_SOURCE_DIR}" rev-parse --short=12 HEAD
      OUTPUT_VARIABLE head
      RESULT_VARIABLE result
      OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(result EQUAL 0)
      set(SPRINGTOWER_GIT_COMMIT "${head}")
    endif()
    # Git appends to this log whenever HEAD moves: a new commit configures anew.
    execute_process(
      COMMAND "${GIT_EXECUTABLE}" -C "${PROJECT_SOURCE_DIR}" rev-parse --path-format=absolute --git-path logs/HEAD
      OUTPUT_VARIABLE head_log
      RESULT_VARIABLE result
      OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(result EQUAL 0 AND EXISTS "${head_log}")
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${head_log}")
    endif()
  endif()
endif()

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
list(JOIN SPRINGTOWER_COMPILE_OPTIONS " " options)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}} ${options}" SPRINGTOWER_COMPILER_FLAGS)
configure_file("${PROJECT_SOURCE_DIR}/core/version.h.in" "${SPRINGTOWER_GENERATED_DIR}/core/version.h" @ONLY)
