# vernier_embed_text(TARGET target FUNCTION ns::name FILES a.glsl b.glsl...)
#
# Compiles text files into the target: `std::string_view ns::name(std::string_view fileName)` gives a file's text, or an
# empty view for a name that is not there. The .cpp is made again whenever a file changes. Run with -P, this file is the
# generator itself.
if(CMAKE_SCRIPT_MODE_FILE)
  string(REGEX REPLACE "::[^:]*$" "" namespace "${FUNCTION}")
  string(REGEX REPLACE "^.*::" "" name "${FUNCTION}")
  set(code "// Made by EmbedText.cmake; do not edit.\n#include <string_view>\n\nnamespace ${namespace} {\n")
  string(APPEND code "std::string_view ${name}(std::string_view fileName);\n")
  string(APPEND code "std::string_view ${name}(std::string_view fileName) {\n")
  string(REPLACE "|" ";" FILES "${FILES}")
  foreach(file IN LISTS FILES)
    get_filename_component(base "${file}" NAME)
    file(READ "${file}" text)
    string(APPEND code "  if (fileName == \"${base}\") return R\"text(${text})text\";\n")
  endforeach()
  string(APPEND code "  return {};\n}\n}  // namespace ${namespace}\n")
  file(WRITE "${OUTPUT}" "${code}")
  return()
endif()

set(VERNIER_EMBED_TEXT ${CMAKE_CURRENT_LIST_FILE})
function(vernier_embed_text)
  cmake_parse_arguments(E "" "TARGET;FUNCTION" "FILES" ${ARGN})
  string(REGEX REPLACE "^.*::" "" name "${E_FUNCTION}")
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp)
  list(TRANSFORM E_FILES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  list(JOIN E_FILES "|" joined)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DFUNCTION=${E_FUNCTION} "-DFILES=${joined}" -DOUTPUT=${output} -P ${VERNIER_EMBED_TEXT}
    DEPENDS ${E_FILES} ${VERNIER_EMBED_TEXT} VERBATIM)
  target_sources(${E_TARGET} PRIVATE ${output})
endfunction()
