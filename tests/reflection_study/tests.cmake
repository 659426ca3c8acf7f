execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import scipy"
  RESULT_VARIABLE python_packages_result OUTPUT_QUIET ERROR_QUIET)
if(NOT python_packages_result EQUAL 0)
  message(STATUS "scipy for Python is missing: the reflection study is not tested.")
  return()
endif()
set(reflection_study ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts
  TOMBOLO_STRIP_OPERATORS=$<TARGET_FILE:strip_operators_program> ${TOMBOLO_PYTHON} -B -m reflection)

# The short study by one process and by two, and what it must find.
foreach(process_count 1 2)
  add_test(NAME reflection_study.quick.processes=${process_count}
    COMMAND ${reflection_study} ${PROJECT_SOURCE_DIR}/parameter_files/reflection_study/quick.prm
      --processes ${process_count} --set "Output directory = reflection_study_${process_count}")
  set_tests_properties(reflection_study.quick.processes=${process_count} PROPERTIES
    FIXTURES_SETUP reflection_tables WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
    PROCESSORS ${process_count})
endforeach()
add_test(NAME reflection_study.quick.results
  COMMAND ${TOMBOLO_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/check.py
    ${CMAKE_CURRENT_BINARY_DIR}/reflection_study_1/reflection.csv
    ${CMAKE_CURRENT_BINARY_DIR}/reflection_study_2/reflection.csv)
set_tests_properties(reflection_study.quick.results PROPERTIES FIXTURES_REQUIRED reflection_tables)

foreach(study paper_table best_options)
  add_test(NAME reflection_study.${study}_is_valid
    COMMAND ${reflection_study} --validate
      ${PROJECT_SOURCE_DIR}/parameter_files/reflection_study/${study}.prm)
endforeach()

foreach(kind waves settings plate)
  add_test(NAME reflection_study.${kind}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/${kind}_test.py
      $<TARGET_FILE:strip_operators_program> $<TARGET_FILE:tombolo_program>)
endforeach()

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
