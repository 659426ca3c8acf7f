# Test suites of GoogleTest as CMake reads them from a source, for a filter that chooses the tests of
# one file among those of its program.

# tombolo_read_suites(SOURCE FILTER SUITES): the filter for the tests of a source, and the names of its
# suites. It is an error where a test is written in a way that the filter would leave out.
function(tombolo_read_suites source filter_variable suites_variable)
  file(STRINGS ${source} test_lines REGEX "^ *(TYPED_)?TEST(_F|_P)? *\\(")
  set(patterns)
  set(suites)
  foreach(test_line ${test_lines})
    if(NOT test_line MATCHES "^ *(TYPED_TEST|TEST_P|TEST_F|TEST)\\(([A-Za-z0-9_]+),")
      message(FATAL_ERROR "${source}: the name of a suite stands on the line of its TEST: ${test_line}")
    endif()
    set(suite ${CMAKE_MATCH_2})
    list(APPEND suites ${suite})
    if(CMAKE_MATCH_1 STREQUAL "TEST_P")
      # The second is the failure that GoogleTest adds where a suite has no parameters.
      list(APPEND patterns "*/${suite}.*" "GoogleTestVerification.*<${suite}>")
    elseif(CMAKE_MATCH_1 STREQUAL "TYPED_TEST")
      list(APPEND patterns "${suite}/*.*")
    else()
      list(APPEND patterns "${suite}.*")
    endif()
  endforeach()
  if(NOT patterns)
    message(FATAL_ERROR "${source}: there is no test in it.")
  endif()
  list(REMOVE_DUPLICATES patterns)
  list(REMOVE_DUPLICATES suites)
  list(JOIN patterns ":" filter)
  set(${filter_variable} "${filter}" PARENT_SCOPE)
  set(${suites_variable} "${suites}" PARENT_SCOPE)
endfunction()

# tombolo_refuse_shared_suites(SOURCE...): an error where two sources of a program have a suite in
# common, whose tests would then run twice.
function(tombolo_refuse_shared_suites)
  foreach(source ${ARGN})
    tombolo_read_suites(${source} filter suites)
    foreach(suite ${suites})
      if(DEFINED source_of_${suite})
        message(FATAL_ERROR
          "The suite ${suite} is in two sources of one program: ${source_of_${suite}} and ${source}")
      endif()
      set(source_of_${suite} ${source})
    endforeach()
  endforeach()
endfunction()

# As a script: cmake -DSOURCES=a.cc:b.cc -P unit_suites.cmake
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  string(REPLACE ":" ";" sources "${SOURCES}")
  tombolo_refuse_shared_suites(${sources})
endif()
