# Run with -P at build time: writes OUT with VERNIER_ABI_ID, which says of a build whether it and libvernier can share
# C++ objects: a hash of TOOLCHAIN (compiler, build type, sanitizers) and of the public headers of the core modules,
# then what only the compiler knows (standard library, debug containers, assertions). Vernier's own build and a plugin's
# build elsewhere both run this file, over the source tree or over the installed headers, so that each speaks of itself.
#   ROOTS      folders that hold vernier/MODULE/*.h, divided by |
#   TOOLCHAIN  text
# The file is touched only when the id changes.
string(REPLACE "|" ";" ROOTS "${ROOTS}")
set(entries "")
foreach(root IN LISTS ROOTS)
  file(GLOB headers RELATIVE ${root} ${root}/vernier/*/*.h ${root}/vernier/*/*.def)
  foreach(header IN LISTS headers)
    file(SHA256 ${root}/${header} hash)
    list(APPEND entries "${header} ${hash}")
  endforeach()
endforeach()
if(entries STREQUAL "")
  message(FATAL_ERROR "No public headers of Vernier in ${ROOTS}")
endif()
list(SORT entries)
string(SHA256 id "${TOOLCHAIN} ${entries}")
string(SUBSTRING ${id} 0 32 id)
string(CONFIGURE [[// Made at build time; see modules/cmake/AbiId.cmake.
#pragma once
#include <cstddef>
#define VERNIER_ABI_TEXT2(x) #x
#define VERNIER_ABI_TEXT(x) VERNIER_ABI_TEXT2(x)
#ifdef NDEBUG
#define VERNIER_ABI_ASSERT ""
#else
#define VERNIER_ABI_ASSERT "+assert"
#endif
#ifdef _GLIBCXX_DEBUG
#define VERNIER_ABI_CONTAINERS "+debug-containers"
#else
#define VERNIER_ABI_CONTAINERS ""
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VERNIER_ABI_SANITIZE "+sanitize"
#else
#define VERNIER_ABI_SANITIZE ""
#endif
#define VERNIER_ABI_ID                                                                                     \
  "@id@-libstdc++" VERNIER_ABI_TEXT(__GLIBCXX__) "-" VERNIER_ABI_TEXT(_GLIBCXX_USE_CXX11_ABI) \
      VERNIER_ABI_ASSERT VERNIER_ABI_CONTAINERS VERNIER_ABI_SANITIZE
]] content @ONLY)
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT "${old}" STREQUAL "${content}")
  file(WRITE ${OUT} "${content}")
endif()
