# What is installed, as two components: `vernier` (program, libvernier, plugins, desktop files) and `vernier-dev` (public
# headers and the CMake package that builds plugins elsewhere). Plugins install themselves (VernierPlugin.cmake).
# libvernier is private: it lies in lib/vernier, where nothing else of the system looks.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_LIBDIR lib)
# Where /proc is not mounted (a bare root folder) the loader does not know $ORIGIN; there the package's place holds.
set_target_properties(vernier_program PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/vernier;/usr/lib/vernier")
install(TARGETS vernier_program RUNTIME COMPONENT vernier)
install(TARGETS vernier EXPORT vernierTargets
  LIBRARY DESTINATION lib/vernier COMPONENT vernier NAMELINK_COMPONENT vernier-dev)
set_target_properties(vernier_ui PROPERTIES INSTALL_RPATH "$ORIGIN")
install(TARGETS vernier_ui LIBRARY DESTINATION lib/vernier COMPONENT vernier)

install(TARGETS vernier_vtk LIBRARY DESTINATION lib/vernier COMPONENT vernier)

foreach(module IN LISTS VERNIER_CORE_MODULES)
  install(DIRECTORY modules/${module}/include/vernier DESTINATION include COMPONENT vernier-dev)
endforeach()
install(EXPORT vernierTargets NAMESPACE vernier:: DESTINATION lib/cmake/vernier COMPONENT vernier-dev)
configure_package_config_file(packaging/vernierConfig.cmake.in ${CMAKE_BINARY_DIR}/generated/vernierConfig.cmake
  INSTALL_DESTINATION lib/cmake/vernier PATH_VARS CMAKE_INSTALL_INCLUDEDIR)
# A plugin is built for one release: no other version will do.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/generated/vernierConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${CMAKE_BINARY_DIR}/generated/vernierConfig.cmake ${CMAKE_BINARY_DIR}/generated/vernierConfigVersion.cmake
  modules/cmake/AbiId.cmake modules/cmake/AbiIdTarget.cmake modules/cmake/VernierPlugin.cmake
  DESTINATION lib/cmake/vernier COMPONENT vernier-dev)
install(FILES LICENSE README.md DESTINATION share/doc/vernier COMPONENT vernier)
