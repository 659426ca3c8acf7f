add_test(NAME pages_have_links_that_lead_somewhere_and_short_sentences
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/pages_test.py)
list(APPEND quick_tests pages_have_links_that_lead_somewhere_and_short_sentences)
execute_process(COMMAND ${TOMBOLO_PYTHON} -c "import matplotlib, numpy, scipy, vtk"
  RESULT_VARIABLE python_packages_result OUTPUT_QUIET ERROR_QUIET)
if(python_packages_result EQUAL 0)
  add_test(NAME pages_quote_what_their_commands_print
    COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/quotes_test.py
      $<TARGET_FILE:tombolo_program> $<TARGET_FILE:strip_operators_program>)
else()
  message(STATUS "numpy, scipy, matplotlib or vtk for Python is missing: the commands of pages are not run.")
endif()
# Without blahtexml and python3-markdown, which `scripts/site` installs, a Chromium or Node.js, which `scripts/setup chromium`
# and `scripts/setup nodejs` install, these end with 77.
add_test(NAME site_is_made_of_the_pages
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/site_test.py)
add_test(NAME site_search_finds_words_of_the_trade
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/search_test.py)
add_test(NAME site_opens_in_a_browser
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/browser_test.py)
add_test(NAME formulas_of_pages_become_mathml
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/formulas_test.py)
set_tests_properties(formulas_of_pages_become_mathml site_is_made_of_the_pages site_search_finds_words_of_the_trade site_opens_in_a_browser
  PROPERTIES SKIP_RETURN_CODE 77)
