# A particle formulation from outside: a project of its own finds an installed Tombolo, builds the
# plug-in and runs it.
add_test(NAME plugin_a_formulation_from_outside
  COMMAND ${CMAKE_COMMAND}
    -DPREFIX=${PROJECT_BINARY_DIR}/tests/prefix
    -DSOURCE=${CMAKE_CURRENT_LIST_DIR}
    -DBINARY=${PROJECT_BINARY_DIR}/tests/plugin_formulation
    -DMPIEXEC=${DEAL_II_MPIEXEC}
    -P ${CMAKE_CURRENT_LIST_DIR}/run.cmake)
set_tests_properties(plugin_a_formulation_from_outside PROPERTIES
  FIXTURES_REQUIRED installed_prefix)
