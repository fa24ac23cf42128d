# One source file for each header, which includes nothing else: a header that leans on what its users happened to include before it
# does not compile. A header with a source of its own name needs none: that includes it first. Nothing is run, so nothing is
# optimised. It takes minutes, as most headers read Eigen, so it is no part of test.sh: tests/structure looks in the text of headers
# for what they use of the standard library and of the project and do not include.

find_package(GTest REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(benchmark REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo)

set(check_sources)
foreach(folder IN ITEMS core broadphase narrowphase solver scenarios api apps bench tests)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/${folder}/*.h")
  foreach(header IN LISTS headers)
    string(REGEX REPLACE "\\.h$" ".cpp" own "${header}")
    if(EXISTS "${PROJECT_SOURCE_DIR}/${own}")
      continue()
    endif()
    set(source "${PROJECT_BINARY_DIR}/header_checks/${header}.cpp")
    file(CONFIGURE OUTPUT "${source}" CONTENT "#include \"@header@\"\n" @ONLY)
    list(APPEND check_sources "${source}")
  endforeach()
endforeach()

# Public headers get no include path but their own, as outside this project.
file(GLOB headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}/include" "${PROJECT_SOURCE_DIR}/include/springtower/*.h")
set(public_check_sources)
foreach(header IN LISTS headers)
  set(source "${PROJECT_BINARY_DIR}/header_checks/include/${header}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "#include <@header@>\n" @ONLY)
  list(APPEND public_check_sources "${source}")
endforeach()
add_library(springtower_public_header_checks OBJECT ${public_check_sources})
springtower_configure_target(springtower_public_header_checks)
target_compile_options(springtower_public_header_checks PRIVATE -O0)
target_include_directories(springtower_public_header_checks PRIVATE "${PROJECT_SOURCE_DIR}/include")

if(check_sources)
  add_library(springtower_header_checks OBJECT ${check_sources})
  springtower_configure_target(springtower_header_checks)
  target_compile_options(springtower_header_checks PRIVATE -O0)
  target_include_directories(springtower_header_checks PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(
    springtower_header_checks PRIVATE springtower::engine springtower::springtower CLI11::CLI11 nlohmann_json::nlohmann_json fmt::fmt
                                      tomlplusplus::tomlplusplus PkgConfig::cairo benchmark::benchmark GTest::gmock)
  target_compile_definitions(
    springtower_header_checks PRIVATE SPRINGTOWER_SOURCE_DIR="" SPRINGTOWER_BINARY_DIR="" SPRINGTOWER_TEST_DATA_DIR=""
                                      SPRINGTOWER_SHARED_DIR="")
endif()
