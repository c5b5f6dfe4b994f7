# SPDX-License-Identifier: GPL-3.0-or-later
# Builds a copy of plugins/example as a newcomer does: a folder of its own, find_package(vernier) in an installed tree.
# Once in the way that Vernier was built, once in another way, which the program must refuse.
# PREFIX, EXAMPLE, OUT, GENERATOR, COMPILER, LAUNCHER, BUILD_TYPE, TYPE_FLAGS (of that type), SANITIZE
set(otherType Debug)
if(BUILD_TYPE STREQUAL Debug)
  set(otherType Release)
endif()
set(flags "")
if(SANITIZE)
  set(flags -fsanitize=${SANITIZE})
endif()
file(REMOVE_RECURSE ${OUT})
file(COPY ${EXAMPLE} DESTINATION ${OUT})
foreach(kind same other)
  set(type ${BUILD_TYPE})
  string(TOUPPER ${type} TYPE)
  set(ofType "-DCMAKE_CXX_FLAGS_${TYPE}=${TYPE_FLAGS}")
  if(kind STREQUAL other)
    set(type ${otherType})
    set(ofType "")
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${OUT}/example -B ${OUT}/${kind} -G ${GENERATOR}
      -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=${type} -DCMAKE_CXX_COMPILER=${COMPILER}
      "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DCMAKE_CXX_FLAGS=${flags}" ${ofType} -DCMAKE_INSTALL_PREFIX=${OUT}/${kind}-installed
    OUTPUT_VARIABLE said ERROR_VARIABLE warned RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "the example does not configure (${type}):\n${said}\n${warned}")
  endif()
  if(kind STREQUAL other AND NOT warned MATCHES "other ABI")
    message(FATAL_ERROR "nobody warned that ${type} is not ${BUILD_TYPE}:\n${warned}")
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${OUT}/${kind} --target install OUTPUT_VARIABLE said
    ERROR_VARIABLE said RESULT_VARIABLE failed)
  if(failed OR NOT EXISTS ${OUT}/${kind}/lib/vernier/plugins/example/example.so)
    message(FATAL_ERROR "the example does not build (${type}):\n${said}")
  endif()
endforeach()
