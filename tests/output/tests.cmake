# The solution files of a scene with known fields, as VTK (and so ParaView) reads them.
find_program(TOMBOLO_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
add_executable(write_solution ${CMAKE_CURRENT_SOURCE_DIR}/output/write_solution.cc)
tombolo_setup_target(write_solution)
tombolo_compile_cold(write_solution)
target_link_libraries(write_solution tombolo)

# Dimension, degree, first x of the particles, all of the section or one cell, ranks. With one cell
# on 3 ranks some have no particles; with particles from x = 0 some have no cells.
foreach(case "2 1 2 all 1" "3 1 2 all 3" "3 2 2 all 2" "2 3 2 all 2" "3 1 3 one 3" "2 1 3 one 3"
             "3 1 1 all 3" "2 2 1 all 3")
  string(REPLACE " " ";" arguments ${case})
  string(REPLACE " " "_" name ${case})
  list(GET arguments 4 rank_count)
  add_test(NAME output.solution_is_read_by_vtk_${name}
    COMMAND ${TOMBOLO_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/output/check_solution.py ${arguments}
            ${DEAL_II_MPIEXEC} $<TARGET_FILE:write_solution>
    WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  set_tests_properties(output.solution_is_read_by_vtk_${name} PROPERTIES
    PROCESSORS ${rank_count}
    ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_rmaps_base_oversubscribe=1;PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe;OMP_NUM_THREADS=1")
endforeach()

# tombolo_add_output_test(NAME SCRIPT RANKS ARGUMENT...): the script on each of the rank counts.
function(tombolo_add_output_test name script rank_counts)
  foreach(rank_count ${rank_counts})
    add_test(NAME output.${name}.mpirun=${rank_count}
      COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_SOURCE_DIR}/output/${script} ${rank_count}
        ${DEAL_II_MPIEXEC} $<TARGET_FILE:tombolo_program> ${ARGN})
    set_tests_properties(output.${name}.mpirun=${rank_count} PROPERTIES PROCESSORS ${rank_count})
  endforeach()
endfunction()

# The pictures of a run as ParaView shows them: glyphs, tools, fields on request.
tombolo_add_output_test(pictures_are_right_in_paraview check_pictures.py "1;3")
# The same in HDF5. Debian's VTK reads no XDMF; ParaView's Python does, where it is installed.
find_program(TOMBOLO_PVPYTHON pvpython)
tombolo_add_output_test(pictures_in_hdf5 check_xdmf.py "1;3" ${PROJECT_SOURCE_DIR}/scripts
  ${TOMBOLO_PVPYTHON})
tombolo_add_output_test(tables_in_hdf5 check_tables.py "1;3" ${PROJECT_SOURCE_DIR}/scripts)
tombolo_add_output_test(probes_at_nodes_of_a_mesh_file check_mesh_nodes.py "1;2;3"
  ${PROJECT_SOURCE_DIR}/scripts)
