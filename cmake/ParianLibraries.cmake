# What is installed: libraries, tools, and under which names applications link them.

# parian_public_library(TARGET NAME HEADERS file... LINKS lib... [BASE target]): installs the static library TARGET as
# Parian::NAME. With BUILD_SHARED_LIBS that is a shared library of the same objects, which exports what the public
# headers declare and nothing else; TARGET then serves Parian's own programs, which need more.
#   HEADERS  of include/parian that declare what is exported    LINKS  what the shared library links
#   BASE     the target whose public library an application of this one links too
function(parian_public_library target name)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "BASE" "HEADERS;LINKS")
  set_target_properties(${target} PROPERTIES C_VISIBILITY_PRESET hidden)
  set(public ${target})
  if(BUILD_SHARED_LIBS)
    set(public ${target}_shared)
    add_library(${public} SHARED $<TARGET_OBJECTS:${target}>)
    set_target_properties(${public} PROPERTIES LINKER_LANGUAGE C OUTPUT_NAME ${target}
      VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_include_directories(${public} INTERFACE
      $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_libraries(${public} PRIVATE ${arg_LINKS} $<BUILD_INTERFACE:parian_flags>)
    parian_write_exports(exports ${arg_HEADERS})
    target_link_options(${public} PRIVATE -Wl,--no-undefined "-Wl,--version-script=${exports}")
    set_target_properties(${public} PROPERTIES LINK_DEPENDS "${exports}")
    if(arg_BASE)
      target_link_libraries(${public} INTERFACE ${arg_BASE}_shared)
    endif()
  endif()
  set_target_properties(${public} PROPERTIES EXPORT_NAME ${name})
  add_library(Parian::${name} ALIAS ${public})
  install(TARGETS ${public} EXPORT ParianTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY include/parian DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# parian_write_exports(OUT header...): a linker script that exports the functions that the headers name. Hidden
# visibility alone does not do it: it covers neither the static libraries linked in nor the resolvers of cloned functions.
function(parian_write_exports out)
  set(script "${CMAKE_CURRENT_BINARY_DIR}/exports.map")
  set(text "{\n  global:\n")
  foreach(header IN LISTS ARGN)
    set(file "${CMAKE_CURRENT_SOURCE_DIR}/include/parian/${header}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(STRINGS "${file}" lines REGEX "parian_[a-z0-9_]+\\(")
    string(REGEX MATCHALL "parian_[a-z0-9_]+\\(" names "${lines}")
    foreach(name IN LISTS names)
      string(REPLACE "(" ";\n" name "    ${name}")
      string(APPEND text "${name}")
    endforeach()
  endforeach()
  file(CONFIGURE OUTPUT "${script}" CONTENT "${text}  local:\n    *;\n};\n" @ONLY)
  set(${out} "${script}" PARENT_SCOPE)
endfunction()

# parian_install_tool(TARGET): the program, and its name Parian::TARGET for custom commands.
function(parian_install_tool tool)
  add_executable(Parian::${tool} ALIAS ${tool})
  install(TARGETS ${tool} EXPORT ParianTools RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()
