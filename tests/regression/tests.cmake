# Cases of whole runs: tests/regression/NAME.json, with scenes beside them; run_case.py explains them.
# Most runs have one rank: a case keeps one processor, and two cases keep two of them busy.
file(GLOB regression_cases CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.json)
foreach(regression_case ${regression_cases})
  get_filename_component(case_name ${regression_case} NAME_WE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${regression_case})
  add_test(NAME regression.${case_name}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/run_case.py ${regression_case}
      --program $<TARGET_FILE:tombolo_program> --mpiexec ${DEAL_II_MPIEXEC}
      --output ${PROJECT_BINARY_DIR}/tests/regression/${case_name})
endforeach()
add_test(NAME regression_runner_notices_what_is_wrong
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/run_case_test.py)
