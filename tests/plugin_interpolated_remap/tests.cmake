# The remap of refills by interpolation, which scenes load by the name of its library; its unit tests
# have it compiled in.
set(remap_sources)
foreach(source cloud_functions cloud_interpolation interpolated_remap)
  list(APPEND remap_sources ${CMAKE_CURRENT_LIST_DIR}/${source}.cc)
endforeach()
add_library(interpolated_remap MODULE ${remap_sources})
tombolo_setup_target(interpolated_remap)
tombolo_compile_cold(interpolated_remap)
target_link_libraries(interpolated_remap tombolo)
target_sources(test_remesh PRIVATE ${remap_sources})
set_source_files_properties(${remap_sources} PROPERTIES UNITY_GROUP interpolated_remap)
