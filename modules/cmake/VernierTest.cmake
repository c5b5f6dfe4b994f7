# vernier_test(NAME SOURCES a.cpp... [LINK target...] [LABELS l...] [DEFINITIONS D=1...] [FIXTURES f...])
# A GoogleTest program; ctest runs its cases one by one, in parallel, with a time limit. TestPaths.h says where
# the repository, the build and the shared data (which may be absent) are.
include(GoogleTest)
function(vernier_test name)
  cmake_parse_arguments(T "" "TIMEOUT" "SOURCES;LINK;LABELS;DEFINITIONS;FIXTURES" ${ARGN})
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE vernier_flags ${T_LINK} vernier_test_paths GTest::gtest GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests/support)
  target_compile_definitions(${name} PRIVATE ${T_DEFINITIONS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS "${T_LABELS}" TIMEOUT ${T_TIMEOUT}
    FIXTURES_REQUIRED "${T_FIXTURES}"
    ENVIRONMENT "HOME=${CMAKE_BINARY_DIR}/empty-home;XDG_CONFIG_HOME=${CMAKE_BINARY_DIR}/empty-home;LC_ALL=C.UTF-8")
endfunction()
