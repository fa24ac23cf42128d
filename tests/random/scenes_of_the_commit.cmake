# Judges random scenes whose seeds come from the commit: every commit has others, and one commit always the same.
# cmake -D PROGRAM=random_scenes -D SOURCE_DIR=DIR -D FOLDER=DIR -D ARGUMENTS="--count;300" -P scenes_of_the_commit.cmake
set(from 1000000) # outside of git
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(
    COMMAND "${GIT_EXECUTABLE}" -C "${SOURCE_DIR}" rev-parse HEAD
    OUTPUT_VARIABLE head
    RESULT_VARIABLE result
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(result EQUAL 0)
    string(SUBSTRING "${head}" 0 12 digits)
    math(EXPR from "0x${digits}")
  endif()
endif()
message("random_scenes --from ${from} ${ARGUMENTS}")
execute_process(COMMAND "${PROGRAM}" --from ${from} ${ARGUMENTS} RESULT_VARIABLE result)
if(result EQUAL 1) # more faults than the bounds allow
  set(smaller "${FOLDER}/${from}")
  file(MAKE_DIRECTORY "${smaller}")
  message("Again, to make scenes with faults smaller, what must never be first: into ${smaller}")
  execute_process(COMMAND "${PROGRAM}" --from ${from} ${ARGUMENTS} --minutes 3 --shrink "${smaller}")
endif()
if(NOT result EQUAL 0)
  message(FATAL_ERROR "random_scenes ended with ${result}")
endif()
