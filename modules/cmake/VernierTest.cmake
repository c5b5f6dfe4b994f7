# vernier_test(NAME SOURCES a.cpp... [LINK target...] [LABELS l...] [DEFINITIONS D=1...] [FIXTURES f...])
# A GoogleTest program; ctest runs its cases one by one, in parallel, with a time limit. Tests find the repository by
# VERNIER_SOURCE_DIR and the shared data (which may be absent) by VERNIER_DATA_DIR.
include(GoogleTest)
function(vernier_test name)
  cmake_parse_arguments(T "" "TIMEOUT" "SOURCES;LINK;LABELS;DEFINITIONS;FIXTURES" ${ARGN})
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE vernier_flags ${T_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests/support)
  target_compile_definitions(${name} PRIVATE ${T_DEFINITIONS}
    VERNIER_SOURCE_DIR="${CMAKE_SOURCE_DIR}" VERNIER_DATA_DIR="${VERNIER_DATA_DIR}"
    VERNIER_BUILD_DIR="${CMAKE_BINARY_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS "${T_LABELS}" TIMEOUT ${T_TIMEOUT}
    FIXTURES_REQUIRED "${T_FIXTURES}"
    ENVIRONMENT "HOME=${CMAKE_BINARY_DIR}/empty-home;XDG_CONFIG_HOME=${CMAKE_BINARY_DIR}/empty-home;LC_ALL=C.UTF-8")
endfunction()
