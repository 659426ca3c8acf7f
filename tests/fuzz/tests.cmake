# What scripts/fuzz starts the programs with.
add_library(fork_server MODULE ${CMAKE_CURRENT_LIST_DIR}/fork_server.c)
target_compile_options(fork_server PRIVATE -Wall -Wextra)
target_link_libraries(fork_server PRIVATE ${CMAKE_DL_LIBS})
set_target_properties(fork_server PROPERTIES PREFIX lib)
add_test(NAME fuzz.changed_inputs_are_refused_or_run
  COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts
    ${TOMBOLO_PYTHON} -B -m fuzzing --program $<TARGET_FILE:tombolo_program>
      --library $<TARGET_FILE:fork_server> --inputs 200 --seeds 40
      --keep ${CMAKE_CURRENT_BINARY_DIR}/fuzz_failures)
set_tests_properties(fuzz.changed_inputs_are_refused_or_run PROPERTIES PROCESSORS 2)
add_test(NAME fuzz.scenes
  COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts
    ${TOMBOLO_PYTHON} -B -m fuzzing --program $<TARGET_FILE:tombolo_program> --mpiexec ${DEAL_II_MPIEXEC}
      --scenes 40 --first 81 --jobs 2 --limits 5 --keep ${CMAKE_CURRENT_BINARY_DIR}/scene_failures)
set_tests_properties(fuzz.scenes PROPERTIES PROCESSORS 2)
add_test(NAME fuzz.judge_of_scenes_notices_what_is_wrong
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/scene_judge_test.py)
add_test(NAME fuzz.relations_that_do_not_hold_are_noticed
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/relations_test.py)
add_test(NAME fuzz.relations
  COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts
    ${TOMBOLO_PYTHON} -B -m fuzzing --program $<TARGET_FILE:tombolo_program> --mpiexec ${DEAL_II_MPIEXEC}
      --relations 10 --first 1 --keep ${CMAKE_CURRENT_BINARY_DIR}/relation_failures)
# Of single scenes: two tools with masses that move sideways as well.
add_test(NAME fuzz.relation_of_tools_in_flight
  COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/scripts
    ${TOMBOLO_PYTHON} -B -m fuzzing --program $<TARGET_FILE:tombolo_program> --mpiexec ${DEAL_II_MPIEXEC}
      --relations 1 --first 82165 --kinds flight --keep ${CMAKE_CURRENT_BINARY_DIR}/relation_failures)
