# Shared objects from outside the library, for tests/unit/base/input/plugin_library.cc.
foreach(plugin twin_material second_elastic_material incomplete_material throwing_material
    exiting_material)
  add_library(${plugin} MODULE ${CMAKE_CURRENT_LIST_DIR}/${plugin}.cc)
  tombolo_setup_target(${plugin})
  tombolo_compile_cold(${plugin})
  target_link_libraries(${plugin} tombolo)
  set_target_properties(${plugin} PROPERTIES
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/plugin_library)
  add_dependencies(test_base ${plugin})
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/tests/plugin_library/text.so "this is text\n")
