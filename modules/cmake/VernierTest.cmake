# vernier_test(NAME SOURCES a.cpp... [LINK target...] [LABELS l...] [DEFINITIONS D=1...] [FIXTURES f...])
# A GoogleTest program; ctest runs its cases one by one, in parallel, with a time limit. TestPaths.h says where
# the repository, the build and the shared data (which may be absent) are.
include(GoogleTest)

# GoogleTest and the standard headers are parsed once for all test programs: that halves the time to build them from
# nothing. GCC 12 gives false array warnings where it inlines code that came out of a precompiled header; the modules,
# which are compiled without one, keep these warnings.
set(VERNIER_TEST_FLAGS $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread>)
if(NOT TARGET vernier_test_headers)
  file(WRITE ${CMAKE_BINARY_DIR}/generated/TestHeaders.cpp "")
  add_library(vernier_test_headers STATIC ${CMAKE_BINARY_DIR}/generated/TestHeaders.cpp)
  target_link_libraries(vernier_test_headers PRIVATE vernier_flags glm::glm GTest::gtest GTest::gmock)
  target_compile_options(vernier_test_headers PRIVATE ${VERNIER_TEST_FLAGS} $<$<CONFIG:Release>:-O1>)
  target_precompile_headers(vernier_test_headers PRIVATE <gtest/gtest.h> <gmock/gmock.h> <algorithm> <array> <cmath>
    <filesystem> <fstream> <functional> <map> <memory> <numbers> <optional> <random> <span> <sstream> <string> <vector>
    <glm/glm.hpp>)
endif()

function(vernier_test name)
  cmake_parse_arguments(T "" "TIMEOUT" "SOURCES;LINK;LABELS;DEFINITIONS;FIXTURES" ${ARGN})
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  if(VERNIER_SANITIZE)  # these builds run several times slower
    math(EXPR T_TIMEOUT "5 * ${T_TIMEOUT}")
  endif()
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE vernier_flags ${T_LINK} vernier_test_paths GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${VERNIER_TEST_FLAGS} $<$<CONFIG:Release>:-O1>)
  target_precompile_headers(${name} REUSE_FROM vernier_test_headers)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests/support)
  target_compile_definitions(${name} PRIVATE ${T_DEFINITIONS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60)
  # gtest_discover_tests takes lists apart (two labels would make the second one a property's name, and so the
  # environment), so ctest reads the properties from a file of their own, after the list of tests.
  set(properties ${CMAKE_CURRENT_BINARY_DIR}/${name}_properties.cmake)
  file(WRITE ${properties} "foreach(test IN LISTS ${name}_TESTS)
  set_tests_properties(\"\${test}\" PROPERTIES LABELS \"${T_LABELS}\" TIMEOUT ${T_TIMEOUT} FIXTURES_REQUIRED \"${T_FIXTURES}\"
    ENVIRONMENT \"HOME=${CMAKE_BINARY_DIR}/empty-home;XDG_CONFIG_HOME=${CMAKE_BINARY_DIR}/empty-home;LC_ALL=C.UTF-8\")
endforeach()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${properties})
endfunction()
