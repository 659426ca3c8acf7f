# Parameter files and meshes that scripts/import makes of decks.
foreach(subject dyna_mesh abaqus_mesh text_forms broken_decks)
  add_test(NAME importing.${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/${subject}.py ${PROJECT_SOURCE_DIR})
endforeach()
foreach(subject dyna_scene dyna_forms dyna_cards abaqus_scene abaqus_conditions links histories hardening)
  add_test(NAME importing.${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/${subject}.py ${PROJECT_SOURCE_DIR}
      $<TARGET_FILE:tombolo_program>)
endforeach()
