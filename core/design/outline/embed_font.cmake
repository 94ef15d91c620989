# Writes the source of popcut::usual_font(), which holds the bytes of a font.
# cmake -DOUT=usual_font.cpp -DFONT=FILE.ttf -P embed_font.cmake
file(READ "${FONT}" hex HEX)
string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${hex}")
string(LENGTH "${hex}" digits)
math(EXPR size "${digits} / 2")
file(WRITE "${OUT}" "// Made by embed_font.cmake
#include \"core/design/outline/text_outline.hpp\"

namespace popcut {

std::string_view usual_font() {
  static const char bytes[] = \"${bytes}\";
  return {bytes, ${size}};
}

}  // namespace popcut
")
