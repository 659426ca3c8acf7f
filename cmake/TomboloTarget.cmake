# tombolo_setup_target(TARGET): compile options that every target of the project shares.
#
# deal_ii_setup_target marks deal.II, MPI and Trilinos as system headers, and appends its own -O2
# after CMAKE_CXX_FLAGS_RELEASE; options set with target_compile_options after it come last and win.
function(tombolo_setup_target target)
  deal_ii_setup_target(${target})
  # Neither the C++ bindings of MPI nor automatic differentiation are used; both cost in every source.
  target_compile_definitions(${target} PRIVATE OMPI_SKIP_MPICXX)
  target_include_directories(${target} BEFORE PRIVATE ${PROJECT_SOURCE_DIR}/cmake/lean)
  # Since HDF5 1.12 some functions have one argument more by default.
  target_compile_definitions(${target} PRIVATE H5_USE_110_API)
  # Of the two hundred libraries behind deal.II a program loads only those that it calls.
  target_link_options(${target} PRIVATE -Wl,--as-needed)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion)
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC takes unnamed namespaces of sources that are compiled together for those of a header.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Without it __FILE__ has the place of the clone in it, and the compiler cache of one clone is of no use
    # for another.
    target_compile_options(${target} PRIVATE -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/= -fpch-preprocess)
  endif()
  if(TOMBOLO_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    # deal.II's flags ask for debug symbols, which cost a third of the time of a build.
    target_compile_options(${target} PRIVATE -g0)
    # -fno-math-errno and -fno-trapping-math let loops with sqrt and selections vectorize;
    # neither changes the value of a finite result.
    target_compile_options(${target} PRIVATE -O3 -fno-math-errno -fno-trapping-math)
    if(TOMBOLO_ARCHITECTURE)
      target_compile_options(${target} PRIVATE -march=${TOMBOLO_ARCHITECTURE})
    endif()
  endif()
  if(TOMBOLO_SANITIZE)
    # Lines are all that reports need; more makes objects that take long to link and to load.
    target_compile_options(${target} PRIVATE -fsanitize=${TOMBOLO_SANITIZE} -fno-omit-frame-pointer -g1)
    target_link_options(${target} PRIVATE -fsanitize=${TOMBOLO_SANITIZE})
  endif()
endfunction()

# Of code that is compiled more often than its loops matter.
set(TOMBOLO_COLD_OPTIONS
  "$<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-O1;-fno-unroll-loops;-fno-unroll-all-loops>")
# tombolo_compile_cold(TARGET): these options, and the precompiled header that was made with them. Most
# functions get the options of the header: -O1 with a header that was made with -O3 has no effect on them.
function(tombolo_compile_cold target)
  target_compile_options(${target} PRIVATE ${TOMBOLO_COLD_OPTIONS})
  set_target_properties(${target} PROPERTIES DEFINE_SYMBOL "")
  target_precompile_headers(${target} REUSE_FROM tombolo)
endfunction()
