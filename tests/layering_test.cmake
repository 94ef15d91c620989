# layering.cmake finds what it looks for: in made-up trees with one fault each, and in one without.
# -DCHECK=layering.cmake -DFOLDER=scratch
cmake_minimum_required(VERSION 3.20)

# expect(NAME MESSAGE path content ...): the check of a tree of these files fails with MESSAGE, or
# passes where it is empty.
function(expect name message)
  set(tree ${FOLDER}/${name})
  file(REMOVE_RECURSE ${tree})
  file(WRITE ${tree}/daemon/main.cpp "")
  set(files "${ARGN}")
  while(files)
    list(POP_FRONT files path content)
    file(WRITE ${tree}/${path} "${content}\n")
  endwhile()
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${tree} -P ${CHECK}
    RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE err)
  string(REGEX REPLACE "[ \n]+" " " err "${err}")
  if(message STREQUAL "" AND NOT result EQUAL 0)
    message(SEND_ERROR "${name}: was refused: ${err}")
  elseif(NOT message STREQUAL "" AND (result EQUAL 0 OR NOT err MATCHES "${message}"))
    message(SEND_ERROR "${name}: '${message}' was not found: ${err}")
  endif()
endfunction()

expect(fine ""
  core/text/word.hpp "" core/text/word.cpp "#include \"core/text/word.hpp\""
  core/text/word_long.cpp "" core/plan/way.hpp "#include \"core/text/word.hpp\""
  core/plan/odd.cpp "// Part of core/plan/way.hpp.")
expect(circle "circle of folders: core/b -> core/c -> core/b"
  core/a/a.hpp "#include \"core/b/b.hpp\"" core/b/b.hpp "#include \"core/c/c.hpp\""
  core/c/c.hpp "#include \"core/b/other.hpp\"" core/b/other.hpp "")
expect(circle_below "circle of folders: core -> core/b -> core"
  core/a.hpp "#include \"core/b/b.hpp\"" core/b/b.hpp "#include \"core/units.hpp\""
  core/units.hpp "")
expect(layer "core/a.hpp: includes daemon/b.hpp: the layers are"
  core/a.hpp "#include \"daemon/b.hpp\"" daemon/b.hpp "")
expect(wall "core/verify/a.hpp: includes core/design/b.hpp: it judges"
  core/verify/a.hpp "#include \"core/design/b.hpp\"" core/design/b.hpp "")
expect(judge "core/plan/a.hpp: includes core/verify/sheet/b.hpp: nothing in core rests on"
  core/plan/a.hpp "#include \"core/verify/sheet/b.hpp\"" core/verify/sheet/b.hpp "")
expect(judge_below "core/plan/a.hpp: includes core/judge/b.hpp: nothing in core rests on"
  core/plan/a.hpp "#include \"core/judge/b.hpp\"" core/judge/b.hpp "")
expect(asks_verifier ""
  core/judge/a.hpp "#include \"core/verify/sheet/b.hpp\"" core/verify/sheet/b.hpp "")
expect(judges ""
  core/verify/motion/a.hpp "#include \"core/verify/sheet/b.hpp\"" core/verify/sheet/b.hpp "")
expect(library "daemon/http/a.hpp: includes <sqlite3.h>: only daemon/store may"
  daemon/http/a.hpp "#include <sqlite3.h>")
expect(threads "core/a.hpp: includes <thread>: core has no" core/a.hpp "#include <thread>")
expect(lost "core/odd.cpp: no header of its name" core/odd.cpp "" core/even.hpp "")
expect(unbuilt "tests/unit/device/odd_test.cpp: no program is built from it"
  tests/unit/device/odd_test.cpp "//" tests/unit/CMakeLists.txt "device/very_odd_test.cpp")
expect(built "" tests/unit/device/odd_test.cpp "//" tests/unit/CMakeLists.txt "device/odd_test.cpp )")
expect(part_of_nothing "core/odd.cpp: no header of its name" core/odd.cpp "// Part of core/gone.hpp.")
expect(twice "core/b.hpp: Point is also defined in"
  core/a.hpp "namespace popcut {\nstruct Point {}\n" core/b.hpp "namespace popcut {\nstruct Point {}\n")
expect(dead "core/a.cpp: refers to values that are gone" core/a.hpp ""
  core/a.cpp "#include \"core/a.hpp\"\nconst auto ends =\n    std::minmax(dot(p, along), dot(q, along))")
expect(alive "" core/a.hpp ""
  core/a.cpp "#include \"core/a.hpp\"\nauto a = std::minmax({dot(p), dot(q)}), b = std::minmax(p.x, q.x)")
foreach(line "std::pair<long, int> at" "unsigned long n" "const long x = 3" "auto n = std::lround(mm)"
    "std::strtol(text, nullptr, 10)" "std::stoul(text)" "std::clamp(n, 0L, most)" "static_cast<long>(n)")
  expect(narrow "core/a.hpp: long has 32 bits" core/a.hpp "${line}")
endforeach()
expect(wide "" core/a.hpp "long long n = 1LL, m = 2ULL // a long way" core/b.hpp
  "long double x = 0x1F, belonging = std::llround(mm), length = strtold(text)" core/c.hpp
  "fail(\"as long as it is\", 0.5)")
# Opening to write: never through a link, and a new file is new.
set(header daemon/devices/a.hpp "//")
foreach(line
    "std::ofstream(path, std::ios::binary) << text" "std::ofstream out(path)" "std::fstream both(path)"
    "std::FILE* f = std::fopen(path.c_str(), \"we\")" "std::fopen(path.c_str(), \"ab\")"
    "int f = ::creat(path, 0600)" "fs::copy_file(from, to, error)")
  expect(writes "daemon/devices/a.cpp: writes through links" ${header} daemon/devices/a.cpp "${line}")
endforeach()
expect(follows "daemon/devices/a.cpp: opens through links" ${header}
  daemon/devices/a.cpp "int f = ::open((folder + name).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600)")
expect(follows_at "device/session/a.cpp: opens through links" device/session/a.hpp "//"
  device/session/a.cpp "int f = ::openat(folder, name, O_WRONLY | O_CREAT | O_EXCL, 0600)")
expect(takes_over "daemon/devices/a.cpp: makes a file that may be there" ${header}
  daemon/devices/a.cpp "int f = ::openat(folder, name, O_WRONLY | O_CREAT | O_NOFOLLOW, 0600)")
expect(new_file "" ${header} daemon/devices/a.cpp
  "int f = ::openat(folder, name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, 0600), std::ifstream in(path), std::fopen(path, \"re\")")
set(crowd "")
foreach(n RANGE 1 40)
  list(APPEND crowd device/port/a${n}.hpp "// ${n}")
endforeach()
expect(crowd "device/port: 40 sources and headers" ${crowd})
