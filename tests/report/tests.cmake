# Where the packages that scripts/report needs are not installed, it cannot be tested.
execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import matplotlib, numpy, vtk"
  RESULT_VARIABLE python_packages_result OUTPUT_QUIET ERROR_QUIET)
if(python_packages_result EQUAL 0)
  add_test(NAME report_of_a_run_whole_or_damaged
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/report/report_test.py)
  # Without a Chromium, which `scripts/setup chromium` installs, it ends with 77.
  add_test(NAME report_opens_in_a_browser
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/report/browser_test.py)
  set_tests_properties(report_opens_in_a_browser PROPERTIES SKIP_RETURN_CODE 77)
else()
  message(STATUS "numpy, matplotlib or vtk for Python is missing: scripts/report is not tested.")
endif()
