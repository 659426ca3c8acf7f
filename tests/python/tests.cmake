# The blocks of doc/python.md read fields, for which numpy and vtk must be there.
execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import numpy, vtk"
  RESULT_VARIABLE python_packages_result OUTPUT_QUIET ERROR_QUIET)
if(python_packages_result EQUAL 0)
  add_test(NAME python_page_runs_in_order
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/python/page_test.py $<TARGET_FILE:tombolo_program>)
else()
  message(STATUS "numpy or vtk for Python is missing: the page of the package tombolo is not tested.")
endif()
