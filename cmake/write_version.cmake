# Writes HEADER from version.h.in; run as a script by the target tombolo_version.
execute_process(
  # Without optional locks, so that a build never disturbs a git command beside it.
  COMMAND git --no-optional-locks describe --always --dirty --abbrev=10 --exclude=*
  WORKING_DIRECTORY ${SOURCE_DIRECTORY}
  OUTPUT_VARIABLE TOMBOLO_GIT_HASH
  OUTPUT_STRIP_TRAILING_WHITESPACE
  RESULT_VARIABLE git_result
  ERROR_QUIET)
if(NOT git_result EQUAL 0)
  set(TOMBOLO_GIT_HASH "unknown")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/version.h.in ${HEADER} @ONLY)
