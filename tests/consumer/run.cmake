# Takes SPRINGTOWER_BUILD_DIR, WORK_DIR, GENERATOR, COMPILER and BUILD_TYPE. Every step must succeed.

file(REMOVE_RECURSE "${WORK_DIR}")

function(step)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

step("${CMAKE_COMMAND}" --install "${SPRINGTOWER_BUILD_DIR}" --prefix "${WORK_DIR}/prefix")

# The public headers and no others are installed, and each compiles alone with nothing but the prefix to look in.
set(include "${WORK_DIR}/prefix/include")
file(GLOB_RECURSE installed RELATIVE "${include}" "${include}/*")
set(expected)
foreach(name IN ITEMS inputs query scene settings springtower statics world)
  list(APPEND expected "springtower/${name}.h")
endforeach()
list(SORT installed)
if(NOT "${installed}" STREQUAL "${expected}")
  message(FATAL_ERROR "installed headers: expected ${expected}, got ${installed}")
endif()
foreach(header IN LISTS installed)
  file(WRITE "${WORK_DIR}/alone.cpp" "#include <${header}>\n")
  step("${COMPILER}" -std=c++20 -Wall -Wextra -Wpedantic -Werror "-I${include}" -fsyntax-only "${WORK_DIR}/alone.cpp")
endforeach()

step(
  "${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${WORK_DIR}/build" -G "${GENERATOR}"
  "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}" "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix")
step("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
step("${WORK_DIR}/build/consumer")
