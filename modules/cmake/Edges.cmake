# The table of allowed edges between modules. A module may use only what stands here; a new edge fails configure until
# it is added here, in a reviewed diff. Techniques see the core through libvernier.
set(VERNIER_EDGES_base "")
set(VERNIER_EDGES_study base)
set(VERNIER_EDGES_volume base study)
set(VERNIER_EDGES_plan base volume)
set(VERNIER_EDGES_gpu base volume plan)
set(VERNIER_EDGES_native base volume plan)
set(VERNIER_EDGES_quality base volume plan)
set(VERNIER_EDGES_picture base volume plan)
set(VERNIER_EDGES_measure base volume)
set(VERNIER_EDGES_lens base volume plan gpu native)
set(VERNIER_EDGES_angiography base volume plan gpu native)
set(VERNIER_EDGES_dvr base volume plan gpu native)
set(VERNIER_EDGES_mpr base volume plan gpu native)
set(VERNIER_EDGES_surfaces base volume plan gpu native)
# volume's headers speak of study's plain types (windows, findings), so whoever sees volume sees those types; the
# headers of study stay closed to them.
set(VERNIER_CORE_MODULES base study volume plan gpu native quality picture measure)

function(vernier_check_edges name)
  foreach(used IN LISTS ARGN)
    if(NOT used IN_LIST VERNIER_EDGES_${name})
      message(FATAL_ERROR "Module '${name}' may not use '${used}': the edge is not in modules/cmake/Edges.cmake "
        "(allowed: ${VERNIER_EDGES_${name}})")
    endif()
  endforeach()
endfunction()

# What a module links to brings its own headers along, so the includes themselves are read: each of "vernier/X/..." in
# FOLDER must be the module's own or an allowed one. Also a test (CheckEdges.cmake), since files change after configure.
function(vernier_check_includes name folder)
  file(GLOB_RECURSE files ${folder}/*.h ${folder}/*.cpp)
  foreach(file IN LISTS files)
    file(STRINGS ${file} lines REGEX "^ *#include +\"vernier/[a-z0-9]+/")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE ".*\"vernier/([a-z0-9]+)/.*" "\\1" used "${line}")
      if(NOT used STREQUAL name AND NOT used IN_LIST VERNIER_EDGES_${name})
        message(FATAL_ERROR "${file} includes a header of '${used}': module '${name}' may only use "
          "${VERNIER_EDGES_${name}} (modules/cmake/Edges.cmake)")
      endif()
    endforeach()
  endforeach()
endfunction()
