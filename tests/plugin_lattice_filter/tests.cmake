# The lattice filter, a process that scenes load by the name of its library; unit tests of bodies have
# it compiled in.
tombolo_add_shared_plugin(lattice_filter test_physics ${CMAKE_CURRENT_LIST_DIR}/lattice_filter.cc)
