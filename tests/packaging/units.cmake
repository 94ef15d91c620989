cmake_minimum_required(VERSION 3.25)
# The systemd units: without a warning, and closed to 2.0 or better.
# -DUNITS=folder with popcutd.service and popcutd.socket -DPOPCUTD=program -DFOLDER=scratch
find_program(ANALYZE systemd-analyze)
if(NOT ANALYZE)
  message("skipped: there is no systemd-analyze here")
  return()
endif()
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
# The program that runs is the one just built, else verify misses it.
file(READ ${UNITS}/popcutd.service unit)
string(REGEX REPLACE "=[^\n=]*/popcutd" "=${POPCUTD}" unit "${unit}")
file(WRITE ${FOLDER}/popcutd.service "${unit}")
file(COPY ${SOCKET} DESTINATION ${FOLDER})
execute_process(COMMAND ${ANALYZE} verify --man=no ${FOLDER}/popcutd.service ${FOLDER}/popcutd.socket
  RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(NOT result EQUAL 0 OR NOT out STREQUAL "")
  message(FATAL_ERROR "systemd-analyze verify: ${result}\n${out}")
endif()
execute_process(COMMAND ${ANALYZE} security --no-pager --offline=true --threshold=20
  ${FOLDER}/popcutd.service RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
string(REGEX MATCH "Overall exposure level[^\n]*" level "${out}")
if(NOT result EQUAL 0 OR NOT level)
  message(FATAL_ERROR "systemd-analyze security: ${result}\n${out}")
endif()
message("${level}")
