# Writes OUT, the source of examples(), with the text of DIR/NAME.json for each of NAMES.
# cmake -DOUT=examples.cpp -DDIR=examples -DNAMES=unit,sphere -P embed_examples.cmake
string(REPLACE "," ";" names "${NAMES}")
set(rows "")
foreach(name ${names})
  file(READ "${DIR}/${name}.json" text)
  string(APPEND rows "    {\"${name}\", R\"popcut(${text})popcut\"},\n")
endforeach()
file(WRITE "${OUT}" "// Made from examples/*.json by embed_examples.cmake
#include \"daemon/examples/examples.hpp\"

namespace popcut {

std::span<const Example> examples() {
  static constexpr Example kExamples[] = {
${rows}  };
  return kExamples;
}

}  // namespace popcut
")
