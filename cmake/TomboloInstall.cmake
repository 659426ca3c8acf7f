# ninja install: programs, library, headers and what find_package(Tombolo) needs, so that a plug-in
# can be built outside of this project (against an installation or against this build directory);
# scripts that need no build, parameter files and pages. The result can be moved as a whole.
include(CMakePackageConfigHelpers)

install(TARGETS tombolo EXPORT TomboloTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS ${TOMBOLO_PROGRAMS} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/tombolo ${PROJECT_BINARY_DIR}/include/tombolo
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

set(document_directory ${CMAKE_INSTALL_DATAROOTDIR}/doc/tombolo)
set(data_directory ${CMAKE_INSTALL_DATAROOTDIR}/tombolo)
install(FILES
  ${PROJECT_SOURCE_DIR}/LICENSE
  ${PROJECT_SOURCE_DIR}/README.md
  ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md
  ${PROJECT_SOURCE_DIR}/CITATION.cff
  ${PROJECT_SOURCE_DIR}/cmake/packaging/copyright
  DESTINATION ${document_directory})
# README.md leads to doc/.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/doc DESTINATION ${document_directory})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/parameter_files DESTINATION ${data_directory})
# The plug-ins that the pages for authors walk through, each a project of its own.
foreach(plugin plugin_process plugin_lattice_filter plugin_formulation plugin_material plugin_pairing)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/tests/${plugin} DESTINATION ${data_directory}/plugins
    FILES_MATCHING PATTERN "*.cc" PATTERN "*.h" PATTERN "CMakeLists.txt" PATTERN "*.prm")
endforeach()
# Scripts that work on results and input, each as the command tombolo-NAME.
set(installed_scripts plot report reflection_study plot_reflection import study submit)
foreach(script ${installed_scripts})
  install(PROGRAMS ${PROJECT_SOURCE_DIR}/scripts/${script} DESTINATION ${data_directory}/scripts)
  string(REPLACE "_" "-" command tombolo-${script})
  file(RELATIVE_PATH TOMBOLO_SCRIPT /${CMAKE_INSTALL_BINDIR} /${data_directory}/scripts/${script})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/packaging/command.in
    ${PROJECT_BINARY_DIR}/packaging/${command} @ONLY)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/packaging/${command} DESTINATION ${CMAKE_INSTALL_BINDIR})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/scripts/common.bash DESTINATION ${data_directory}/scripts)
foreach(module plotting reporting importing studying reflection tombolo)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/${module} DESTINATION ${data_directory}/scripts
    PATTERN "__pycache__" EXCLUDE PATTERN "build" EXCLUDE PATTERN "*.egg-info" EXCLUDE)
endforeach()
# Where Python of Debian looks for packages.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/tombolo DESTINATION lib/python3/dist-packages
  FILES_MATCHING PATTERN "*.py" PATTERN "__pycache__" EXCLUDE PATTERN "build" EXCLUDE PATTERN "*.egg-info" EXCLUDE)

# The manual page is made from what the program says of itself.
find_program(TOMBOLO_PYTHON python3 HINTS /usr/bin)
if(TOMBOLO_PYTHON)
  set(man_page ${PROJECT_BINARY_DIR}/packaging/tombolo.1)
  add_custom_command(OUTPUT ${man_page}
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/cmake/packaging/man_page.py
      $<TARGET_FILE:tombolo_program> > ${man_page}
    DEPENDS tombolo_program ${PROJECT_SOURCE_DIR}/cmake/packaging/man_page.py VERBATIM)
  add_custom_target(man_page ALL DEPENDS ${man_page})
  install(FILES ${man_page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/cmake/packaging/tombolo.bash-completion
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions RENAME tombolo)

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
  ${PROJECT_SOURCE_DIR}/cmake/plugin_headers.cc
  DESTINATION ${package_directory})
