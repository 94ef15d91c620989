# Writes SOURCE with the text of each of TEXTS (name=file) as a constant of popcut::.
# cmake -DOUT=tables.cpp -DHEADER=core/machines/table.hpp "-DTEXTS=kMachinesJson=machines.json;..." -P embed.cmake
set(code "// Made from core/data by embed.cmake\n#include \"${HEADER}\"\n\nnamespace popcut {\n")
foreach(entry ${TEXTS})
  string(REPLACE "=" ";" pair "${entry}")
  list(GET pair 0 name)
  list(GET pair 1 file)
  file(READ "${file}" text)
  string(APPEND code "const std::string_view ${name} = R\"popcut(${text})popcut\";\n")
endforeach()
file(WRITE "${OUT}" "${code}}  // namespace popcut\n")
