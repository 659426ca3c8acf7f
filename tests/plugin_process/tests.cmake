# A process from outside: a project of its own finds an installed Tombolo, builds the plug-in and
# runs it.
add_test(NAME plugin_a_process_from_outside
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/check.py
    ${PROJECT_BINARY_DIR}/tests/prefix ${CMAKE_CURRENT_LIST_DIR}
    ${PROJECT_BINARY_DIR}/tests/plugin_process ${DEAL_II_MPIEXEC} ${CMAKE_COMMAND})
set_tests_properties(plugin_a_process_from_outside PROPERTIES
  FIXTURES_REQUIRED installed_prefix)
