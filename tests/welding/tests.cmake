add_test(NAME measure_weld_of_made_up_tables
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/welding/measure_weld_test.py)
