# The CMake package: find_package(Parian) in an application finds Parian::format and Parian::runtime.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Parian)
set_target_properties(parian_format PROPERTIES EXPORT_NAME format)
set_target_properties(parian_runtime PROPERTIES EXPORT_NAME runtime)
install(EXPORT ParianTargets NAMESPACE Parian:: DESTINATION ${package_dir})
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/ParianConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/ParianConfig.cmake" INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/ParianConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/ParianConfig.cmake" "${PROJECT_BINARY_DIR}/ParianConfigVersion.cmake"
  DESTINATION ${package_dir})

include(ParianManuals)
parian_manuals(parian-bake parian-view parian-info parian-measure parian-models parian-montage)
