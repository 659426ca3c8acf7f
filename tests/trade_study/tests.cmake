# The study on a mock program that ends in all the ways in which programs end.
add_test(NAME trade_study.mock_program
  COMMAND ${TOMBOLO_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/check.py ${CMAKE_CURRENT_BINARY_DIR}/trade_study)
# In seconds, so that it does not begin last where none were measured yet.
set_tests_properties(trade_study.mock_program PROPERTIES COST 20)

# The studies that come with the project say nothing wrong, and a small one runs.
file(GLOB study_files CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/parameter_files/trade_study/*.prm
  ${PROJECT_SOURCE_DIR}/parameter_files/stability/*.prm)
foreach(study_file ${study_files})
  get_filename_component(study ${study_file} NAME_WE)
  add_test(NAME trade_study.${study}_is_valid
    COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts
      ${TOMBOLO_PYTHON} -B -m studying --validate ${study_file})
endforeach()

add_test(NAME trade_study.tables
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/tables_test.py)
add_test(NAME trade_study.curves
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/curves_test.py)

execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import scipy.optimize"
  RESULT_VARIABLE scipy_is_missing OUTPUT_QUIET ERROR_QUIET)
if(NOT scipy_is_missing)
  add_test(NAME trade_study.least COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/least_test.py)
else()
  message(STATUS "scipy for Python is missing: searches for the least error are not tested.")
endif()
