cmake_minimum_required(VERSION 3.25)
# The three ways to the page: what dist/ holds, npm, and the plain page; with a page of its own and
# an npm that is a script. -DROOT=sources -DFOLDER=scratch
find_program(SHELL sh REQUIRED)
set(sources "${FOLDER}/sources")
set(web "${sources}/daemon/web")
set(binary "${FOLDER}/binary")
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${web}/src ${sources}/docs/gallery ${binary})
file(COPY ${ROOT}/daemon/web/plain DESTINATION ${web})
file(WRITE ${web}/CMakeLists.txt "no source of the page\n")
file(WRITE ${web}/.npmrc "ignore-scripts=true\n")
file(WRITE ${web}/package.json "{\"scripts\": {\"build\": \"\"}}\n")
file(WRITE ${web}/package-lock.json "{}\n")
file(WRITE ${web}/index.html "<!doctype html>the real one\n")
file(WRITE ${web}/src/Z.ts "1\n")
file(WRITE ${web}/src/a.ts "2\n")
file(WRITE ${sources}/docs/gallery/sphere-deployed.svg "<svg/>\n")
file(WRITE ${sources}/docs/gallery/sphere-pattern.svg "is not bundled\n")

# An npm that fetches nothing and counts its calls. Its stamp is made by other programs than CMake.
file(WRITE ${FOLDER}/npm [=[#!/bin/sh
set -eu
log=$(dirname "$0")/log
echo "$*" >>"$log"
case $1 in
  ci)
    [ ! -e "$(dirname "$0")/no-network" ] || { echo "no network" >&2; exit 1; }
    mkdir -p node_modules/x && echo '{}' >node_modules/x/package.json ;;
  run)
    [ -d node_modules ] || { echo "nothing is installed" >&2; exit 1; }
    ! grep -q broken src/a.ts || { echo "src/a.ts:1: broken" >&2; exit 1; }
    rm -rf dist && mkdir -p dist/page
    cp index.html dist/index.html
    cat src/*.ts ../../docs/gallery/*-deployed.svg >dist/page/main-1.js
    gzip -9nk dist/index.html dist/page/main-1.js
    echo '{}' >dist/sizes.json
    cd ../..
    find daemon/web docs/gallery -type f ! -path '*/node_modules/*' ! -path '*/dist/*' |
      LC_ALL=C sort | xargs sha256sum | sha256sum | cut -d' ' -f1 >daemon/web/dist/stamp ;;
esac
]=])
file(CHMOD ${FOLDER}/npm PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)

# page(MODE NPM): runs the script; sets result, said, made (its source), calls (of npm, since the last)
function(page mode npm)
  file(REMOVE ${FOLDER}/log)
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${sources} -DBINARY=${binary} -DMODE=${mode}
    -DNPM=${npm} -P ${ROOT}/daemon/web/page_files.cmake
    RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  set(calls "")
  if(EXISTS ${FOLDER}/log)
    file(STRINGS ${FOLDER}/log calls)
  endif()
  set(made "")
  if(EXISTS ${binary}/page_files.cpp)
    file(READ ${binary}/page_files.cpp made)
  endif()
  string(REGEX MATCH "page_stamp\\(\\) { return \"([0-9a-f]*)\"" stamp "${made}")
  set(stamp "${CMAKE_MATCH_1}")
  foreach(name result said calls made stamp)
    set(${name} "${${name}}" PARENT_SCOPE)
  endforeach()
endfunction()
function(expect what)
  if(NOT (${ARGN}))
    message(SEND_ERROR "not so: ${what}\nresult ${result}, stamp '${stamp}', npm '${calls}'\n${said}")
  endif()
endfunction()
set(real [[{"main-1.js", "text/javascript; charset=utf-8", "]])
set(plain [[{"plain.css", "text/css; charset=utf-8", "]])

page(off ${FOLDER}/npm)
expect("off is the plain page" result EQUAL 0 AND NOT stamp AND NOT calls)
string(FIND "${made}" "${plain}" at)
expect("the plain page has its files" at GREATER 0)
page(auto "")
expect("without npm it is the plain page" result EQUAL 0 AND NOT stamp)
expect("and it says so" said MATCHES "a plain one")
page(dist ${FOLDER}/npm)
expect("dist needs a dist" result GREATER 0 AND said MATCHES "npm ci" AND NOT calls)

# npm without a network is no reason to stop, and is not tried again and again.
file(TOUCH ${FOLDER}/no-network)
page(auto ${FOLDER}/npm)
expect("without a network it is the plain page" result EQUAL 0 AND NOT stamp AND said MATCHES "no network")
page(auto ${FOLDER}/npm)
expect("npm is not asked again" result EQUAL 0 AND NOT stamp AND NOT calls)
file(REMOVE ${FOLDER}/no-network ${binary}/npm-failed)

page(auto ${FOLDER}/npm)
set(first "${stamp}")
expect("npm builds it" result EQUAL 0 AND calls MATCHES "^ci .*run ")
string(LENGTH "${stamp}" digits)
expect("it has a stamp" digits EQUAL 64)
string(FIND "${made}" "${real}" at)
expect("its files are in the table" at GREATER 0)
expect("they are packed" made MATCHES "text_of\\(kBytes1\\), true")
expect("and nothing else is" NOT made MATCHES "sizes|stamp\", |[.]gz")
foreach(name dist node_modules)
  expect("the sources stay as they are" NOT EXISTS ${web}/${name})
endforeach()
file(TIMESTAMP ${binary}/page_files.cpp before "%s.%f")
page(auto ${FOLDER}/npm)
file(TIMESTAMP ${binary}/page_files.cpp after "%s.%f")
expect("nothing is built again" NOT calls AND stamp STREQUAL first AND before STREQUAL after)

# Each source counts: also a hidden one, one that is gone, and a picture.
foreach(change "daemon/web/.npmrc" "daemon/web/src/b.ts" "docs/gallery/sphere-deployed.svg")
  set(last "${stamp}")
  file(APPEND ${sources}/${change} "3\n")
  page(auto ${FOLDER}/npm)
  expect("${change} is a source" result EQUAL 0 AND calls MATCHES "^run " AND NOT stamp STREQUAL last)
endforeach()
set(last "${stamp}")
file(REMOVE ${web}/src/b.ts)
page(auto ${FOLDER}/npm)
expect("one less is another page" NOT stamp STREQUAL last AND NOT EXISTS ${binary}/page/daemon/web/src/b.ts)
foreach(name daemon/web/CMakeLists.txt docs/gallery/sphere-pattern.svg daemon/web/src/api.d.ts)
  set(last "${stamp}")
  file(APPEND ${sources}/${name} "3\n")
  page(auto ${FOLDER}/npm)
  expect("${name} is none" stamp STREQUAL last AND NOT calls)
endforeach()
file(WRITE ${web}/package-lock.json "{ }\n")
page(auto ${FOLDER}/npm)
expect("another lock is fetched" calls MATCHES "^ci .*run ")

# A dist that comes with the sources is used as it is, without npm; a stale one is not.
file(COPY ${binary}/page/daemon/web/dist DESTINATION ${web})
file(WRITE ${web}/dist/page/shipped-1.css "a{}\n")
file(REMOVE_RECURSE ${binary})
file(MAKE_DIRECTORY ${binary})
foreach(mode auto dist)
  page(${mode} "")
  expect("${mode} takes the shipped dist" result EQUAL 0 AND stamp)
  expect("all of it" made MATCHES "shipped-1[.]css")
endforeach()
file(APPEND ${web}/src/a.ts "4\n")
page(dist ${FOLDER}/npm)
expect("a stale dist is refused" result GREATER 0 AND said MATCHES "not made from these sources")
page(auto "")
expect("without npm it is the plain page" result EQUAL 0 AND NOT stamp)
page(auto ${FOLDER}/npm)
expect("with npm it is built" result EQUAL 0 AND NOT made MATCHES "shipped" AND stamp)

# What does not build, or counts other sources, or has names that are no names, is told.
file(REMOVE_RECURSE ${web}/dist)
file(APPEND ${web}/src/a.ts "broken\n")
page(auto ${FOLDER}/npm)
expect("a fault in the sources is told" result GREATER 0 AND said MATCHES "src/a.ts:1: broken")
file(WRITE ${web}/src/a.ts "2\n")
page(off "")
file(MAKE_DIRECTORY ${web}/dist/page)
foreach(name "a b.js" "x.exe" "x" ".hidden.js")
  file(REMOVE_RECURSE ${web}/dist)
  file(REMOVE_RECURSE ${binary}/page)
  page(auto ${FOLDER}/npm)
  expect("it builds" result EQUAL 0)
  file(COPY ${binary}/page/daemon/web/dist DESTINATION ${web})
  file(WRITE "${web}/dist/page/${name}" "x\n")
  page(dist "")
  expect("'${name}' is refused" result GREATER 0 AND said MATCHES "cannot be served")
endforeach()
