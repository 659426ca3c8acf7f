# An element from outside the library: built as a shared object,
# loaded through `Plugin libraries`.
add_library(plain_hexahedron MODULE ${CMAKE_CURRENT_LIST_DIR}/plain_hexahedron.cc)
tombolo_setup_target(plain_hexahedron)
tombolo_compile_cold(plain_hexahedron)
target_link_libraries(plain_hexahedron tombolo)
set_target_properties(plain_hexahedron PROPERTIES
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/plugin)

add_test(NAME plugin_an_element_from_outside_runs_the_rod
  COMMAND ${CMAKE_COMMAND}
    -DPROGRAM=$<TARGET_FILE:tombolo_program>
    -DPLUGIN=$<TARGET_FILE:plain_hexahedron>
    -DPARAMETER_FILE=${PROJECT_SOURCE_DIR}/parameter_files/elastic_wave/fe.prm
    -DOUTPUT=${PROJECT_BINARY_DIR}/tests/plugin/rod
    -P ${CMAKE_CURRENT_LIST_DIR}/run_rod.cmake)

# The installation that the projects in tests/plugin_* find.
add_test(NAME install_to_a_prefix
  COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR}
    --prefix ${PROJECT_BINARY_DIR}/tests/prefix)
set_tests_properties(install_to_a_prefix PROPERTIES FIXTURES_SETUP installed_prefix)

# Projects of their own, which find it, build a plug-in and run it.
foreach(kind formulation material process pairing)
  set(plugin_source ${PROJECT_SOURCE_DIR}/tests/plugin_${kind})
  add_test(NAME plugin_a_${kind}_from_outside
    COMMAND ${TOMBOLO_PYTHON} -B ${plugin_source}/check.py ${PROJECT_BINARY_DIR}/tests/prefix
      ${plugin_source} ${PROJECT_BINARY_DIR}/tests/plugin_${kind} ${DEAL_II_MPIEXEC} ${CMAKE_COMMAND})
  set_tests_properties(plugin_a_${kind}_from_outside PROPERTIES FIXTURES_REQUIRED installed_prefix)
endforeach()
