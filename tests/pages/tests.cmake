add_test(NAME pages_have_links_that_lead_somewhere_and_short_sentences
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/pages_test.py)
list(APPEND quick_tests pages_have_links_that_lead_somewhere_and_short_sentences)
# Without python3-markdown, which `scripts/site` installs, or a Chromium, which `scripts/setup chromium`
# installs, these end with 77.
add_test(NAME site_is_made_of_the_pages
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/site_test.py)
add_test(NAME site_opens_in_a_browser
  COMMAND ${TOMBOLO_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/pages/browser_test.py)
set_tests_properties(site_is_made_of_the_pages site_opens_in_a_browser PROPERTIES SKIP_RETURN_CODE 77)
