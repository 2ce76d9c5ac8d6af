# parian_embed_shaders(OUT file...): makes a C source that holds the shader files as strings:
#   const parian_shader_text parian_shader_texts[]; const size_t parian_shader_text_count;
function(parian_embed_shaders out)
  set(target_file "${CMAKE_CURRENT_BINARY_DIR}/shader_texts.c")
  string(REPLACE ";" "|" joined "${ARGN}")
  add_custom_command(OUTPUT "${target_file}"
    COMMAND ${CMAKE_COMMAND} "-DOUTPUT=${target_file}" "-DFILES=${joined}"
            -P "${PROJECT_SOURCE_DIR}/cmake/embed_shaders_script.cmake"
    DEPENDS ${ARGN} "${PROJECT_SOURCE_DIR}/cmake/embed_shaders_script.cmake"
    VERBATIM)
  set(${out} "${target_file}" PARENT_SCOPE)
endfunction()
