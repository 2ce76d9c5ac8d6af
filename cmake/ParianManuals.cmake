# parian_manuals(tool...): manual pages and shell completion of tools, written by the tools themselves from the
# tables that --help prints, and installed. Those that are not built are passed over.
function(parian_manuals)
  if(CMAKE_CROSSCOMPILING)
    message(STATUS "No manual pages and no completion: the tools cannot run here")
    return()
  endif()
  set(folder "${PROJECT_BINARY_DIR}/manuals")
  set(script "${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake")
  set(stamps)
  foreach(tool IN LISTS ARGN)
    if(TARGET ${tool})
      add_custom_command(OUTPUT "${folder}/${tool}.stamp"
        COMMAND ${CMAKE_COMMAND} "-DTOOL=$<TARGET_FILE:${tool}>" "-DFOLDER=${folder}" -P "${script}"
        COMMAND ${CMAKE_COMMAND} -E touch "${folder}/${tool}.stamp"
        DEPENDS ${tool} "${script}" COMMENT "Writing manual pages and completion of ${tool}" VERBATIM)
      list(APPEND stamps "${folder}/${tool}.stamp")
    endif()
  endforeach()
  add_custom_target(parian_manuals ALL DEPENDS ${stamps})
  install(DIRECTORY "${folder}/man1" DESTINATION ${CMAKE_INSTALL_MANDIR})
  install(DIRECTORY "${folder}/bash/" DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(DIRECTORY "${folder}/zsh/" DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(DIRECTORY "${folder}/fish/" DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endfunction()
