# Every shipped example is designed and then verified from its file alone.
# -DPOPCUT=program -DFOLDER=scratch
execute_process(COMMAND ${POPCUT} design --list OUTPUT_VARIABLE list RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "popcut design --list ends with ${result}")
endif()
string(REGEX MATCHALL "[^\n]+" lines "${list}")
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(count 0)
foreach(line ${lines})
  string(REGEX MATCH "^[^ ]+" name "${line}")
  execute_process(COMMAND ${POPCUT} design --example ${name} OUTPUT_FILE ${FOLDER}/${name}.json
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${POPCUT} design ${FOLDER}/${name}.json -o ${FOLDER}/${name} -q
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${POPCUT} verify ${FOLDER}/${name}/pattern.fold --dof 1
    RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "example ${name} is unsound (${result}):\n${out}${err}")
  endif()
  math(EXPR count "${count} + 1")
endforeach()
if(count LESS 5)
  message(FATAL_ERROR "only ${count} examples are shipped")
endif()
