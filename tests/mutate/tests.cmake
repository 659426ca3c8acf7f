add_test(NAME mutants_fit_to_the_sources
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/mutants_test.py)
