# Runs the elastic rod for a while with the element of PLUGIN, and looks for it in the listing.
execute_process(
  COMMAND ${PROGRAM} --quiet
    --set "Plugin libraries = ${PLUGIN}"
    --set "Part: rod/Formulation = plain hexahedron"
    --set "End time = 2"
    --set "Output/Times = 2"
    --set "Output directory = ${OUTPUT}"
    ${PARAMETER_FILE}
  RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "The rod of the plain hexahedron ended with ${result}.")
endif()
file(READ ${OUTPUT}/summary.json summary)
if(NOT summary MATCHES "\"simulated_time\": *2")
  message(FATAL_ERROR "The run did not reach its end:\n${summary}")
endif()
