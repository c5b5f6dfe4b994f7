# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DBUILD=... -DPREFIX=... "-DPLUGINS=mpr ..." -P InstallTest.cmake: what `cmake --install` writes runs from there,
# with every plugin of the build, and not by chance with the libraries of the build folder.
file(REMOVE_RECURSE ${PREFIX})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH --unset=VERNIER_PLUGINS LD_TRACE_LOADED_OBJECTS=1
  ${PREFIX}/bin/vernier OUTPUT_VARIABLE links COMMAND_ERROR_IS_FATAL ANY)
if(NOT links MATCHES "libvernier.so.0 => ${PREFIX}/")
  message(FATAL_ERROR "the installed program takes libvernier from elsewhere: ${links}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH --unset=VERNIER_PLUGINS
  ${PREFIX}/bin/vernier plugins OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(PLUGINS)
if(NOT PLUGINS)
  message(FATAL_ERROR "the build has no plugin")
endif()
foreach(plugin IN LISTS PLUGINS)
  if(NOT said MATCHES "${plugin} +[0-9.]+ +loaded")
    message(FATAL_ERROR "the installed program does not load its plugin ${plugin}: ${said}")
  endif()
endforeach()
# What plugins bring beside their libraries: the folders that the build has.
file(GLOB_RECURSE built RELATIVE ${BUILD}/lib/vernier/plugins ${BUILD}/lib/vernier/plugins/*.json)
foreach(file IN LISTS built)
  if(NOT EXISTS ${PREFIX}/lib/vernier/plugins/${file})
    message(FATAL_ERROR "${file} of the build's plugins is not installed")
  endif()
endforeach()
if(NOT said MATCHES "combiners [a-z -]* iso ")
  message(FATAL_ERROR "the installed plugin dvr has no combiner iso: ${said}")
endif()
# The suite that comes with the program is there, and passes on the installed engine that needs no driver.
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH --unset=VERNIER_PLUGINS
  ${PREFIX}/bin/vernier qa run clinic --engine native WORKING_DIRECTORY ${PREFIX}
  OUTPUT_VARIABLE said ERROR_VARIABLE failed RESULT_VARIABLE code)
if(NOT code EQUAL 0 OR NOT said MATCHES "cases pass")
  message(FATAL_ERROR "the installed program does not pass its own suite: ${failed}")
endif()
