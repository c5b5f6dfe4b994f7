# vernier_plugin(NAME SOURCES a.cpp... [MODULES mpr...] CARD plugin.json.in)
# A loadable library build/lib/vernier/plugins/NAME/NAME.so with its card plugin.json beside it. It takes the core from
# libvernier and links its technique modules in; never GL, GLFW or OSMesa.
function(vernier_plugin name)
  cmake_parse_arguments(P "" "CARD" "SOURCES;MODULES" ${ARGN})
  set(folder ${CMAKE_BINARY_DIR}/lib/vernier/plugins/${name})
  add_library(plugin_${name} MODULE ${P_SOURCES})
  target_link_libraries(plugin_${name} PRIVATE vernier_flags vernier)
  foreach(module IN LISTS P_MODULES)
    target_link_libraries(plugin_${name} PRIVATE vernier_${module})
  endforeach()
  set_target_properties(plugin_${name} PROPERTIES PREFIX "" OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${folder} BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "$ORIGIN/../../..;$ORIGIN/../../../../lib")
  configure_file(${P_CARD} ${folder}/plugin.json @ONLY)
endfunction()
