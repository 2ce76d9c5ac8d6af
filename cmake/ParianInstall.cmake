# The packages that applications find the libraries by, and what else is installed: manual pages, completion, documents.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Parian)
install(EXPORT ParianTargets NAMESPACE Parian:: DESTINATION ${package_dir})
install(EXPORT ParianTools NAMESPACE Parian:: DESTINATION ${package_dir})
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/ParianConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/ParianConfig.cmake" INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/ParianConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/ParianConfig.cmake" "${PROJECT_BINARY_DIR}/ParianConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/ParianBake.cmake" DESTINATION ${package_dir})

# pkg-config: paths follow the place of the .pc file, so that the installed tree can be moved.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
  set(pc_prefix "${CMAKE_INSTALL_PREFIX}")
  set(pc_libdir "${CMAKE_INSTALL_FULL_LIBDIR}")
  set(pc_includedir "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
else()
  file(RELATIVE_PATH pc_up "/root/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/root")
  string(REGEX REPLACE "/$" "" pc_up "${pc_up}")
  set(pc_prefix "\${pcfiledir}/${pc_up}")
  set(pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
  set(pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()
foreach(library format runtime)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/parian-${library}.pc.in" "${PROJECT_BINARY_DIR}/parian-${library}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/parian-${library}.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

include(ParianManuals)
parian_manuals(parian-bake parian-view parian-info parian-measure parian-models parian-montage)

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md" DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(PARIAN_WITH_BAKE)
  install(FILES "${PROJECT_SOURCE_DIR}/bake/LICENSE" DESTINATION ${CMAKE_INSTALL_DOCDIR}/bake)
endif()
