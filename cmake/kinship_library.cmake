# What every library, program and test of Kinship is built with. Warnings are errors for who develops, not for who
# builds a release with another compiler.

include(GNUInstallDirs)
set(KINSHIP_INCLUDEDIR ${CMAKE_INSTALL_INCLUDEDIR}/kinship-${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(KINSHIP_CMAKEDIR ${CMAKE_INSTALL_LIBDIR}/cmake/Kinship)

# What our own sources are compiled with, and who builds Kinship within another project is spared.
add_library(kinship_warnings INTERFACE)
target_compile_options(kinship_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  -Wold-style-cast $<$<CONFIG:Debug>:-Werror>>)
# GCC 12 warns of impossible overlaps and sizes inside "text" + std::string when it optimizes (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(kinship_warnings INTERFACE
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<CONFIG:Debug>>>:-Wno-restrict -Wno-stringop-overflow>)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 14 warns of impossible sizes, too, and of members that a designated initializer leaves at their defaults.
  target_compile_options(kinship_warnings INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-missing-field-initializers $<$<NOT:$<CONFIG:Debug>>:-Wno-stringop-overflow>>)
endif()

# What also its users are compiled with.
add_library(kinship_options INTERFACE)
# The compiler's own memory: collecting its garbage early costs a tenth of a build.
target_compile_options(kinship_options INTERFACE
  $<BUILD_INTERFACE:$<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288>>)
if(KINSHIP_CCACHE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # So that the cache sees which precompiled header a preprocessed text goes with.
  target_compile_options(kinship_options INTERFACE $<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>>)
endif()
target_include_directories(kinship_options INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                           $<INSTALL_INTERFACE:${KINSHIP_INCLUDEDIR}>)
# Threads touch Eigen only through values; its own OpenMP pool would break "same bytes for any number of threads".
target_compile_definitions(kinship_options INTERFACE EIGEN_DONT_PARALLELIZE)
if(KINSHIP_SANITIZE)
  # Without the four checks that double the time of a build; what matters of them AddressSanitizer sees too.
  target_compile_options(kinship_options INTERFACE -fsanitize=${KINSHIP_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all -fno-sanitize=null,alignment,vptr,object-size)
  target_link_options(kinship_options INTERFACE -fsanitize=${KINSHIP_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    file(RELATIVE_PATH ignored ${CMAKE_BINARY_DIR} ${PROJECT_SOURCE_DIR}/tests/ubsan_ignore.txt)  # the same in every clone
    target_compile_options(kinship_options INTERFACE -fsanitize-ignorelist=${ignored})
    # GCC's names of what is on, which Clang lacks.
    string(REGEX MATCH "address|thread" sanitizer ${KINSHIP_SANITIZE})
    string(TOUPPER "__SANITIZE_${sanitizer}__" sanitizer)
    target_compile_definitions(kinship_options INTERFACE ${sanitizer})
  endif()
  # Under AddressSanitizer Eigen aligns memory by itself, and OMPL's library, which does not, then frees it.
  target_compile_definitions(kinship_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

# A quarter of all lines are includes, and most of a compilation is reading them: several sources of a target compile as
# one, behind one precompiled header. So names in the anonymous namespaces of a library must differ. Sources with options of
# their own (kernels) compile alone. Turned off, each source compiles by itself and shows what it forgot to include.
option(KINSHIP_UNITY "Compile the sources of a target together, behind a precompiled header" ON)
function(kinship_unite target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${KINSHIP_UNITY} UNITY_BUILD_BATCH_SIZE 16)
  if(KINSHIP_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # A source is an include there, and its anonymous namespaces look like a header's.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  endif()
endfunction()

# kinship_precompile(TARGET OWNER): TARGET reads what nearly every source includes from the precompiled header of OWNER, which
# is compiled with the same options; the owner itself is given further HEADERS.
function(kinship_precompile target owner)
  get_target_property(sources ${target} SOURCES)
  if(NOT KINSHIP_UNITY OR CMAKE_BUILD_TYPE STREQUAL "Debug" OR sources MATCHES "[.]c(;|$)")
    return()  # in a debug build some libraries are optimized and others not; a header of C++ is none of C
  elseif(NOT target STREQUAL owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
    return()
  endif()
  target_precompile_headers(${target} PRIVATE
    <Eigen/Cholesky> <Eigen/Geometry>
    <algorithm> <array> <atomic> <chrono> <cmath> <condition_variable> <filesystem> <fstream> <functional> <iostream> <map>
    <memory> <mutex> <numbers> <optional> <random> <set> <span> <sstream> <string> <thread> <unordered_map> <variant> <vector>
    <proto/types/conversations.hpp> <proto/types/problem.hpp> ${ARGN})
endfunction()

# kinship_kernels(SOURCES a.cpp ... OPTIONS -mavx2 ...): sources that are compiled with options of their own, each by itself:
# code with wider registers must meet no other (alignment).
function(kinship_kernels)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "SOURCES;OPTIONS")
  if(KINSHIP_SANITIZE)
    list(TRANSFORM arg_OPTIONS REPLACE "^-O3$" -O1)  # takes minutes where every access is checked
  endif()
  set_source_files_properties(${arg_SOURCES} PROPERTIES COMPILE_OPTIONS "${arg_OPTIONS}" SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# What is compiled at -O1 behind a precompiled header of -O3: GCC 13 and later want it with the settings that differ then, on x86.
set(KINSHIP_LIGHTLY -O1)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13 AND
   CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  list(APPEND KINSHIP_LIGHTLY -munroll-only-small-loops -mvzeroupper)
endif()

# Archives go into shared libraries too, ours (C, Python) and others' (plug-ins), and are not seen through them.
function(kinship_hide target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON C_VISIBILITY_PRESET hidden
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# kinship_library(NAME [COMPUTES] SOURCES a.cpp ... DEPENDS kinship::types ... PRIVATE_DEPENDS Some::Library ...)
#
# One static library per folder, alias kinship::NAME. DEPENDS are seen by users of the headers,
# PRIVATE_DEPENDS only by the sources. Without SOURCES the library consists of headers. A release optimizes what COMPUTES
# fully, sanitizers a little; what waits for disks, networks and people is compiled in half the time at -O1, or not optimized.
function(kinship_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "COMPUTES" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS")
  if(arg_SOURCES)
    add_library(kinship_${name} STATIC ${arg_SOURCES})
    target_link_libraries(kinship_${name} PRIVATE $<BUILD_INTERFACE:kinship_warnings>
                          PUBLIC kinship_options ${arg_DEPENDS} PRIVATE ${arg_PRIVATE_DEPENDS})
    kinship_hide(kinship_${name})
    kinship_unite(kinship_${name})
    if(KINSHIP_SANITIZE AND arg_COMPUTES AND NOT name STREQUAL "types")
      target_compile_options(kinship_${name} PRIVATE -O1)  # unlike the precompiled header
    else()
      kinship_precompile(kinship_${name} kinship_types)
    endif()
    if(NOT arg_COMPUTES)
      target_compile_options(kinship_${name} PRIVATE "$<$<CONFIG:Release>:${KINSHIP_LIGHTLY}>")
    endif()
  else()
    add_library(kinship_${name} INTERFACE)
    target_link_libraries(kinship_${name} INTERFACE kinship_options ${arg_DEPENDS})
  endif()
  add_library(kinship::${name} ALIAS kinship_${name})
endfunction()

# kinship_embed_texts(VARIABLE header.hpp kinship::name FUNCTION FILE ...)
#
# Sets VARIABLE to a source that defines `std::span<const page::EmbeddedText> kinship::name::FUNCTION()`, which header.hpp
# declares: the files of a page (pages/page), carried by the program that writes it.
function(kinship_embed_texts variable header namespace function)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${source} -DHEADER=${header} -DNAMESPACE=${namespace}
            -DTYPE=kinship::page::EmbeddedText -DFUNCTION=${function}
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_texts.cmake -- ${ARGN}
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed_texts.cmake
    VERBATIM)
  set(${variable} ${source} PARENT_SCOPE)
endfunction()

# kinship_program(NAME SOURCES main.cpp DEPENDS kinship::app ...)
function(kinship_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE kinship_warnings kinship_options ${arg_DEPENDS})
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  kinship_unite(${name})
endfunction()

# Tells CTest the suites of a GoogleTest program, one test each, or that the program is not built (NAME_NOT_BUILT).
function(kinship_discover_suites name timeout label)
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${name}> -DOUTPUT=${suites} -DTIMEOUT=${timeout} -DLABEL=${label}
      -P ${PROJECT_SOURCE_DIR}/cmake/discover_suites.cmake
    BYPRODUCTS ${suites} VERBATIM)
  set(include ${CMAKE_CURRENT_BINARY_DIR}/${name}_include.cmake)
  file(CONFIGURE OUTPUT ${include} CONTENT
    "if(EXISTS [=[${suites}]=])\n  include([=[${suites}]=])\nelse()\n  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include})
endfunction()

# kinship_test(NAME SOURCES a_test.cpp ... DEPENDS kinship::types ... LABEL unit [TIMEOUT 60] [SERIAL *Suite*])
#
# One GoogleTest program. Each suite of it is a test of CTest; where a TEST takes seconds (labels property, integration,
# untrusted, faults, story) each TEST is, so that they go side by side. LABEL: unit, threads (unit tests that
# ThreadSanitizer runs too), property, integration, untrusted (integration tests of what strangers send, which
# AddressSanitizer runs too), story, faults, golden, architecture. The target tests_LABEL builds all programs of a label. TIMEOUT in seconds is meant for an idle machine: sanitizers get five times that.
# SERIAL: which TESTs run alone, where each is a test.
function(kinship_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;TIMEOUT;SERIAL" "SOURCES;DEPENDS")
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 180)
  endif()
  if(KINSHIP_SANITIZE)
    math(EXPR arg_TIMEOUT "5 * ${arg_TIMEOUT}")
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE kinship_warnings kinship_options ${arg_DEPENDS} kinship::test_places
                        GTest::gtest GTest::gtest_main)
  # What is tested is fully optimized, the tests themselves need not be: a third of their build time.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  kinship_unite(${name})
  if(KINSHIP_SANITIZE AND arg_LABEL STREQUAL "property")
    target_compile_options(${name} PRIVATE -O1)  # they compute for long; unlike the precompiled header
  else()
    kinship_precompile(${name} kinship_test_places)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(NOT TARGET tests_${arg_LABEL})
    add_custom_target(tests_${arg_LABEL})
  endif()
  add_dependencies(tests_${arg_LABEL} ${name})
  if(arg_LABEL MATCHES "^(property|integration|untrusted|faults|story)$")
    include(GoogleTest)
    if(arg_SERIAL)
      set(others TEST_FILTER "-${arg_SERIAL}")
      gtest_discover_tests(${name} TEST_FILTER ${arg_SERIAL} TEST_LIST ${name}_serial DISCOVERY_TIMEOUT 300 NO_PRETTY_VALUES
        PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS ${arg_LABEL} RUN_SERIAL TRUE)
    endif()
    gtest_discover_tests(${name} ${others} DISCOVERY_TIMEOUT 300 NO_PRETTY_VALUES
      PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS ${arg_LABEL})
  else()
    kinship_discover_suites(${name} ${arg_TIMEOUT} ${arg_LABEL})
  endif()
endfunction()
