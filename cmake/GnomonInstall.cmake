# cmake --install: headers for hosts, libraries, the program, and what find_package and pkg-config read.
#
# Headers are in include/gnomon. Those that GLSL includes too are in include/gnomon/shared, as in the sources.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(HEADER_FOLDER ${CMAKE_INSTALL_INCLUDEDIR}/gnomon)
set(PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/gnomon)

foreach(LAYER ${GNOMON_INSTALLED_LAYERS})
  get_target_property(TARGET gnomon::${LAYER} ALIASED_TARGET)
  set(FILE_SETS "")
  get_target_property(HEADER_SETS ${TARGET} INTERFACE_HEADER_SETS)
  if(HEADER_SETS)
    foreach(SET ${HEADER_SETS})
      string(REPLACE HEADERS "" FOLDER ${SET})
      list(APPEND FILE_SETS FILE_SET ${SET} DESTINATION ${HEADER_FOLDER}/${FOLDER})
    endforeach()
  endif()
  install(TARGETS ${TARGET} EXPORT gnomon ${FILE_SETS})
endforeach()
install(EXPORT gnomon NAMESPACE gnomon:: FILE gnomon-targets.cmake DESTINATION ${PACKAGE_FOLDER})

# The name in lower case serves find_package(gnomon) and find_package(Gnomon).
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/gnomon-config.cmake.in ${PROJECT_BINARY_DIR}/gnomon-config.cmake
  INSTALL_DESTINATION ${PACKAGE_FOLDER} PATH_VARS CMAKE_INSTALL_BINDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gnomon-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gnomon-config.cmake ${PROJECT_BINARY_DIR}/gnomon-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/GnomonLibraryDependencies.cmake ${CMAKE_CURRENT_LIST_DIR}/GnomonShaders.cmake DESTINATION ${PACKAGE_FOLDER})

# A static library is of no use without what it is linked with. A shared one knows it.
set(PC_REQUIRES "epoxy egl libxxhash glfw3 spng libturbojpeg libwebp simdjson")
set(PC_LIBS "-lmeshoptimizer -ldraco")
if(BUILD_SHARED_LIBS)
  set(PC_REQUIRES "")
  set(PC_LIBS "")
endif()
file(RELATIVE_PATH PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${CMAKE_CURRENT_LIST_DIR}/gnomon.pc.in ${PROJECT_BINARY_DIR}/gnomon.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/gnomon.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

if(GNOMON_PROGRAM)
  install(TARGETS gnomon)
  install(TARGETS gnomon_oiio DESTINATION ${CMAKE_INSTALL_LIBDIR}/gnomon)
  # Debian's Blender finds it there if the prefix is /usr.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/integrations/blender/render_gnomon DESTINATION ${CMAKE_INSTALL_DATADIR}/blender/scripts/addons
    FILES_MATCHING PATTERN "*.py")
endif()

# cpack: a Debian package of all that is installed. Debian's tools find what it needs at run time. Programs that are linked with it need
# what GnomonLibraryDependencies.cmake finds.
if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_NAME gnomon)
  set(CPACK_PACKAGE_CONTACT "The authors of Gnomon")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "cmake, glslang-dev, glslang-tools, libdraco-dev, libegl-dev, libepoxy-dev, libfmt-dev, \
libglfw3-dev, libglm-dev, libmeshoptimizer-dev, libsimdjson-dev, libspng-dev, libturbojpeg0-dev, libwebp-dev, libxxhash-dev, pkg-config, python3-numpy, spirv-tools")
  include(CPack)
endif()
