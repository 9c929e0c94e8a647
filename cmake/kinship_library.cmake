# What every library, program and test of Kinship is built with.

add_library(kinship_options INTERFACE)
target_include_directories(kinship_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(kinship_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  -Wold-style-cast -Werror>)
# GCC 12 warns of impossible overlaps inside "text" + std::string when it optimizes (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(kinship_options INTERFACE
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<CONFIG:Debug>>>:-Wno-restrict>)
endif()
# Threads touch Eigen only through values; its own OpenMP pool would break "same bytes for any number of threads".
target_compile_definitions(kinship_options INTERFACE EIGEN_DONT_PARALLELIZE)
if(KINSHIP_SANITIZE)
  target_compile_options(kinship_options INTERFACE -fsanitize=${KINSHIP_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(kinship_options INTERFACE -fsanitize=${KINSHIP_SANITIZE})
endif()

# kinship_library(NAME SOURCES a.cpp ... DEPENDS kinship::types ... PRIVATE_DEPENDS Some::Library ...)
#
# One static library per folder, alias kinship::NAME. DEPENDS are seen by users of the headers,
# PRIVATE_DEPENDS only by the sources. Without SOURCES the library consists of headers.
function(kinship_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS")
  if(arg_SOURCES)
    add_library(kinship_${name} STATIC ${arg_SOURCES})
    target_link_libraries(kinship_${name} PUBLIC kinship_options ${arg_DEPENDS}
                          PRIVATE ${arg_PRIVATE_DEPENDS})
  else()
    add_library(kinship_${name} INTERFACE)
    target_link_libraries(kinship_${name} INTERFACE kinship_options ${arg_DEPENDS})
  endif()
  add_library(kinship::${name} ALIAS kinship_${name})
endfunction()

# kinship_program(NAME SOURCES main.cpp DEPENDS kinship::app ...)
function(kinship_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE kinship_options ${arg_DEPENDS})
endfunction()

# kinship_test(NAME SOURCES a_test.cpp ... DEPENDS kinship::types ... LABEL unit [TIMEOUT 60])
#
# One GoogleTest program; every TEST of it is a test of CTest. LABEL: unit, threads (unit tests that
# ThreadSanitizer runs too), property, integration, story, faults, golden, architecture.
function(kinship_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;TIMEOUT" "SOURCES;DEPENDS")
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE kinship_options ${arg_DEPENDS} GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    KINSHIP_SOURCE_DIR="${PROJECT_SOURCE_DIR}" KINSHIP_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  include(GoogleTest)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES
    PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS ${arg_LABEL})
endfunction()
