cmake_minimum_required(VERSION 3.25)
# Completions and manual pages are made from the programs, and the shells can read them.
# -DPOPCUT=program -DPOPCUTD=program -DFOLDER=scratch
file(MAKE_DIRECTORY ${FOLDER})
foreach(kind bash zsh fish man)
  foreach(program popcut popcutd)
    set(words help-page ${kind})
    set(path ${POPCUT})
    if(program STREQUAL "popcutd")
      set(words --help-page ${kind})
      set(path ${POPCUTD})
    endif()
    set(file ${FOLDER}/${program}.${kind})
    execute_process(COMMAND ${path} ${words} OUTPUT_FILE ${file} ERROR_VARIABLE err
      RESULT_VARIABLE result)
    file(READ ${file} text)
    if(NOT result EQUAL 0 OR NOT err STREQUAL "" OR NOT text MATCHES "${program}")
      message(FATAL_ERROR "${program} ${words}: ${result} ${err}")
    endif()
    if(kind STREQUAL "man")
      find_program(MAN man)
      if(MAN)
        execute_process(COMMAND ${MAN} --warnings -l ${file} OUTPUT_QUIET ERROR_VARIABLE err)
        if(NOT err STREQUAL "")
          message(FATAL_ERROR "man complains of ${program}: ${err}")
        endif()
      endif()
      continue()
    endif()
    find_program(SHELL_${kind} ${kind})
    if(NOT SHELL_${kind})
      message("${kind} is not here: its completions are not read by it")
      continue()
    endif()
    execute_process(COMMAND ${SHELL_${kind}} -n ${file} RESULT_VARIABLE result ERROR_VARIABLE err)
    if(NOT result EQUAL 0 OR NOT err STREQUAL "")
      message(FATAL_ERROR "${kind} cannot read the completions of ${program}: ${err}")
    endif()
  endforeach()
endforeach()
# What bash completes, asked as it asks.
file(WRITE ${FOLDER}/ask.sh "
source ${FOLDER}/popcut.bash
ask() { COMP_WORDS=(\"$@\"); COMP_CWORD=$((\${#COMP_WORDS[@]} - 1)); COMPREPLY=(); _popcut_start; echo \"\${COMPREPLY[*]}\"; }
ask popcut tok
ask popcut token c
ask popcut token create --role op
ask popcut cut sphere.json --wai
ask popcut --json -q tok
ask popcut confirm 01J 1 go
ask popcut arm --blank 2 01J 1 x
ask popcut design --example sph
ask popcut cut --device sim : portrait4
ask popcut cut --device = sim : portrait4
ask popcut cut --device popcut
")
get_filename_component(programs ${POPCUT} DIRECTORY)
execute_process(COMMAND ${CMAKE_COMMAND} -E env "PATH=${programs}:$ENV{PATH}"
                        "POPCUT_URL=unix:${FOLDER}/nobody.sock" bash ${FOLDER}/ask.sh OUTPUT_VARIABLE said ERROR_VARIABLE err)
if(NOT said STREQUAL "token\ncreate\noperator\n--wait\ntoken\ngood\n\nsphere\nportrait4\nportrait4\n\n")
  message(FATAL_ERROR "bash completes: ${said}${err}")
endif()
