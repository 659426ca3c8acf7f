add_test(NAME measure_cut_of_made_up_tables
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/cutting/measure_cut_test.py)
