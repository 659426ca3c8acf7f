# Where the packages that scripts/plot needs are not installed, it cannot be tested.
execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import matplotlib, numpy, vtk"
  RESULT_VARIABLE python_packages_result OUTPUT_QUIET ERROR_QUIET)
if(python_packages_result EQUAL 0)
  add_test(NAME plot_draws_the_results_of_a_run
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/plot/plot_test.py)
  add_test(NAME plot_draws_contact_between_bodies
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/plot/body_contact_test.py
      $<TARGET_FILE:tombolo_program>)
else()
  message(STATUS "numpy, matplotlib or vtk for Python is missing: scripts/plot is not tested.")
endif()
