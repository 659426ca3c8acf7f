# The short study on one rank and on two, and what it must find.
foreach(rank_count 1 2)
  tombolo_add_mpi_test(reflection_study.quick.mpirun=${rank_count} ${rank_count}
    $<TARGET_FILE:reflection_study_program>
    ${PROJECT_SOURCE_DIR}/parameter_files/reflection_study/quick.prm
    --set "Output directory = reflection_study_${rank_count}")
  set_tests_properties(reflection_study.quick.mpirun=${rank_count} PROPERTIES
    FIXTURES_SETUP reflection_tables)
endforeach()
add_test(NAME reflection_study.quick.results
  COMMAND ${TOMBOLO_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/check.py
    ${CMAKE_CURRENT_BINARY_DIR}/reflection_study_1/reflection.csv
    ${CMAKE_CURRENT_BINARY_DIR}/reflection_study_2/reflection.csv)
set_tests_properties(reflection_study.quick.results PROPERTIES FIXTURES_REQUIRED reflection_tables)

add_test(NAME reflection_study.paper_table_is_valid
  COMMAND $<TARGET_FILE:reflection_study_program> --validate
    ${PROJECT_SOURCE_DIR}/parameter_files/reflection_study/paper_table.prm)

execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import matplotlib"
  RESULT_VARIABLE python_packages_result OUTPUT_QUIET ERROR_QUIET)
if(python_packages_result EQUAL 0)
  add_test(NAME reflection_study.picture
    COMMAND ${TOMBOLO_PYTHON} -B -m plotting.reflection
      ${CMAKE_CURRENT_BINARY_DIR}/reflection_study_1
      ${CMAKE_CURRENT_BINARY_DIR}/reflection_study_1/reflection.png)
  set_tests_properties(reflection_study.picture PROPERTIES
    FIXTURES_REQUIRED reflection_tables
    ENVIRONMENT "PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts"
    PASS_REGULAR_EXPRESSION "reflection_study_1/reflection.png")
endif()
