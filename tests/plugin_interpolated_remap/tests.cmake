# The remap of refills by interpolation, which scenes load by the name of its library; its unit tests
# have it compiled in.
set(remap_sources)
foreach(source cloud_functions cloud_interpolation interpolated_remap)
  list(APPEND remap_sources ${CMAKE_CURRENT_LIST_DIR}/${source}.cc)
endforeach()
tombolo_add_shared_plugin(interpolated_remap test_remesh ${remap_sources})
