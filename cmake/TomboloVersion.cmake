# tombolo/version.h and tombolo/headers.h in the build directory. What stands in them is looked up in
# every build, but they are written only where something changed, so that only the files that include
# them are compiled again.
set(TOMBOLO_VERSION_COMMAND
  ${CMAKE_COMMAND}
  -D SOURCE_DIRECTORY=${PROJECT_SOURCE_DIR}
  -D HEADER=${PROJECT_BINARY_DIR}/include/tombolo/version.h
  -D PROJECT_VERSION=${PROJECT_VERSION}
  -D CMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
  -D TOMBOLO_ARCHITECTURE=${TOMBOLO_ARCHITECTURE}
  -P ${PROJECT_SOURCE_DIR}/cmake/write_version.cmake)
execute_process(COMMAND ${TOMBOLO_VERSION_COMMAND})
add_custom_target(tombolo_version
  COMMAND ${TOMBOLO_VERSION_COMMAND}
  BYPRODUCTS ${PROJECT_BINARY_DIR}/include/tombolo/version.h ${PROJECT_BINARY_DIR}/include/tombolo/headers.h
  COMMENT "Looking up the git hash")
