# Which folder may know which, and where a file lies. -DROOT=folder with core, protocol, ... in it.
cmake_minimum_required(VERSION 3.20)

# The one table: a folder and all below it : what it does not include : why.
# A folder may always include itself and what lies below it; what a row forbids to a whole layer is
# not forbidden to itself. FOLDER except OTHER: the row does not hold for OTHER.
set(walls
  "core : (protocol|device|daemon)/ : the layers are core, protocol, device, daemon"
  "protocol : (device|daemon)/ : the layers are core, protocol, device, daemon"
  "device : daemon/ : the layers are core, protocol, device, daemon"
  "core/text : core/[a-z]+/ : it serves all of core"
  "core/geometry : core/[a-z]+/ : it serves all of core"
  "core/model : core/(artwork|calibrate|compare|curvature|deploy|design|drawing|figures|fit|formats|judge|layout|machines|pattern|picture|plan|plot|print|rigid|search|verify)/ : a model is read from its file alone"
  "core/rigid : core/(artwork|calibrate|compare|curvature|deploy|design|drawing|figures|fit|formats|judge|layout|machines|model|pattern|picture|plan|plot|print|search|text|verify)/ : rigid bodies are plain numbers"
  "core/pattern : core/(curvature|deploy|design|drawing|figures|formats|layout|machines|plan|verify)/ : a pattern is a value"
  "core/drawing : core/(curvature|deploy|design|figures|formats|layout|machines|plan|verify)/ : lines come before what is done with them"
  "core/machines : core/(curvature|deploy|design|figures|formats|layout|plan|verify)/ : a machine is a row of a table"
  "core/calibrate : core/(curvature|deploy|design|figures|formats|layout|pattern|plan|verify)/ : it measures a machine"
  "core/curvature : core/(deploy|design|drawing|figures|layout|machines|plan|verify)/ : it computes for design"
  "core/design : core/(deploy|figures|formats/(csv|fold|lattice|write)|layout|machines|plan|verify)/ : a design knows no machine and no file but its target, which may be a drawing"
  "core/plot : core/(curvature|deploy|design|drawing|figures|formats|layout|machines|pattern|plan|verify)/ : it draws plain numbers"
  "core/hands : core/(artwork|calibrate|compare|curvature|deploy|design|drawing|figures|fit|formats|judge|layout|machines|model|picture|plan|plot|print|rigid|search|verify)/ : paper and hands know a pattern alone"
  "core/fit : core/(curvature|deploy|design|drawing|figures|formats|layout|machines|pattern|plan|plot|text|verify)/ : it compares plain triangles"
  "core/compare : core/(artwork|calibrate|curvature|deploy|design|drawing|figures|fit|formats|layout|machines|pattern|picture|plan|plot|print|text|verify)/ : it compares plain triangles, and shares nothing with what makes them"
  "core/search : core/(curvature|deploy|drawing|figures|formats|layout|machines|plan|plot|print|verify)/ : it chooses by plain numbers"
  "core/formats : core/(deploy|figures|layout|plan)/ : files are read and written, not planned"
  "core/layout : core/(curvature|deploy|design|figures|formats|plan|verify)/ : a sheet is laid out from lines"
  "core/plan : core/(curvature|deploy|design|figures|formats|pattern|verify)/ : a plan is made from lines"
  "core/artwork : core/(curvature|deploy|figures|formats/(csv|dxf|fold|lattice|pens|svg|write)|machines|print|verify)/ : pictures are laid on a plan or a pattern"
  "core/print : core/(curvature|deploy|design|figures|formats|verify)/ : pages are made from a plan or a pattern"
  "core/verify : core/(artwork|curvature|deploy|design/(chain|facets|lattice|outline|spline|strips|target|[a-z_]+[.]hpp)|drawing|figures|formats|judge|layout|machines|pattern|plan|rigid)/? : it judges with geometry of its own, of patterns and of targets; it shares the parsers of specs (core/design/spec) and models (core/model), core/geometry and core/text with what makes patterns"
  "core/judge : core/(artwork|calibrate|curvature|drawing|figures|layout|machines|picture|plan|plot|print|search)/ : it gives patterns to the verifier, and opens them with its solver"
  "core except core/judge : core/verify/ : nothing in core rests on what judges it"
  "core : core/judge/ : nothing in core rests on what judges it"
  "core : core/figures/ : the paper's figures serve its readers only"
  "protocol : core/(curvature|deploy|design|figures|formats|pattern|verify)/ : bytes come from a plan"
  "device : core/(curvature|deploy|design|figures|formats|pattern|verify)/ : a cutter gets a plan"
  "device/port : (core/[a-z]+|protocol|device/[a-z]+)/ : a port carries bytes"
  "device/sim : device/(compare|session|usb)/ : the simulated cutter is a machine"
  "device/usb : (protocol|device/(compare|session|sim))/ : a port carries bytes"
  "device/session : device/(compare|usb)/ : a session speaks to a port"
  "daemon/model : (core/[a-z]+|protocol|device|daemon/[a-z]+)/ : the model is plain values"
  "daemon/jobs : (core/[a-z]+|protocol|device|daemon/(cli|client|config|devices|http|planning|popcutd|service|store))/ : the rules of jobs need values only"
  "daemon/store : (protocol|device|daemon/(cli|client|config|devices|http|planning|popcutd|service))/ : it stores what it is given"
  "daemon/fleet : (protocol|device|daemon/(cli|client|config|devices|http|planning|popcutd|service))/ : it stores what it is given"
  "daemon/planning : (device|daemon/(cli|client|config|devices|http|popcutd|service|store))/ : a worker has the plan's inputs only"
  "daemon/planning/engine : <(filesystem|fstream|iostream|thread|unistd[.]h|sys/.*)> : a browser does a task, too"
  "daemon/site : (device|daemon/(cli|client|config|devices|fleet|http|jobs|popcutd|previews|service|store))/ : there is no popcutd in a browser"
  "daemon/devices : daemon/(cli|client|http|planning|popcutd|service|store)/ : a cutter knows no jobs"
  "daemon/service : daemon/(cli|client|config|http|popcutd)/ : HTTP asks the service"
  "daemon/http : (device|daemon/(cli|client|config|devices|planning|popcutd|store))/ : it speaks to the service's interface"
  "daemon/client : (protocol|device|daemon/[a-z]+)/ : it knows popcutd by HTTP only"
  "daemon/cli : daemon/(http|jobs|popcutd|service)/ : it knows popcutd by the client and its configuration"
  "core : <(thread|mutex|fstream|iostream|filesystem|spdlog/.*)> : core has no files, threads and logs"
  "protocol : <(thread|mutex|fstream|iostream|filesystem|spdlog/.*)> : bytes in, values out")
# Libraries that one place uses: their header : the folders that may include it.
set(libraries
  "sqlite3[.]h : daemon/store"
  "pqxx/.* : daemon/fleet"
  "libusb.* : device/usb"
  "boost/asio.* : daemon|device/port"
  "boost/beast.* : daemon/(client|http)"
  "spdlog/.* : daemon/(http|popcutd)"
  "CLI/.* : daemon/cli/(help|parsing)"
  "tiny_gltf[.]h : core/(deploy|model)|daemon/site"
  "dlfcn[.]h : daemon/files"
  "librsvg/.* : daemon/pictures"
  "cairo.* : daemon/pictures"
  "fontconfig/.* : daemon/pictures"
  "png[.]h : daemon/pictures"
  "(ft2build|hb)[.]h : core/design/outline"
  "clipper[.]hpp : core/design/(outline|slices)"
  "jpeglib[.]h : daemon/pictures"
  "zlib[.]h : core/text|daemon/(http|site)"
  "toml.* : daemon/config")
set(most_files 34)  # sources and headers of a folder

set(wrong "")
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/core/*.[ch]pp ${ROOT}/protocol/*.[ch]pp
     ${ROOT}/device/*.[ch]pp ${ROOT}/daemon/*.[ch]pp)
set(folders "")
foreach(file ${files})
  get_filename_component(folder ${file} DIRECTORY)
  list(APPEND folders ${folder})
  list(APPEND "files_of_${folder}" ${file})
  file(STRINGS ${ROOT}/${file} lines REGEX "^ *#include [<\"]")
  foreach(line ${lines})
    string(REGEX REPLACE "^ *#include ([<\"][^>\"]+[>\"]).*" "\\1" header "${line}")
    string(REGEX REPLACE "^\"(.*)\"$" "\\1" header "${header}")
    list(APPEND "includes_of_${folder}" "${header}")
    set("by_${folder}_${header}" ${file})  # one that does
  endforeach()
endforeach()
list(REMOVE_DUPLICATES folders)

# 1. Walls.
foreach(folder ${folders})
  list(REMOVE_DUPLICATES "includes_of_${folder}")
  foreach(wall ${walls})
    string(REGEX MATCH "^(.*) : (.*) : (.*)$" matched "${wall}")
    set(who "${CMAKE_MATCH_1}")
    set(what "${CMAKE_MATCH_2}")
    set(why "${CMAKE_MATCH_3}")
    set(but "nobody")
    if(who MATCHES "^(.*) except (.*)$")
      set(who "${CMAKE_MATCH_1}")
      set(but "${CMAKE_MATCH_2}")
    endif()
    if(NOT "${folder}/" MATCHES "^${who}/" OR "${folder}/" MATCHES "^${but}/")
      continue()
    endif()
    set(layer OFF)
    if(who MATCHES "^[a-z]+$")
      set(layer ON)
      if("${folder}/" MATCHES "^${what}")
        continue()  # what a row forbids to a layer may include itself
      endif()
    endif()
    foreach(header ${includes_of_${folder}})
      string(REGEX REPLACE "/[^/]*$" "/" its_folder "${header}")
      if("${header}" MATCHES "^${what}" AND NOT its_folder MATCHES "^${folder}/" AND
         (layer OR NOT its_folder MATCHES "^${who}/"))
        string(APPEND wrong "${by_${folder}_${header}}: includes ${header}: ${why}\n")
      endif()
    endforeach()
  endforeach()
  foreach(library ${libraries})
    string(REGEX MATCH "^(.*) : (.*)$" matched "${library}")
    set(what "${CMAKE_MATCH_1}")
    set(who "${CMAKE_MATCH_2}")
    foreach(header ${includes_of_${folder}})
      if("${header}" MATCHES "^<${what}>$" AND NOT "${folder}/" MATCHES "^(${who})/")
        string(APPEND wrong "${by_${folder}_${header}}: includes ${header}: only ${who} may\n")
      endif()
    endforeach()
  endforeach()
endforeach()

# 2. Circles: folders that include no other one that is left are taken away, again and again; what
# stays is a circle or leads to one.
foreach(folder ${folders})
  set("next_of_${folder}" "")
  foreach(header ${includes_of_${folder}})
    get_filename_component(other "${header}" DIRECTORY)
    if(NOT other STREQUAL folder AND other IN_LIST folders)
      list(APPEND "next_of_${folder}" ${other})
      set("by_${folder}_${other}" "${by_${folder}_${header}}: includes ${header}")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES "next_of_${folder}")
endforeach()
set(left ${folders})
set(before "")
while(NOT "${left}" STREQUAL "${before}")
  set(before "${left}")
  foreach(folder ${before})
    set(goes_on OFF)
    foreach(other ${next_of_${folder}})
      if(other IN_LIST left)
        set(goes_on ON)
      endif()
    endforeach()
    if(NOT goes_on)
      list(REMOVE_ITEM left ${folder})
    endif()
  endforeach()
endwhile()
if(left)  # walk on until a folder comes again
  list(GET left 0 folder)
  set(walk "")
  while(NOT folder IN_LIST walk)
    list(APPEND walk ${folder})
    foreach(other ${next_of_${folder}})
      if(other IN_LIST left)
        set(folder ${other})
        break()
      endif()
    endforeach()
  endwhile()
  list(FIND walk ${folder} begin)
  list(SUBLIST walk ${begin} -1 circle)
  list(APPEND circle ${folder})
  list(JOIN circle " -> " shown)
  string(APPEND wrong "circle of folders: ${shown}\n")
  list(POP_FRONT circle from)
  foreach(to ${circle})
    string(APPEND wrong "  ${by_${from}_${to}}\n")
    set(from ${to})
  endforeach()
endif()

# 3. The header of a source can be guessed: it has its name, or the source is a part of the header
# whose name it begins with (cut_desk_arm.cpp, cut_desk.hpp), or it says '// Part of path.hpp.'
# Commands are declared in command.hpp.
foreach(file ${files})
  if(NOT file MATCHES "[.]cpp$" OR file MATCHES "/main[.]cpp$|/commands/cmd_[a-z_]+[.]cpp$")
    continue()
  endif()
  string(REGEX REPLACE "[.]cpp$" "" stem ${file})
  set(found OFF)
  set(name ${stem})
  while(NOT found)
    set(header ${name}.hpp)
    if(header IN_LIST files)
      set(found ON)
    endif()
    string(REGEX REPLACE "_[^_/]*$" "" shorter ${name})
    if(shorter STREQUAL name)
      break()
    endif()
    set(name ${shorter})
  endwhile()
  if(NOT found)
    file(STRINGS ${ROOT}/${file} lines LIMIT_COUNT 6 REGEX "// Part of [a-z_/]+[.]hpp")
    if("${lines}" MATCHES "// Part of ([a-z_/]+[.]hpp)")
      set(part_of ${CMAKE_MATCH_1})
      if(part_of IN_LIST files)
        set(found ON)
      endif()
    endif()
  endif()
  if(NOT found)
    string(APPEND wrong "${file}: no header of its name; name it after its header (HEADER_part.cpp) or write '// Part of path.hpp.' in its first lines\n")
  endif()
endforeach()

# A file of tests that no program is built from passes always.
file(GLOB_RECURSE built RELATIVE ${ROOT} ${ROOT}/tests/CMakeLists.txt ${ROOT}/tests/*/CMakeLists.txt)
set(named " ")
foreach(file ${built})
  file(READ ${ROOT}/${file} text)
  string(APPEND named " ${text} ")
endforeach()
file(GLOB_RECURSE test_sources RELATIVE ${ROOT} ${ROOT}/tests/*_test.cpp)
foreach(file ${test_sources})
  get_filename_component(name ${file} NAME_WE)
  if(NOT named MATCHES "[ (/\n]${name}([.]cpp)?[ )\n]")
    string(APPEND wrong "${file}: no program is built from it; name it in a CMakeLists.txt of tests\n")
  endif()
endforeach()

# 4. Crowded folders, those of the tests too; tests/support is a stock that nobody looks through.
file(GLOB_RECURSE test_files RELATIVE ${ROOT} ${ROOT}/tests/*.[ch]pp)
list(FILTER test_files EXCLUDE REGEX "^tests/support/")
foreach(file ${test_files})
  get_filename_component(folder ${file} DIRECTORY)
  list(APPEND test_folders ${folder})
  list(APPEND "files_of_${folder}" ${file})
endforeach()
list(REMOVE_DUPLICATES test_folders)
set(counts "")
foreach(folder ${folders} ${test_folders})
  list(LENGTH "files_of_${folder}" count)
  if(folder IN_LIST folders)
    list(APPEND counts ${count})
  endif()
  if(count GREATER most_files)
    string(APPEND wrong "${folder}: ${count} sources and headers; ${most_files} are as many as one looks through\n")
  endif()
endforeach()
list(SORT counts COMPARE NATURAL)
list(LENGTH counts count)
math(EXPR middle "${count} / 2")
list(GET counts ${middle} median)
list(GET counts -1 largest)
message(STATUS "${count} folders; files in a folder: median ${median}, largest ${largest}")

# One name, one type: two headers that define it in the same namespace are a fault that no compiler
# tells, since each unit sees only one of them.
foreach(layer core protocol device daemon)
  file(GLOB_RECURSE headers ${ROOT}/${layer}/*.hpp)
  foreach(file ${headers})
    file(STRINGS ${file} lines REGEX "^(namespace [a-z_:]+ {|(struct|class|enum class) [A-Za-z0-9_]+( : [^;]*)?( final)? {|using [A-Za-z0-9_]+ = )")
    set(space "")
    foreach(line ${lines})
      if(line MATCHES "^namespace ([a-z_:]+)")
        set(space ${CMAKE_MATCH_1})
      elseif(line MATCHES "^(struct|class|enum class|using) ([A-Za-z0-9_]+)")
        string(REPLACE ":" "_" key "type_${space}_${CMAKE_MATCH_2}")
        if(DEFINED ${key})
          string(APPEND wrong "${file}: ${CMAKE_MATCH_2} is also defined in ${${key}}\n")
        endif()
        set(${key} ${file})
      endif()
    endforeach()
  endforeach()
endforeach()
# std::minmax gives references: of what a call returns, they are dead in the next line. Braces keep values.
foreach(layer core protocol device daemon tests)
  file(GLOB_RECURSE sources ${ROOT}/${layer}/*.[ch]pp)
  foreach(file ${sources})
    file(READ ${file} text)
    if(text MATCHES "auto[^=;(]*=[ \n]*std::minmax\\([^{;)]*[a-z0-9_]\\([^;]*")
      string(APPEND wrong "${file}: refers to values that are gone; write std::minmax({...}): ${CMAKE_MATCH_0}\n")
    endif()
  endforeach()
endforeach()
# `long` has 32 bits on 32-bit Linux, where 214.8 mm in steps of 1e-7 mm overflow it in silence: write
# std::int64_t, and std::llround in place of std::lround. `long long` and `long double` are wide
# everywhere.
foreach(layer core protocol device)
  file(GLOB_RECURSE sources ${ROOT}/${layer}/*.[ch]pp)
  foreach(file ${sources})
    file(STRINGS ${file} lines REGEX "long|lround|lrint|strtou?l|stou?l|labs|[0-9][uU]?[lL]")
    foreach(line ${lines})
      string(REGEX REPLACE "\"([^\"\\\\]|\\\\.)*\"|//.*$" "" code "${line}")
      string(REGEX REPLACE "long +(long|double)" "" code "${code}")
      if(code MATCHES "(^|[^A-Za-z0-9_\"])(long|lround|lrint|strtou?l|stou?l|labs)([ >(),*&}]|$)" OR
         code MATCHES "(^|[^A-Za-z0-9_.])[0-9][0-9']*[uU]?[lL]([^A-Za-z0-9_]|$)")
        string(APPEND wrong "${file}: long has 32 bits on some machines: ${line}\n")
      endif()
    endforeach()
  endforeach()
endforeach()
# Beast takes long to compile, and a body without a limit takes all memory.
file(GLOB_RECURSE files ${ROOT}/daemon/*.hpp ${ROOT}/daemon/*.cpp)
set(with_beast "")
foreach(file ${files})
  file(STRINGS ${file} lines REGEX "boost/beast|body_limit *\\( *boost::none")
  foreach(line ${lines})
    if(line MATCHES "boost::none")
      string(APPEND wrong "${file}: a body needs a limit\n")
    elseif(file MATCHES "\\.hpp$")
      string(APPEND wrong "${file}: Beast stays out of headers\n")
    else()
      list(APPEND with_beast ${file})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES with_beast)
list(LENGTH with_beast count)
if(count GREATER 2)
  string(APPEND wrong "Beast is in more than two sources: ${with_beast}\n")
endif()
# What others learned late (docs/faults.md). Names and texts of users never become a part of SQL, no
# program but popcutd's own worker is started, secrets are not compared by ==, and files in the state
# folder are never opened through a link.
foreach(file ${files})
  file(READ ${file} text)
  # SQL put together: only from constants and names of columns, in these files.
  if(NOT file MATCHES "/(store/((store_)?salvage|store|database|schema)|fleet/fleet_import)[.]cpp$")
    string(REGEX MATCHALL "fmt::format\\([ \n]*\"(SELECT|INSERT|UPDATE|DELETE)[^\"]*\"[^;]*;" built "${text}")
    foreach(one ${built})
      if(NOT one MATCHES "kColumns|column_names<|\n? *column\\)")
        string(APPEND wrong "${file}: SQL is put together, bind its values: ${one}\n")
      endif()
    endforeach()
    if(text MATCHES "\"(SELECT|INSERT|UPDATE|DELETE) [^\"]*\"[ \n]*[+]|[+][ \n]*\" *(WHERE|AND|ORDER|LIMIT|VALUES)")
      string(APPEND wrong "${file}: SQL is put together, bind its values: ${CMAKE_MATCH_0}\n")
    endif()
  endif()
  if(text MATCHES "[^a-z_](system|popen|execl[ep]?|execv[ep]?|execve|execvpe|posix_spawnp?|fexecve)\\(" AND
     NOT file MATCHES "/daemon/cli/|/planning/worker_process[.]cpp$")
    string(APPEND wrong "${file}: starts a program; popcutd starts its worker only\n")
  endif()
  if(NOT file MATCHES "/daemon/(cli|client)/" AND
     text MATCHES "(secret|token|signature)[a-z_0-9.]* *[!=]= |[!=]= *[a-z_.>-]*(secret|signature)")
    string(APPEND wrong "${file}: a secret is compared by ${CMAKE_MATCH_0}; that takes a time that tells of it\n")
  endif()
endforeach()
# What popcutd writes it opens below a folder that it holds, never through a link: no stream and no
# stdio that writes, no open to write without O_NOFOLLOW, no new file without O_EXCL. The tools of
# popcut and of the cable write where a person tells them to.
file(GLOB_RECURSE device_files ${ROOT}/device/*.[ch]pp)
foreach(file ${files} ${device_files})
  if(file MATCHES "/daemon/(cli|client|popcut)/|/daemon/files/output_folder[.]cpp$|/device/(port|usb)/|/device/sim/sim_pty[.]cpp$")
    continue()
  endif()
  file(READ ${file} text)
  string(REPLACE "\"/proc/self/oom_score_adj\", O_WRONLY | O_CLOEXEC" "" text "${text}")
  if(text MATCHES "std::(basic_)?o?fstream[^;]*" AND NOT CMAKE_MATCH_0 MATCHES "ifstream")
    string(APPEND wrong "${file}: writes through links: ${CMAKE_MATCH_0}\n")
  endif()
  if(text MATCHES "[^a-z_](fopen|freopen)\\([^;]*, *\"[wa][^;]*|[^a-z_](creat|copy_file|mkstemp|truncate)\\([^;]*")
    string(APPEND wrong "${file}: writes through links: ${CMAKE_MATCH_0}\n")
  endif()
  string(REGEX MATCHALL "[^a-z_]open(at|at2)?\\([^;]*O_[^;]*" opened "${text}")
  foreach(one ${opened})
    if(NOT one MATCHES "O_NOFOLLOW")
      string(APPEND wrong "${file}: opens through links: ${one}\n")
    elseif(one MATCHES "O_CREAT" AND NOT one MATCHES "O_EXCL" AND
           NOT file MATCHES "/files/held_folder[.]cpp$|/store/(state_folder|store)[.]cpp$")
      string(APPEND wrong "${file}: makes a file that may be there already: ${one}\n")
    endif()
  endforeach()
endforeach()
if(wrong)
  message(FATAL_ERROR "${wrong}")
endif()
