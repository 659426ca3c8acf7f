# Builds corrected_particle.cc with the installation in PREFIX, and runs it: alone, beside elements,
# beside smoothed particles on two ranks, and with heat conduction.
cmake_minimum_required(VERSION 3.18)

function(execute)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN} ended with ${result}:\n${output}")
  endif()
endfunction()

execute(${CMAKE_COMMAND} -S ${SOURCE} -B ${BINARY}/build -DCMAKE_PREFIX_PATH=${PREFIX})
execute(${CMAKE_COMMAND} --build ${BINARY}/build)

# run(NAME OPTION...): a run with the plug-in; its summary goes to the variable summary.
function(run name)
  set(output ${BINARY}/${name})
  execute(${ARGN} --set "Plugin libraries = ${BINARY}/build/libcorrected_particle.so"
    --set "Output directory = ${output}")
  file(READ ${output}/summary.json text)
  set(summary "${text}" PARENT_SCOPE)
endfunction()

# check(KEY BOUND): the magnitude of the last number of this name in the summary is below a bound.
function(check key bound)
  string(REGEX MATCHALL "\"${key}\": *-?[0-9][0-9.e+-]*" entries "${summary}")
  if(NOT entries)
    message(FATAL_ERROR "No ${key} in the summary:\n${summary}")
  endif()
  list(GET entries -1 entry)
  string(REGEX REPLACE ".*: *-?" "" value "${entry}")
  execute_process(COMMAND awk "BEGIN { exit !(${value} < ${bound}) }" RESULT_VARIABLE is_above)
  if(is_above)
    message(FATAL_ERROR "${key} is ${value}, not below ${bound}.")
  endif()
  message(STATUS "${key} ${value} < ${bound}")
endfunction()

set(program ${PREFIX}/bin/tombolo --quiet)

# Alone: the pulse has crossed the middle of the rod. The energy that central differences report is
# off by a term of second order in the time step.
run(rod ${program} ${SOURCE}/rod.prm)
check(energy_error_relative 3e-4)
check(momentum_drift_relative 1e-12)
check(angular_momentum_drift_relative 1e-12)
check(stress_xx 0.1)

# Beside elements, and on two ranks beside smoothed particles; with both it shares nodes.
run(coupled ${program} ${SOURCE}/coupled.prm)
check(energy_error_relative 3e-4)
check(momentum_drift_relative 1e-12)
check(stress_xx 0.05)
run(mixed ${MPIEXEC} -n 2 ${program} ${SOURCE}/mixed.prm)
check(energy_error_relative 3e-4)
check(momentum_drift_relative 1e-12)
check(stress_xx 0.06)

# Heat goes through the rows.
run(bar ${program} ${SOURCE}/bar.prm)
check(heat_balance_error_relative 1e-12)
check(temperature 2e-3)
