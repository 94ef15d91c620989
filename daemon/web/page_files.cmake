# Writes BINARY/page_files.cpp, the files of the page as arrays of bytes.
# -DROOT=sources -DBINARY=folder -DMODE=auto|dist|off -DNPM=program or nothing
cmake_minimum_required(VERSION 3.25)
set(web ${ROOT}/daemon/web)

# What the page is made from: all that lies in daemon/web but what is made there, and the pictures of
# the gallery that it bundles. Names are relative to ROOT and sorted.
function(list_sources out)
  set(skipped dist node_modules plain CMakeLists.txt page_files.cmake)
  file(GLOB entries LIST_DIRECTORIES true RELATIVE ${web} ${web}/*)
  set(names "")
  foreach(entry ${entries})
    if(entry IN_LIST skipped)
      continue()
    endif()
    if(IS_DIRECTORY ${web}/${entry})
      file(GLOB_RECURSE below RELATIVE ${ROOT} ${web}/${entry}/*)
      list(APPEND names ${below})
    else()
      list(APPEND names daemon/web/${entry})
    endif()
  endforeach()
  file(GLOB pictures RELATIVE ${ROOT} ${ROOT}/docs/gallery/*-deployed.svg)
  list(APPEND names ${pictures})
  list(REMOVE_ITEM names daemon/web/src/api.d.ts)
  list(SORT names)
  set(${out} ${names} PARENT_SCOPE)
endfunction()

# The stamp of the sources: SHA-256 of "HASH  NAME\n" of each, as build.mjs computes it too.
function(make_stamp out)
  set(lines "")
  foreach(name ${ARGN})
    file(SHA256 ${ROOT}/${name} hash)
    string(APPEND lines "${hash}  ${name}\n")
  endforeach()
  string(SHA256 stamp "${lines}")
  set(${out} ${stamp} PARENT_SCOPE)
endfunction()

# Whether `dist` was made from sources of this stamp.
function(is_current out dist stamp)
  set(${out} OFF PARENT_SCOPE)
  if(EXISTS ${dist}/stamp AND EXISTS ${dist}/index.html)
    file(READ ${dist}/stamp made)
    string(STRIP "${made}" made)
    if(made STREQUAL stamp)
      set(${out} ON PARENT_SCOPE)
    endif()
  endif()
endfunction()

# Builds the page in a copy of the sources, since a build leaves those as they are. What npm cannot
# fetch is no reason to stop: there may be no network. What does not build is one.
function(build_page mirror stamp out)
  set(${out} OFF PARENT_SCOPE)
  set(copy ${mirror}/daemon/web)
  file(SHA256 ${web}/package-lock.json lock)
  if(EXISTS ${BINARY}/npm-failed)
    file(READ ${BINARY}/npm-failed failed)
    if(failed STREQUAL lock)
      return()
    endif()
  endif()
  file(GLOB old LIST_DIRECTORIES true RELATIVE ${copy} ${copy}/*)
  list(REMOVE_ITEM old node_modules)
  list(TRANSFORM old PREPEND ${copy}/)
  file(REMOVE_RECURSE ${mirror}/docs ${old})
  foreach(name ${ARGN})
    cmake_path(GET name PARENT_PATH folder)
    file(COPY ${ROOT}/${name} DESTINATION ${mirror}/${folder})
  endforeach()
  set(installed "")
  if(EXISTS ${copy}/node_modules/.popcut-lock)
    file(READ ${copy}/node_modules/.popcut-lock installed)
  endif()
  if(NOT installed STREQUAL lock)
    message(STATUS "page: npm fetches what it is built with")
    execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
      WORKING_DIRECTORY ${copy} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said
      TIMEOUT 600)
    if(NOT result EQUAL 0)
      message(WARNING "page: npm cannot fetch what it is built with (${result}); popcutd gets a plain "
                      "page, until you configure again.\n${said}")
      file(WRITE ${BINARY}/npm-failed ${lock})
      return()
    endif()
    file(WRITE ${copy}/node_modules/.popcut-lock ${lock})
  endif()
  execute_process(COMMAND ${NPM} run --silent build WORKING_DIRECTORY ${copy} RESULT_VARIABLE result
    OUTPUT_VARIABLE said ERROR_VARIABLE said TIMEOUT 600)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "page: 'npm run build' fails (${result}):\n${said}")
  endif()
  is_current(made ${copy}/dist ${stamp})
  if(NOT made)
    message(FATAL_ERROR "page: daemon/web/build.mjs left no dist/index.html, or another stamp than ${stamp}; "
                        "page_files.cmake and build.mjs must count the same sources")
  endif()
  set(${out} ON PARENT_SCOPE)
endfunction()

# The media type of a file by the ending of its name.
function(media_type out name)
  set(types html "text/html; charset=utf-8" js "text/javascript; charset=utf-8"
      css "text/css; charset=utf-8" svg "image/svg+xml" png "image/png"
      json "application/json" map "application/json" txt "text/plain; charset=utf-8"
      woff2 "font/woff2" ico "image/x-icon" webmanifest "application/manifest+json"
      wasm "application/wasm")
  string(REGEX MATCH "[^.]*$" ending ${name})
  list(FIND types "${ending}" at)
  if(at EQUAL -1 OR NOT name MATCHES "^[A-Za-z0-9_-][A-Za-z0-9._-]*$")
    message(FATAL_ERROR "page: ${name} cannot be served; a name has letters, digits, '.', '_', '-' and "
                        "one of the endings that page_files.cmake lists")
  endif()
  # A type with a parameter is two items of the list.
  string(REPLACE "; charset" "|charset" types "${types}")
  list(FIND types "${ending}" at)
  math(EXPR at "${at} + 1")
  list(GET types ${at} type)
  string(REPLACE "|" "; " type "${type}")
  set(${out} "${type}" PARENT_SCOPE)
endfunction()

# Appends one file of `dist` to the arrays and the table.
macro(add_file dist path name)
  media_type(type ${path})
  file(SHA256 ${dist}/${path_folder}${path} hash)
  string(SUBSTRING ${hash} 0 16 hash)
  set(bytes_of ${dist}/${path_folder}${path})
  set(is_gzip false)
  if(EXISTS ${bytes_of}.gz)
    set(bytes_of ${bytes_of}.gz)
    set(is_gzip true)
  endif()
  file(READ ${bytes_of} hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," hex "${hex}")
  string(APPEND arrays "const unsigned char kBytes${count}[] = {${hex}0};\n")
  string(APPEND table "    {\"${name}\", \"${type}\", \"${hash}\", text_of(kBytes${count}), ${is_gzip}},\n")
  math(EXPR count "${count} + 1")
endmacro()

function(write_source dist stamp)
  set(arrays "")
  set(table "")
  set(count 0)
  set(path_folder "")
  add_file(${dist} index.html "")
  file(GLOB names RELATIVE ${dist}/page ${dist}/page/*)
  list(SORT names)
  set(path_folder "page/")
  foreach(name ${names})
    if(name MATCHES "[.]gz$")
      continue()
    endif()
    add_file(${dist} ${name} ${name})
  endforeach()
  set(text "// Made by CMake from the files of the page.
#include \"daemon/http/api/page_files.hpp\"

namespace popcut::daemon::http {
namespace {

${arrays}
// Each array ends with a zero that is no part of its file.
template <std::size_t size>
std::string_view text_of(const unsigned char (&bytes)[size]) {
  return {reinterpret_cast<const char*>(bytes), size - 1};
}

}  // namespace

std::span<const PageFile> page_files() {
  static const PageFile kFiles[] = {
${table}  };
  return kFiles;
}

std::string_view page_stamp() { return \"${stamp}\"; }

}  // namespace popcut::daemon::http
")
  set(old "")
  if(EXISTS ${BINARY}/page_files.cpp)
    file(READ ${BINARY}/page_files.cpp old)
  endif()
  if(NOT old STREQUAL text)
    file(WRITE ${BINARY}/page_files.cpp "${text}")
  endif()
endfunction()

if(MODE STREQUAL "off")
  write_source(${web}/plain "")
  return()
endif()
list_sources(names)
make_stamp(stamp ${names})
is_current(made ${web}/dist ${stamp})
if(made)
  write_source(${web}/dist ${stamp})
  return()
endif()
if(MODE STREQUAL "dist")
  message(FATAL_ERROR "page: daemon/web/dist was not made from these sources (their stamp is ${stamp}); run "
                      "'npm ci && npm run build' in daemon/web, or configure with -DPOPCUT_PAGE=auto")
endif()
set(mirror ${BINARY}/page)
is_current(made ${mirror}/daemon/web/dist ${stamp})
if(NOT made AND NPM AND EXISTS ${web}/package-lock.json)
  build_page(${mirror} ${stamp} made ${names})
endif()
if(made)
  write_source(${mirror}/daemon/web/dist ${stamp})
else()
  message(STATUS "page: a plain one, since there is no daemon/web/dist of these sources and no npm that builds it")
  write_source(${web}/plain "")
endif()
