# tombolo_setup_target(TARGET): compile options that every target of the project shares.
#
# deal_ii_setup_target appends its own -O2 after CMAKE_CXX_FLAGS_RELEASE; options set with
# target_compile_options after it come last and win.
function(tombolo_setup_target target)
  deal_ii_setup_target(${target})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion)
  if(TOMBOLO_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    # -fno-math-errno and -fno-trapping-math let loops with sqrt and selections vectorize;
    # neither changes the value of a finite result.
    target_compile_options(${target} PRIVATE -O3 -fno-math-errno -fno-trapping-math)
    if(TOMBOLO_NATIVE)
      target_compile_options(${target} PRIVATE -march=native)
    endif()
  endif()
  if(TOMBOLO_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${TOMBOLO_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${TOMBOLO_SANITIZE})
  endif()
endfunction()
