# kinship_python_test(NAME FILE LABEL): a file of unittest tests over `import kinship`, one test of CTest. It finds programs
# and sources by KINSHIP_BIN_DIR and KINSHIP_SOURCE_DIR, and modules of tests/support by their names.
function(kinship_python_test name file label)
  add_test(NAME ${name} COMMAND ${KINSHIP_PYTHON_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 300 ENVIRONMENT
    "PYTHONPATH=${CMAKE_BINARY_DIR}/python:${PROJECT_SOURCE_DIR}/tests/support;KINSHIP_BIN_DIR=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};KINSHIP_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
endfunction()

# kinship_needs_packages(NAME): the Debian packages of this build are made before that test, once for all such tests; it finds
# them by KINSHIP_PACKAGES_DIR. They are hardly compressed: nobody keeps them.
function(kinship_needs_packages name)
  set(packages ${CMAKE_BINARY_DIR}/tests/packages)
  get_property(is_there GLOBAL PROPERTY KINSHIP_PACKS_FOR_TESTS)  # names of tests are known in their folder alone
  if(NOT is_there)
    set_property(GLOBAL PROPERTY KINSHIP_PACKS_FOR_TESTS TRUE)
    add_test(NAME packages_of_this_build COMMAND ${CMAKE_COMMAND} -E env DPKG_DEB_COMPRESSOR_TYPE=gzip DPKG_DEB_COMPRESSOR_LEVEL=1
             ${PROJECT_SOURCE_DIR}/deploy/package --from ${CMAKE_BINARY_DIR} --into ${packages})
    set_tests_properties(packages_of_this_build PROPERTIES LABELS story TIMEOUT 300 FIXTURES_SETUP packages)
  endif()
  set_tests_properties(${name} PROPERTIES FIXTURES_REQUIRED packages)
  set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT "KINSHIP_PACKAGES_DIR=${packages}")
endfunction()

# kinship_browser_test(NAME FILE): a file of unittest tests that look at pages in headless Chromium (tests/support/browser.py),
# with Debian's Python; one test of CTest, label story. Not beside sanitizers, which would watch a browser.
function(kinship_browser_test name file)
  if(KINSHIP_SANITIZE)
    return()
  endif()
  add_test(NAME ${name} COMMAND /usr/bin/python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  set_tests_properties(${name} PROPERTIES LABELS story TIMEOUT 600 ENVIRONMENT
    "PYTHONPATH=${PROJECT_SOURCE_DIR}/tests/support;KINSHIP_BIN_DIR=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};KINSHIP_TESTS_DIR=${CMAKE_BINARY_DIR}/tests;KINSHIP_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
endfunction()
