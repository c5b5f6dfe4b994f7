# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DBUILD=... -DPREFIX=... -P InstallTest.cmake: what `cmake --install` writes runs from there, with its plugin.
file(REMOVE_RECURSE ${PREFIX})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH --unset=VERNIER_PLUGINS
  ${PREFIX}/bin/vernier plugins OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
if(NOT said MATCHES "mpr +[0-9.]+ +loaded")
  message(FATAL_ERROR "the installed program does not load its plugin: ${said}")
endif()
file(REMOVE_RECURSE ${PREFIX})
