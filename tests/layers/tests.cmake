add_test(NAME layers_point_one_way
  COMMAND ${TOMBOLO_PYTHON} ${PROJECT_SOURCE_DIR}/tests/layers/check_layers.py
    ${PROJECT_SOURCE_DIR})
add_test(NAME layers_check_notices_every_violation
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/layers/check_layers_test.py)
add_test(NAME features_are_named_in_their_own_files
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/layers/check_features.py
    ${PROJECT_SOURCE_DIR})
add_test(NAME features_check_notices_every_foreign_name
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/layers/check_features_test.py)
