# Writes the bytes of IN as the array NAME into the C++ file OUT: cmake -DIN=... -DOUT=... -DNAME=... -P EmbedFont.cmake
# A string literal, since compilers read it a hundred times faster than a list of numbers.
file(READ ${IN} hex HEX)
string(LENGTH "${hex}" digits)
math(EXPR bytes "${digits} / 2")
string(REGEX REPLACE "(................................................................)" "\\1\"\n  \"" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" hex "${hex}")
file(WRITE ${OUT} "// Made by EmbedFont.cmake; not to be edited.
#pragma GCC diagnostic ignored \"-Woverlength-strings\"
namespace vernier {
extern const unsigned char ${NAME}[];
extern const unsigned ${NAME}_bytes;
const unsigned ${NAME}_bytes = ${bytes};
const unsigned char ${NAME}[${bytes} + 1] =
  \"${hex}\";
}  // namespace vernier
")
