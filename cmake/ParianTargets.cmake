# What every target of ours shares: warnings, reproducible floating point, sanitizers.

# The same bytes on any machine: no contraction to fused multiply-add behind our back.
add_library(parian_flags INTERFACE)
target_compile_definitions(parian_flags INTERFACE _GNU_SOURCE)
target_compile_options(parian_flags INTERFACE
  -ffp-contract=off
  $<$<COMPILE_LANG_AND_ID:C,GNU>:-fno-semantic-interposition>
  $<$<COMPILE_LANGUAGE:C>:-Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -fno-math-errno>
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra>)
if(PARIAN_SANITIZE)
  target_compile_options(parian_flags INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g)
  target_link_options(parian_flags INTERFACE -fsanitize=address,undefined)
  target_compile_definitions(parian_flags INTERFACE PARIAN_SANITIZE=1)
endif()

# parian_sources(OUT dir...): the C sources of some folders, one room per file.
function(parian_sources out)
  set(all)
  foreach(dir IN LISTS ARGN)
    file(GLOB found CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${dir}/*.c")
    list(APPEND all ${found})
  endforeach()
  list(SORT all)
  set(${out} ${all} PARENT_SCOPE)
endfunction()
