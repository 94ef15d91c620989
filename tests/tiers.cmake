# How each entry of CTest runs: in which pool, in './run test' or only with '--whole', and whether with sanitizers. An
# entry is a source file of tests, named by its path below tests/, or a script; patterns match the beginnings of these
# names.

# Pools run side by side (pools.json). An entry that computes takes a core for itself and runs with lower
# priority than those that wait. An entry that waits (for a lease, a device, a process, a page)
# takes little of a core and has deadlines, so two of them run beside those that compute, one of those that start several
# popcutd on a PostgreSQL, whose leases lapse on a busy machine, and one of those that look at the page in a browser.
set(popcut_waiting
  "e2e/popcutd/"
  "e2e/in_process/(confinement|cutters|http_events|http_front_door|http_limits|http_server|planner|previewer|search)"
  "e2e/popcut/(calibrate|cut|cutter|fleet)_command"
  "in a fleet: "
  "the demo of a fleet"
  "page: "
  "property/service_race"
  "the service keeps its contract in a fleet"
  "unit/daemon/(client|webhook)"
  "unit/device/(ports|sim_pty)"
  "unit/fleet/"
  "unit/support/"
  "usb/")

# What './run test' runs, by the label of the entry: all that calls popcut's libraries, and scripts that need no program
# but these. '--whole' and CI also run popcut and popcutd themselves, the page in a browser, the commands of the
# documentation, and the package: two thirds of the time of all.
set(popcut_quick unit property conformance fuzz usb)

# The sanitizer tier: what reads foreign bytes, shares memory between threads, or touches raw memory.
# Sanitizers say nothing new of the rest: it computes with values, or runs what these entries run,
# once more through a program. './run soak sanitizers' runs all entries with sanitizers.
# PATTERN : what is dangerous in it
set(popcut_sanitized
  # Foreign bytes.
  "fuzz: : each parser reads thousands of changed inputs"
  "conformance/(dxf_ezdxf|fold_samples|strokes_corpus) : files of other programs are read"
  "conformance/(device|protocol)_captures : recorded bytes of cutters are read"
  "unit/artwork/colour_mesh : models with textures are read, as glTF, OBJ, PNG and JPEG"
  "unit/daemon/(client|config|http_handlers|http_parts|pages|png|store|webhook) : bytes of clients, servers, files and databases are read"
  "unit/design/(outline|target_readers) : fonts, meshes and tables are read"
  "unit/formats/ : drawings and patterns are read"
  "unit/protocol/ : commands and replies of cutters are read"
  "unit/verify/verify_input : pattern files are read"
  "property/(protocol_fuzz|protocol_round_trip|design/targets) : random bytes and values are read"
  "property/store_damage : damaged databases are read"
  "e2e/in_process/http_ : requests, broken and slow ones, reach the server"
  "e2e/popcutd/popcutd_openapi : thousands of generated requests reach popcutd"
  # Memory that threads share.
  "unit/daemon/(fair_line|job_view|service_access|service_actions|service_jobs|service_queue|service_resume|service_upkeep|service_view) : the service's thread and its callers share jobs"
  "unit/device/ : a cutter, its port and its session are threads"
  "unit/fleet/(connection|postgres_database|two_nodes) : connections end while threads use them"
  "property/(service_race|service_turns|session_journal|device) : threads race"
  "e2e/in_process/(cutters|planner_test|previewer|search|sheet_strokes) : threads of popcutd, and worker processes that die"
  "e2e/popcutd/(crash|disk_full|popcutd|preview|takeover)_test : popcutd's threads, while it dies, its disk fills up, or its clients go"
  "e2e/popcutd/faults_(cutter|network) : popcutd's threads, while cutters and clients go"
  "e2e/popcutd/fleet_failover : popcutd's threads, while its database dies or moves"
  "usb/ : libusb's callbacks come on threads of their own"
  # Raw memory.
  "unit/design/pictures : pixels and depths are addressed by hand"
  "unit/compare/comparison : pixels and depths are addressed by hand"
  "unit/artwork/lit_picture : pixels are addressed by hand"
  "unit/plan/(layout|order) : indices into tours and grids"
  "property/(layout|order|clean|compare) : indices into tours, grids and graphs, for random lines"
  "property/(faults_memory|service_faults) : memory or the disk ends at any call"
  "unit/daemon/http_memory : memory ends at any call")

# What CI runs of it: all but the daemon's own entries, which wait for minutes and take as long again to compile.
set(popcut_sanitized_daemon "^(e2e|usb|unit/daemon|unit/fleet|property/(service|session|store|faults_memory))")

# What needs the PostgreSQL of the run (support/fleet_postgres.cpp); unit/support/ configures and freezes its own.
set(popcut_on_postgres
  "e2e/popcut/fleet_command"
  "in a fleet: "
  "the service keeps its contract in a fleet"
  "unit/fleet/")

# What takes longest is begun first, so that the end of a run does not wait for it.
set(popcut_longest
  "e2e/popcut/(artwork|auto|design|fleet)_command"
  "e2e/popcutd/(faults_daemon|fleet)"
  "property/design/"
  "the service keeps its contract in a fleet")

# popcut_tier(NAME OUT): the pattern of the sanitizer tier that the entry NAME has, or nothing.
function(popcut_tier name out)
  set(${out} "" PARENT_SCOPE)
  foreach(row ${popcut_sanitized})
    string(REGEX REPLACE " : .*" "" pattern "${row}")
    if(name MATCHES "^${pattern}")
      set(${out} "${pattern}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# popcut_name(SOURCE OUT): a source of tests by its path below tests/.
function(popcut_name source out)
  cmake_path(ABSOLUTE_PATH source NORMALIZE OUTPUT_VARIABLE path)
  cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/tests OUTPUT_VARIABLE name)
  set(${out} ${name} PARENT_SCOPE)
endfunction()

# popcut_only_tier(LIST): with POPCUT_ONLY_SANITIZED, a list of sources without the tests that are not in the sanitizer
# tier. A program none of whose tests are in it stays whole: the tier does not build it.
function(popcut_only_tier list)
  set(kept ${${list}})
  set(found FALSE)
  foreach(source ${${list}})
    popcut_name(${source} name)
    popcut_tier("${name}" pattern)
    if(pattern)
      set(found TRUE)
    elseif(name MATCHES "_test\\.cpp$")
      list(REMOVE_ITEM kept ${source})
    endif()
  endforeach()
  if(found AND POPCUT_ONLY_SANITIZED)
    set(${list} ${kept} PARENT_SCOPE)
  endif()
endfunction()

# popcut_entry(NAME LABELS command ...): an entry, with the labels LABELS, 'cpu' or 'wait', and
# 'quick', 'sanitize' and 'sanitize_core' if it is in these tiers.
find_program(POPCUT_NICE nice)
mark_as_advanced(POPCUT_NICE)
function(popcut_entry name labels)
  set(pool cpu)
  foreach(pattern ${popcut_waiting})
    if(name MATCHES "^${pattern}")
      set(pool wait)
    endif()
  endforeach()
  set(slots ${pool})
  if(name MATCHES "^page: ")
    set(slots page)
  elseif(name MATCHES "fleet|^unit/support/")
    set(slots fleet)
  endif()
  string(REGEX MATCHALL "[$]<TARGET_FILE:[^>]+" programs "${ARGN}")
  list(TRANSFORM programs REPLACE "^.*:" "")
  if(labels IN_LIST popcut_quick OR (labels STREQUAL script AND NOT programs AND NOT name MATCHES "^every case"))
    list(APPEND labels quick)
    set_property(GLOBAL APPEND PROPERTY POPCUT_PROGRAMS_OF_quick ${programs})
  endif()
  popcut_tier("${name}" pattern)
  if(pattern)
    list(APPEND labels sanitize)
    set_property(GLOBAL APPEND PROPERTY POPCUT_SANITIZED_PATTERNS "${pattern}")
    set_property(GLOBAL APPEND PROPERTY POPCUT_PROGRAMS_OF_sanitize ${programs})
    if(NOT name MATCHES "${popcut_sanitized_daemon}")
      list(APPEND labels sanitize_core)
      set_property(GLOBAL APPEND PROPERTY POPCUT_PROGRAMS_OF_sanitize_core ${programs})
    endif()
  endif()
  list(APPEND labels ${pool})
  set(cost 10)
  foreach(pattern ${popcut_longest})
    if(name MATCHES "^${pattern}")
      set(cost 100)
    endif()
  endforeach()
  set(launcher "")
  if(POPCUT_TIME)  # for './run weigh'
    list(GET labels 0 label)
    set(launcher ${POPCUT_TIME} -q -a -o ${popcut_weigh}/tests.log -f "%e %U %S ${label} ${name}")
  endif()
  if(pool STREQUAL cpu AND POPCUT_NICE)
    list(APPEND launcher ${POPCUT_NICE} -n 5)
  endif()
  add_test(NAME ${name} COMMAND ${launcher} ${ARGN})
  set_tests_properties(${name} PROPERTIES
    LABELS "${labels}" RESOURCE_GROUPS ${slots}:1 COST ${cost} TIMEOUT 1800)
  if(POPCUT_SANITIZE MATCHES "address")
    set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT
      "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks.supp:print_suppressions=0")
  endif()
  foreach(pattern ${popcut_on_postgres})
    if(name MATCHES "^${pattern}")
      set_tests_properties(${name} PROPERTIES FIXTURES_REQUIRED PostgreSQL)
      set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT POPCUT_TEST_POSTGRES=${popcut_postgres_file})
      if(quick IN_LIST labels)
        set_property(GLOBAL APPEND PROPERTY POPCUT_PROGRAMS_OF_quick fleet_postgres)
      endif()
      if(sanitize IN_LIST labels)
        set_property(GLOBAL APPEND PROPERTY POPCUT_PROGRAMS_OF_sanitize fleet_postgres)
      endif()
    endif()
  endforeach()
endfunction()
