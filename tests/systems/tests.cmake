# What the scripts say and do on other systems, with stand-ins for what is not installed here.
add_test(NAME systems_without_what_is_needed_are_told_so
  COMMAND ${TOMBOLO_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/systems_test.py ${CMAKE_COMMAND})
