# ninja install: program, library, headers and what find_package(Tombolo) needs, so that a plug-in
# can be built outside of this project (against an installation or against this build directory).
include(CMakePackageConfigHelpers)

set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/Tombolo)
install(TARGETS tombolo tombolo_waves EXPORT TomboloTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS ${TOMBOLO_PROGRAMS} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/tombolo ${PROJECT_BINARY_DIR}/include/tombolo
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(EXPORT TomboloTargets NAMESPACE Tombolo:: DESTINATION ${package_directory})
export(EXPORT TomboloTargets NAMESPACE Tombolo:: FILE ${PROJECT_BINARY_DIR}/TomboloTargets.cmake)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/TomboloConfig.cmake.in
  ${PROJECT_BINARY_DIR}/TomboloConfig.cmake INSTALL_DESTINATION ${package_directory})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TomboloConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
configure_file(${PROJECT_SOURCE_DIR}/cmake/TomboloTarget.cmake
  ${PROJECT_BINARY_DIR}/TomboloTarget.cmake COPYONLY)
install(FILES
  ${PROJECT_BINARY_DIR}/TomboloConfig.cmake
  ${PROJECT_BINARY_DIR}/TomboloConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/TomboloTarget.cmake
  DESTINATION ${package_directory})
