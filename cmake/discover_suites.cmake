# Tells CTest the suites of a GoogleTest program, one test each: gtest_discover_tests() starts the program once for every
# TEST in it, which for fast tests takes most of the time.
#
#   cmake -DPROGRAM=x -DOUTPUT=x_tests.cmake -DTIMEOUT=180 -DLABEL=unit -P discover_suites.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+[.]" suites "${list}")
set(script "")
foreach(suite IN LISTS suites)
  string(STRIP "${suite}" suite)
  string(REGEX REPLACE "[.]$" "" suite "${suite}")
  string(APPEND script
    "add_test([=[${suite}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}.*]=])\n"
    "set_tests_properties([=[${suite}]=] PROPERTIES TIMEOUT ${TIMEOUT} LABELS ${LABEL})\n")
endforeach()
file(WRITE "${OUTPUT}" "${script}")
