# What scripts/benchmark reads and refuses; nothing is timed, and no other package is needed.
add_test(NAME benchmark_reads_and_refuses
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/benchmarking_test.py)
add_test(NAME benchmark_scenes_are_accepted
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/scenes_test.py $<TARGET_FILE:tombolo_program>)
