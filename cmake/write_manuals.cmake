# Writes into FOLDER what the tool TOOL says of itself: man1/NAME.1 of the tool and of each of its commands, and its
# completion for bash, zsh and fish. Run by the build (ParianManuals.cmake), after the tool was linked.
get_filename_component(name "${TOOL}" NAME_WE)

# The text that `TOOL [command] --help=form` prints.
function(ask form command out)
  execute_process(COMMAND "${CMAKE_COMMAND}" -E env ASAN_OPTIONS=detect_leaks=0 "${TOOL}" ${command} --help=${form}
    OUTPUT_VARIABLE text RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${name} ${command} --help=${form} ended with ${status}")
  endif()
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

ask(commands "" commands)
string(REGEX MATCHALL "[^\n]+" commands "${commands}")
ask(man "" text)
file(WRITE "${FOLDER}/man1/${name}.1" "${text}")
foreach(command IN LISTS commands)
  ask(man ${command} text)
  file(WRITE "${FOLDER}/man1/${name}-${command}.1" "${text}")
endforeach()
foreach(shell bash zsh fish)
  ask(${shell} "" all)
  foreach(command IN LISTS commands)
    ask(${shell} ${command} text)
    string(APPEND all "${text}")
  endforeach()
  set(${shell}_text "${all}")
endforeach()
string(REPLACE "-" "_" function "_${name}")
string(APPEND zsh_text "\n${function} \"$@\"\n") # zsh runs the file at the first use
file(WRITE "${FOLDER}/bash/${name}" "${bash_text}")
file(WRITE "${FOLDER}/zsh/_${name}" "${zsh_text}")
file(WRITE "${FOLDER}/fish/${name}.fish" "${fish_text}")
