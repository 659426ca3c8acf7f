# The lattice filter, a process that scenes load by the name of its library; unit tests of bodies have
# it compiled in.
add_library(lattice_filter MODULE ${CMAKE_CURRENT_LIST_DIR}/lattice_filter.cc)
tombolo_setup_target(lattice_filter)
tombolo_compile_cold(lattice_filter)
target_link_libraries(lattice_filter tombolo)
target_sources(test_physics PRIVATE ${CMAKE_CURRENT_LIST_DIR}/lattice_filter.cc)
