# Flags and helpers shared by every target of the project.

set(SPRINGTOWER_COMPILE_OPTIONS
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    # Results must be equal bit for bit on every machine and in every kernel variant. Contraction would fuse a*b+c to one rounding
    # wherever the target has FMA and nowhere else.
    -ffp-contract=off
    # Neither changes a value. Without errno a square root is one instruction; without observable floating-point traps a select may
    # evaluate both sides. Loops with either can then be vectorised.
    -fno-math-errno -fno-trapping-math)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # gcc 12 takes fused instructions (vfmaddsub) for pairs of a*b+c and a*b-c whatever -ffp-contract says. These come after what a user
  # has chosen, such as -march=native; kernels that use AVX2 say so themselves.
  list(APPEND SPRINGTOWER_COMPILE_OPTIONS -mno-fma -mno-fma4 -mno-avx512f)
endif()

if(SPRINGTOWER_SANITIZE)
  list(APPEND SPRINGTOWER_COMPILE_OPTIONS -fsanitize=${SPRINGTOWER_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
endif()

# Gives a target of ours the language standard and flags. They stay private: a project that uses the library keeps its own.
function(springtower_configure_target target)
  target_compile_options(${target} PRIVATE ${SPRINGTOWER_COMPILE_OPTIONS})
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_features(${target} PUBLIC cxx_std_20)
  add_dependencies(${target} springtower_version)  # core/version.h
  if(SPRINGTOWER_SANITIZE)
    # Public, because whoever links an instrumented library needs the run-time of the sanitizer.
    target_link_options(${target} PUBLIC -fsanitize=${SPRINGTOWER_SANITIZE})
  endif()
endfunction()

# What most sources of a target read is read once for all of them. Every source and header still includes what it uses: tests/structure
# looks at headers, clang-tidy reads the sources without this, and the presets debug and asan do not join sources.
function(springtower_precompile target)
  target_precompile_headers(
    ${target} PRIVATE <algorithm> <array> <cmath> <cstdint> <limits> <memory> <optional> <span> <string> <string_view> <vector>
    <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <Eigen/LU> ${ARGN})
endfunction()

# springtower_add_library(<folder> [WITHOUT <folder in it>] PUBLIC <targets> PRIVATE <targets>)
# Adds springtower_<folder> from all sources of the current folder and the folders in it, but for one that is a library of its own.
# A folder that has only headers becomes an interface library.
function(springtower_add_library folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "WITHOUT" "PUBLIC;PRIVATE")
  set(target springtower_${folder})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp")
  if(arg_WITHOUT)
    list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${arg_WITHOUT}/")
  endif()
  if(sources)
    add_library(${target} STATIC ${sources})
    springtower_configure_target(${target})
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
    set(scope PUBLIC)
  else()
    add_library(${target} INTERFACE)
    target_compile_features(${target} INTERFACE cxx_std_20)
    target_link_libraries(${target} INTERFACE ${arg_PUBLIC})
    set(scope INTERFACE)
  endif()
  # Outside this project no code includes its headers: they are not installed.
  target_include_directories(${target} ${scope} "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
                                                "$<BUILD_INTERFACE:${SPRINGTOWER_GENERATED_DIR}>")
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder})
  add_library(springtower::${folder} ALIAS ${target})
endfunction()

# springtower_add_program(<target> NAME <file name> SOURCES <files> LIBRARIES <targets>)
# Adds a program of the repository, which goes into bin/ of the build folder.
function(springtower_add_program target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "NAME" "SOURCES;LIBRARIES")
  add_executable(${target} ${arg_SOURCES})
  springtower_configure_target(${target})
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${target} PRIVATE springtower::engine ${arg_LIBRARIES})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${arg_NAME} RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
endfunction()
