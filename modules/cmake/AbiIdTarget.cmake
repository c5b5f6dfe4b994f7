# vernier_abi_id(OUT file ROOTS folder...)
# The target vernier_abi, which writes AbiId.h for this build (AbiId.cmake says what stands in it).
function(vernier_abi_id)
  cmake_parse_arguments(A "" "OUT" "ROOTS" ${ARGN})
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  string(REGEX MATCHALL "-fsanitize=[^ ]+" sanitizers "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}")
  if(VERNIER_SANITIZE)
    list(APPEND sanitizers "-fsanitize=${VERNIER_SANITIZE}")
  endif()
  set(headers "")
  foreach(root IN LISTS A_ROOTS)
    file(GLOB found CONFIGURE_DEPENDS ${root}/vernier/*/*.h ${root}/vernier/*/*.def)
    list(APPEND headers ${found})
  endforeach()
  list(JOIN A_ROOTS "|" roots)
  add_custom_command(OUTPUT ${A_OUT}.stamp BYPRODUCTS ${A_OUT}
    COMMAND ${CMAKE_COMMAND} -DOUT=${A_OUT} "-DROOTS=${roots}"
      "-DTOOLCHAIN=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${sanitizers}"
      -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/AbiId.cmake
    COMMAND ${CMAKE_COMMAND} -E touch ${A_OUT}.stamp
    DEPENDS ${headers} ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/AbiId.cmake VERBATIM)
  add_custom_target(vernier_abi DEPENDS ${A_OUT}.stamp)
endfunction()
