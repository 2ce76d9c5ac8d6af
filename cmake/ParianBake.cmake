# parian_bake(): an asset as a build product. Comes with find_package(Parian).
#
#   parian_bake(TARGET name | OUTPUT file
#     INPUT model              .glb .gltf .obj .ply .stl .off; relative to the source folder
#     [MATERIAL name...]       presets, FILE.json, MESHNAME=NAME, as for --material
#     [SCALE len]              longest side, such as 50mm; or [UNIT mm|cm|m]
#     [QUALITY preview|medium|production]
#     [OPTIONS option...]      more of parian-bake's options
#     [DEPENDS file...])       more files or targets to wait for
#
# OUTPUT is relative to the binary folder; without one it is the model's name with .parian. With TARGET the asset is
# made by that target: a new one that is part of `all`, or one that is there already (the program that loads it).
# It is baked again when the model, the buffers and pictures that a .gltf names, a material file or parian-bake change.
# The target's property PARIAN_ASSETS lists the assets' paths. PARIAN_BAKE_EXECUTABLE names another parian-bake, for
# instance when the program is built for another machine.
cmake_policy(VERSION 3.20...3.25)

function(parian_bake)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "TARGET;OUTPUT;INPUT;SCALE;UNIT;QUALITY" "MATERIAL;OPTIONS;DEPENDS")
  if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "parian_bake: not understood: ${arg_UNPARSED_ARGUMENTS} ${arg_KEYWORDS_MISSING_VALUES}")
  elseif(NOT arg_INPUT OR NOT (arg_TARGET OR arg_OUTPUT))
    message(FATAL_ERROR "parian_bake: needs INPUT, and TARGET or OUTPUT")
  endif()
  if(PARIAN_BAKE_EXECUTABLE)
    set(tool "${PARIAN_BAKE_EXECUTABLE}")
  elseif(TARGET Parian::parian-bake)
    set(tool Parian::parian-bake)
  else()
    message(FATAL_ERROR "parian_bake: this Parian was built without parian-bake; set PARIAN_BAKE_EXECUTABLE")
  endif()
  get_filename_component(input "${arg_INPUT}" ABSOLUTE)
  if(NOT arg_OUTPUT)
    get_filename_component(stem "${arg_INPUT}" NAME_WLE)
    set(arg_OUTPUT "${stem}.parian")
  endif()
  get_filename_component(output "${arg_OUTPUT}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
  set(options)
  foreach(material IN LISTS arg_MATERIAL)
    _parian_absolute_material("${material}" material)
    list(APPEND options --material "${material}")
  endforeach()
  foreach(name SCALE UNIT QUALITY)
    if(arg_${name})
      string(TOLOWER ${name} option)
      list(APPEND options --${option} "${arg_${name}}")
    endif()
  endforeach()
  add_custom_command(OUTPUT "${output}"
    COMMAND ${tool} -q "${input}" -o "${output}" -MF "${output}.d" ${options} ${arg_OPTIONS}
    DEPENDS "${input}" ${tool} ${arg_DEPENDS} DEPFILE "${output}.d"
    COMMENT "Baking ${arg_OUTPUT}" VERBATIM)
  if(arg_TARGET)
    _parian_attach_asset("${arg_TARGET}" "${output}")
  endif()
endfunction()

# A material file is named by its whole path, because the build runs elsewhere.
function(_parian_absolute_material material out)
  set(mesh "")
  if(material MATCHES "^([^=]*=)(.*)$")
    set(mesh "${CMAKE_MATCH_1}")
    set(material "${CMAKE_MATCH_2}")
  endif()
  if(material MATCHES "/|\\.json$")
    get_filename_component(material "${material}" ABSOLUTE)
  endif()
  set(${out} "${mesh}${material}" PARENT_SCOPE)
endfunction()

function(_parian_attach_asset target asset)
  if(NOT TARGET ${target})
    add_custom_target(${target} ALL DEPENDS "${asset}")
  else()
    string(MD5 hash "${asset}")
    add_custom_target(${target}_asset_${hash} DEPENDS "${asset}")
    add_dependencies(${target} ${target}_asset_${hash})
  endif()
  set_property(TARGET ${target} APPEND PROPERTY PARIAN_ASSETS "${asset}")
endfunction()
