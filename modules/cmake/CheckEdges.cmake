# Run by ctest: cmake -P CheckEdges.cmake. The includes of all modules against the table of allowed edges.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/Edges.cmake)
file(GLOB folders ${CMAKE_CURRENT_LIST_DIR}/../*/CMakeLists.txt)
foreach(list IN LISTS folders)
  get_filename_component(folder ${list} DIRECTORY)
  get_filename_component(name ${folder} NAME)
  vernier_check_includes(${name} ${folder})
endforeach()
