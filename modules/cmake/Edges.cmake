# The table of allowed edges between modules. A module may use only what stands here; a new edge fails configure until
# it is added here, in a reviewed diff. Techniques see the core through libvernier.
set(VERNIER_EDGES_base "")
set(VERNIER_EDGES_study base)
set(VERNIER_EDGES_volume base study)
set(VERNIER_EDGES_plan base study volume)
set(VERNIER_EDGES_gpu base volume plan)
set(VERNIER_EDGES_native base volume plan)
set(VERNIER_EDGES_quality base volume plan)
set(VERNIER_EDGES_picture base volume plan)
set(VERNIER_EDGES_mpr base volume plan gpu native)
# volume's headers speak of study's plain types (windows, findings), so whoever sees volume sees those.
set(VERNIER_CORE_MODULES base study volume plan gpu native quality picture)

function(vernier_check_edges name)
  foreach(used IN LISTS ARGN)
    if(NOT used IN_LIST VERNIER_EDGES_${name})
      message(FATAL_ERROR "Module '${name}' may not use '${used}': the edge is not in modules/cmake/Edges.cmake "
        "(allowed: ${VERNIER_EDGES_${name}})")
    endif()
  endforeach()
endfunction()
