# Puts the commit into core/version.h, with -dirty after it where files of the clone differ from it; "unknown" outside a git clone.
# cmake -D GIT=git -D SOURCE_DIR=DIR -D FROM=version.h.in -D TO=version.h -P SpringtowerWriteVersion.cmake
cmake_minimum_required(VERSION 3.25)

set(SPRINGTOWER_GIT_COMMIT "unknown")
if(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(
    COMMAND "${GIT}" -C "${SOURCE_DIR}" rev-parse --short=12 HEAD
    OUTPUT_VARIABLE head
    RESULT_VARIABLE result
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(result EQUAL 0)
    set(SPRINGTOWER_GIT_COMMIT "${head}")
    # As git diff-index HEAD, but a file that was only touched does not count. No lock is taken: git may be at work meanwhile.
    execute_process(
      COMMAND "${GIT}" --no-optional-locks -C "${SOURCE_DIR}" status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes
      RESULT_VARIABLE result
      ERROR_QUIET)
    if(NOT result EQUAL 0 OR NOT changes STREQUAL "")
      string(APPEND SPRINGTOWER_GIT_COMMIT "-dirty")
    endif()
  endif()
endif()
configure_file("${FROM}" "${TO}" @ONLY)
