# Packages: vernier (program, libvernier, plugins, desktop files) and vernier-dev (headers, CMake package), as .deb and
# .tgz, by `cpack` in the build folder; `./dev package` calls it.
set(VERNIER_MAINTAINER "Vernier maintainers <maintainers@vernier.example>")
# AppStream wants a domain read backwards, and the file named after it; that of the maintainers' address.
set(VERNIER_APP_ID example.vernier.vernier)
set(documents ${CMAKE_BINARY_DIR}/packaging)
find_package(Git QUIET)
set(VERNIER_DATE 0)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} log -1 --format=%ct WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
    OUTPUT_VARIABLE git_date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(git_date)
    set(VERNIER_DATE ${git_date})
  endif()
endif()
find_package(Python3 COMPONENTS Interpreter REQUIRED)
file(MAKE_DIRECTORY ${documents})
# For check.sh: the plugins that the package must carry.
get_property(plugins GLOBAL PROPERTY VERNIER_PLUGINS)
list(JOIN plugins "\n" plugins)
file(WRITE ${documents}/plugins.txt "${plugins}\n")
add_custom_target(vernier_package_documents
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:vernier_program> -DSOURCE=${CMAKE_SOURCE_DIR} -DOUT=${documents}
    -DPROJECT_VERSION=${PROJECT_VERSION} -DAPP_ID=${VERNIER_APP_ID} -DDATE=${VERNIER_DATE} "-DMAINTAINER=${VERNIER_MAINTAINER}"
    -P ${CMAKE_CURRENT_LIST_DIR}/documents.cmake
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/sbom.py ${CMAKE_BINARY_DIR} ${documents}/sbom.cdx.json
    ${documents}/licences ${PROJECT_VERSION}
  COMMAND gzip -9nf ${documents}/licences
  DEPENDS vernier_program VERBATIM)

# Made by that target, which `./dev package` builds before it calls cpack; `cmake --install` alone goes without.
install(FILES ${documents}/vernier.1.gz DESTINATION share/man/man1 COMPONENT vernier OPTIONAL)
install(FILES ${documents}/changelog.gz ${documents}/changelog.Debian.gz ${documents}/sbom.cdx.json ${documents}/licences.gz
  ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION share/doc/vernier COMPONENT vernier OPTIONAL)
install(FILES ${documents}/changelog.gz ${documents}/changelog.Debian.gz ${CMAKE_CURRENT_LIST_DIR}/copyright
  DESTINATION share/doc/vernier-dev COMPONENT vernier-dev OPTIONAL)
install(FILES ${documents}/${VERNIER_APP_ID}.metainfo.xml DESTINATION share/metainfo COMPONENT vernier OPTIONAL)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/desktop/vernier.desktop DESTINATION share/applications COMPONENT vernier)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/desktop/vernier.xml DESTINATION share/mime/packages COMPONENT vernier)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/desktop/vernier.svg DESTINATION share/icons/hicolor/scalable/apps
  COMPONENT vernier)
foreach(package vernier vernier-dev)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/lintian/${package} DESTINATION share/lintian/overrides COMPONENT ${package})
endforeach()

set(CPACK_PACKAGE_NAME vernier)
set(CPACK_PACKAGE_VENDOR "Vernier")
set(CPACK_PACKAGE_CONTACT "${VERNIER_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_GENERATOR DEB TGZ)
set(CPACK_COMPONENTS_ALL vernier vernier-dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${VERNIER_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_VERNIER_PACKAGE_NAME vernier)
set(CPACK_DEBIAN_VERNIER_PACKAGE_SECTION science)
# Depends and Recommends come from make.sh, which asks dpkg-shlibdeps: what the window alone links is recommended.
set(CPACK_DEBIAN_VERNIER_PACKAGE_SUGGESTS "libosmesa6")
# CPack indents what follows the first line, and makes the dot of an empty one.
set(CPACK_DEBIAN_VERNIER_DESCRIPTION "review of medical volume images with measured error
Vernier shows CT, MR and angiography studies from DICOM folders as slices,
reformats and slabs. It draws without a graphics card on all cores of the
processor, and every picture carries its measured error against a reference
in double precision.

It is for review, planning and image quality assurance; it is not a medical
device and not for primary diagnosis.")
set(CPACK_COMPONENT_VERNIER_DESCRIPTION "${CPACK_DEBIAN_VERNIER_DESCRIPTION}")

set(CPACK_DEBIAN_VERNIER-DEV_PACKAGE_NAME vernier-dev)
set(CPACK_DEBIAN_VERNIER-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_VERNIER-DEV_PACKAGE_DEPENDS "vernier (= ${PROJECT_VERSION}-1), libglm-dev")
set(CPACK_COMPONENT_VERNIER-DEV_DESCRIPTION "headers for plugins of Vernier
Public headers and the CMake package vernier, with which plugins are built
outside of Vernier's own tree. A plugin fits the release that it was built for.")
include(CPack)
