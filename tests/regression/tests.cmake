# Cases of whole runs: tests/regression/NAME.json, with scenes beside them; run_case.py explains them.
file(GLOB regression_cases CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.json)
foreach(regression_case ${regression_cases})
  get_filename_component(case_name ${regression_case} NAME_WE)
  file(READ ${regression_case} case_text)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${regression_case})
  # Most runs of cases with several ranks have one: two of these fill the processors that are kept for all.
  set(case_processors 1)
  if(case_text MATCHES "\"ranks\"")
    set(case_processors 2)
  endif()
  add_test(NAME regression.${case_name}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/run_case.py ${regression_case}
      --program $<TARGET_FILE:tombolo_program> --mpiexec ${DEAL_II_MPIEXEC} --jobs ${case_processors}
      --output ${PROJECT_BINARY_DIR}/tests/regression/${case_name})
  set_tests_properties(regression.${case_name} PROPERTIES PROCESSORS ${case_processors})
endforeach()
add_test(NAME regression_runner_notices_what_is_wrong
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/run_case_test.py)
