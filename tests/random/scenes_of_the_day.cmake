# Judges random scenes whose seeds come from the day on which this runs.
# cmake -D PROGRAM=random_scenes -D ARGUMENTS="--count;300" -P scenes_of_the_day.cmake
string(TIMESTAMP day "%Y%j" UTC)
set(from ${day}00000)
message("random_scenes --from ${from} ${ARGUMENTS}")
execute_process(COMMAND "${PROGRAM}" --from ${from} ${ARGUMENTS} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "random_scenes ended with ${result}")
endif()
