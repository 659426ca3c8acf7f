# The program as its users see it: what it says to bad input, its command line, what it leaves behind.
foreach(cases bad_entries bad_model bad_mesh bad_run bad_contact bad_bodies bad_heat bad_scaling bad_statics large_strains
    bad_meshes bad_rigid fast_bodies)
  foreach(rank_count 1 2)
    add_test(NAME program.${cases}_is_refused.mpirun=${rank_count}
      COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/run_cases.py
        $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${rank_count}
        ${CMAKE_CURRENT_LIST_DIR}/${cases}.json)
    set_tests_properties(program.${cases}_is_refused.mpirun=${rank_count} PROPERTIES
      PROCESSORS ${rank_count})
  endforeach()
endforeach()
foreach(subject options leavings signals shipped)
  add_test(NAME program.${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/command_line.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${PROJECT_SOURCE_DIR} ${subject})
endforeach()
foreach(subject mistakes advice)
  add_test(NAME program.${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/${subject}.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${PROJECT_SOURCE_DIR})
endforeach()
add_test(NAME program.parameters_page
  COMMAND ${PROJECT_SOURCE_DIR}/scripts/parameters_page --check --program
    $<TARGET_FILE:tombolo_program>)
add_test(NAME program.materials
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/materials.py
    $<TARGET_FILE:tombolo_program> ${PROJECT_SOURCE_DIR})
foreach(subject bitwise_rods bitwise_divisions bitwise_refills bitwise_kernels bitwise_fragments
    bitwise_impacts bitwise_contacts bitwise_stages ranks interruption refusals)
  add_test(NAME program.checkpoint_${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/checkpoint.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${PROJECT_SOURCE_DIR} ${subject})
endforeach()
foreach(subject runs bitwise ranks)
  add_test(NAME program.heat_${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/heat.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${PROJECT_SOURCE_DIR} ${subject})
endforeach()
foreach(subject bitwise strip cylinder meshfree stop)
  add_test(NAME program.statics_${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/statics.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${PROJECT_SOURCE_DIR} ${subject})
endforeach()
# Most runs of the others have one rank.
set_tests_properties(program.checkpoint_ranks program.heat_ranks PROPERTIES PROCESSORS 2)
# Changes fields of checkpoints for faults.py.
add_executable(edit_checkpoint ${CMAKE_CURRENT_LIST_DIR}/edit_checkpoint.cc)
tombolo_setup_target(edit_checkpoint)
target_link_libraries(edit_checkpoint tombolo)
foreach(subject disk endings damage)
  add_test(NAME program.faults_${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/faults.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${PROJECT_SOURCE_DIR}
      $<TARGET_FILE:edit_checkpoint> ${subject})
endforeach()
foreach(subject motion rest tables sections ranks)
  add_test(NAME program.conditions_${subject}
    COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/conditions.py
      $<TARGET_FILE:tombolo_program> ${DEAL_II_MPIEXEC} ${subject})
endforeach()

# A program that no processor is good enough for.
add_executable(demanding ${PROJECT_SOURCE_DIR}/applications/start/refuse_processor.cc
  ${CMAKE_CURRENT_LIST_DIR}/demanding_features.cc)
set_target_properties(demanding PROPERTIES UNITY_BUILD OFF)
# The installed prefix is that of tests/plugin.
add_test(NAME program.installation
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/installation.py ${PROJECT_BINARY_DIR}/tests/prefix
    $<TARGET_FILE:tombolo_program> $<TARGET_FILE:demanding> ${PROJECT_SOURCE_DIR})
set_tests_properties(program.installation PROPERTIES FIXTURES_REQUIRED installed_prefix)

# Seconds of the longest tests, which begin first where none were measured yet; ctest mixes them into
# what it measures.
set_tests_properties(program.checkpoint_bitwise_refills program.shipped program.faults_endings program.heat_bitwise PROPERTIES COST 30)
