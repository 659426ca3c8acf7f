# Compiles through ccache, unless another launcher was chosen.
if(TOMBOLO_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(TOMBOLO_CCACHE_PROGRAM ccache)
  if(TOMBOLO_CCACHE_PROGRAM)
    # Base directory and "no hash of the directory" let another clone of the project profit. With a
    # precompiled header, ccache asks for the sloppiness and for -fpch-preprocess (TomboloTarget.cmake).
    set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=1
      CCACHE_SLOPPINESS=pch_defines,time_macros
      ${TOMBOLO_CCACHE_PROGRAM})
  endif()
endif()
