# What scripts/fuzz starts the programs with.
add_library(fork_server MODULE ${CMAKE_CURRENT_LIST_DIR}/fork_server.c)
target_compile_options(fork_server PRIVATE -Wall -Wextra)
target_link_libraries(fork_server PRIVATE ${CMAKE_DL_LIBS})
set_target_properties(fork_server PROPERTIES PREFIX lib)
