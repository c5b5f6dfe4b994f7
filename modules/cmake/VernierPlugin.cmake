# vernier_plugin(NAME SOURCES a.cpp... [MODULES mpr...] CARD plugin.json.in [DATA folder...])
# A loadable library NAME.so with its card plugin.json beside it, in lib/vernier/plugins/NAME under the build folder and
# under the install prefix; so do the folders of DATA, with all files that lie in them. It takes the core from libvernier and links its technique modules in; never GL, GLFW or
# OSMesa. The same call works in Vernier's own tree and in a project elsewhere that has found the package vernier.
function(vernier_plugin name)
  cmake_parse_arguments(P "" "CARD" "SOURCES;MODULES;DATA" ${ARGN})
  if(P_UNPARSED_ARGUMENTS OR NOT P_SOURCES OR NOT P_CARD)
    message(FATAL_ERROR "vernier_plugin(${name}): SOURCES and CARD are needed, unknown are: ${P_UNPARSED_ARGUMENTS}")
  endif()
  set(folder ${CMAKE_BINARY_DIR}/lib/vernier/plugins/${name})
  add_library(plugin_${name} MODULE ${P_SOURCES})
  target_link_libraries(plugin_${name} PRIVATE vernier::vernier)
  if(TARGET vernier_flags)
    target_link_libraries(plugin_${name} PRIVATE vernier_flags)
  else()
    target_compile_options(plugin_${name} PRIVATE -Wall -Wextra -fvisibility-inlines-hidden -ffp-contract=off)
  endif()
  foreach(module IN LISTS P_MODULES)
    target_link_libraries(plugin_${name} PRIVATE vernier_${module})
  endforeach()
  add_dependencies(plugin_${name} vernier_abi)
  # libvernier is in the program already when a plugin is loaded; the paths are for tools that look at the file alone.
  set_target_properties(plugin_${name} PROPERTIES PREFIX "" OUTPUT_NAME ${name} CXX_VISIBILITY_PRESET hidden
    LIBRARY_OUTPUT_DIRECTORY ${folder} BUILD_RPATH "$ORIGIN/../../.." INSTALL_RPATH "$ORIGIN/../..")
  configure_file(${P_CARD} ${folder}/plugin.json @ONLY)
  foreach(data IN LISTS P_DATA)
    # Files that were added, changed or removed make the next build configure anew.
    file(GLOB files CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${data}/*)
    file(REMOVE_RECURSE ${folder}/${data})
    foreach(file IN LISTS files)
      configure_file(${file} ${folder}/${file} COPYONLY)
    endforeach()
    install(DIRECTORY ${folder}/${data} DESTINATION lib/vernier/plugins/${name} COMPONENT vernier)
  endforeach()
  install(TARGETS plugin_${name} LIBRARY DESTINATION lib/vernier/plugins/${name} COMPONENT vernier)
  install(FILES ${folder}/plugin.json DESTINATION lib/vernier/plugins/${name} COMPONENT vernier)
  # What the tests of installation and package expect to find; nobody keeps a list by hand.
  set_property(GLOBAL APPEND PROPERTY VERNIER_PLUGINS ${name})
endfunction()
