# Writes HEADER from version.h.in and headers.h beside it; run as a script by the target tombolo_version.
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

# What a plug-in was built with: another number with any change of a header of the library.
file(GLOB_RECURSE headers RELATIVE ${SOURCE_DIRECTORY}/include ${SOURCE_DIRECTORY}/include/*.h)
list(SORT headers)
set(all_headers "")
foreach(header ${headers})
  file(SHA256 ${SOURCE_DIRECTORY}/include/${header} sum)
  string(APPEND all_headers "${header} ${sum}\n")
endforeach()
string(SHA256 sum "${all_headers}")
string(SUBSTRING ${sum} 0 16 TOMBOLO_HEADERS)
get_filename_component(directory ${HEADER} DIRECTORY)
configure_file(${CMAKE_CURRENT_LIST_DIR}/headers.h.in ${directory}/headers.h @ONLY)
