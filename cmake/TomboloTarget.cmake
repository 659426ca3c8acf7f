# tombolo_setup_target(TARGET): compile options that every target of the project shares.
#
# deal_ii_setup_target marks deal.II, MPI and Trilinos as system headers, and appends its own -O2
# after CMAKE_CXX_FLAGS_RELEASE; options set with target_compile_options after it come last and win.
function(tombolo_setup_target target)
  deal_ii_setup_target(${target})
  # Of the two hundred libraries behind deal.II a program loads only those that it calls.
  target_link_options(${target} PRIVATE -Wl,--as-needed)
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
    # Lines are all that reports need; more makes objects that take long to link and to load.
    target_compile_options(${target} PRIVATE -fsanitize=${TOMBOLO_SANITIZE} -fno-omit-frame-pointer -g1)
    target_link_options(${target} PRIVATE -fsanitize=${TOMBOLO_SANITIZE})
  endif()
  if(TOMBOLO_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Lets ccache see that a precompiled header is used, and which.
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  endif()
endfunction()

# tombolo_precompile_headers(TARGET [HEADER...]): the headers of deal.II that most files include,
# and HEADERs, precompiled for TARGET.
function(tombolo_precompile_headers target)
  if(TOMBOLO_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE
      <deal.II/base/function_parser.h>
      <deal.II/base/parameter_handler.h>
      <deal.II/distributed/tria.h>
      <deal.II/dofs/dof_handler.h>
      <deal.II/fe/fe_q.h>
      <deal.II/fe/fe_values.h>
      <deal.II/grid/grid_generator.h>
      <deal.II/lac/la_parallel_vector.h>
      <algorithm>
      <experimental/simd>
      <fstream>
      <functional>
      <map>
      <memory>
      <sstream>
      <string>
      <vector>
      ${ARGN})
  endif()
endfunction()
