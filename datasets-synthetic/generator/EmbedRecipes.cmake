# Writes OUT: the text of DIR/NAME.json for each of NAMES (with commas between), as C++ raw strings.
string(REPLACE "," ";" names "${NAMES}")
set(text "// Made by EmbedRecipes.cmake.\n#include \"Recipes.h\"\n\nnamespace vernier::phantoms {\n
const std::vector<std::pair<std::string, std::string>>& embeddedRecipes() {
  static const std::vector<std::pair<std::string, std::string>> all{\n")
foreach(name IN LISTS names)
  file(READ ${DIR}/${name}.json json)
  string(APPEND text "{\"${name}\", R\"recipe(${json})recipe\"},\n")
endforeach()
string(APPEND text "  };\n  return all;\n}\n\n}  // namespace vernier::phantoms\n")
file(WRITE ${OUT} "${text}")
