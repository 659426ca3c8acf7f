# What the tests in Python start the program with, so that its libraries are loaded once a test.
add_library(program_server MODULE ${CMAKE_CURRENT_LIST_DIR}/program_server.c
  $<TARGET_OBJECTS:waiting_rank>)
target_compile_options(program_server PRIVATE -Wall -Wextra)
target_link_libraries(program_server PRIVATE ${CMAKE_DL_LIBS})
set_target_properties(program_server PROPERTIES PREFIX lib)
# The same for programs that are started from their files.
add_library(preloaded_waiting_rank MODULE $<TARGET_OBJECTS:waiting_rank>)
set_target_properties(preloaded_waiting_rank PROPERTIES PREFIX lib LINKER_LANGUAGE C)
add_executable(start_loaded ${CMAKE_CURRENT_LIST_DIR}/start_loaded.c)
target_compile_options(start_loaded PRIVATE -Wall -Wextra)
add_test(NAME loaded_program_runs_as_one_that_is_started
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/loaded_test.py
    $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC})
