# vernier_module(NAME SOURCES a.cpp... [USES base study...] [PRIVATE lib...] [TECHNIQUE] [FEATURES cxx_std_17])
#
# One call declares a module: a static library vernier_NAME with public headers in include/ and everything else hidden.
# Core modules are linked whole into libvernier.so; unit tests link the static libraries, so that they reach what is
# hidden. A TECHNIQUE is linked into its plugin only, and takes the core from libvernier.so.
include(${CMAKE_CURRENT_LIST_DIR}/Edges.cmake)

add_library(vernier_flags INTERFACE)
target_compile_features(vernier_flags INTERFACE cxx_std_20)
target_compile_options(vernier_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Werror
  -fvisibility=hidden -fvisibility-inlines-hidden -ffp-contract=off -fno-fast-math)
# GCC 12 warns of overlapping copies in plain std::string concatenation (its bug 105651); there is nothing to mend.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(vernier_flags INTERFACE -Wno-restrict)
endif()
if(VERNIER_SANITIZE)
  target_compile_options(vernier_flags INTERFACE -fsanitize=${VERNIER_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(vernier_flags INTERFACE -fsanitize=${VERNIER_SANITIZE})
else()
  target_compile_options(vernier_flags INTERFACE -march=x86-64-v2 -fstack-protector-strong
    $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>)
endif()
# What whoever includes our headers must define too.
set(VERNIER_PUBLIC_DEFINITIONS GLM_FORCE_XYZW_ONLY _GLIBCXX_ASSERTIONS)
target_compile_definitions(vernier_flags INTERFACE ${VERNIER_PUBLIC_DEFINITIONS})

function(vernier_module name)
  cmake_parse_arguments(M "TECHNIQUE" "" "SOURCES;USES;PRIVATE" ${ARGN})
  if(M_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "vernier_module(${name}): unknown ${M_UNPARSED_ARGUMENTS}")
  endif()
  vernier_check_edges(${name} ${M_USES})
  vernier_check_includes(${name} ${CMAKE_CURRENT_SOURCE_DIR})
  add_library(vernier_${name} STATIC ${M_SOURCES})
  set_target_properties(vernier_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(vernier_${name} PUBLIC include PRIVATE src)
  target_link_libraries(vernier_${name} PRIVATE vernier_flags PUBLIC glm::glm)
  # Third-party headers are SYSTEM: their warnings are not ours.
  target_link_libraries(vernier_${name} PRIVATE ${M_PRIVATE})
  if(M_TECHNIQUE)
    target_link_libraries(vernier_${name} PUBLIC vernier)
  else()
    foreach(used IN LISTS M_USES)
      target_link_libraries(vernier_${name} PUBLIC vernier_${used})
    endforeach()
  endif()
endfunction()
