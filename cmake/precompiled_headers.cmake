# Headers that most sources read, compiled once: a build takes about half the time. Sources still include what they
# use; .ci/tidy reads them without these and finds what is missing.
#
# In a release the tests have them, libraries and programs do not: behind precompiled headers GCC 12 takes the standard
# library for code of ours, and warns of it when it optimizes fully.
option(KINSHIP_PRECOMPILE "Compile the headers that most sources read once" ON)

function(kinship_is_precompiled name result)
  if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT name STREQUAL "kinship_test_headers")
    set(${result} OFF PARENT_SCOPE)
  else()
    set(${result} ${KINSHIP_PRECOMPILE} PARENT_SCOPE)
  endif()
endfunction()

# kinship_precompile(NAME HEADERS <vector> ... LINKS GTest::gtest ...)
#
# A target whose precompiled headers others take over with kinship_use_precompiled(TARGET NAME).
function(kinship_precompile name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS;LINKS")
  kinship_is_precompiled(${name} wanted)
  if(NOT wanted)
    return()
  endif()
  set(source ${CMAKE_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Carries precompiled headers.\n")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE kinship_options ${arg_LINKS})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

function(kinship_use_precompiled target name)
  kinship_is_precompiled(${name} wanted)
  if(NOT wanted)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${name})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # ccache asks for the first; who is optimized otherwise reads the headers themselves, which is no error.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess;-Wno-error=invalid-pch>)
  endif()
endfunction()

set(KINSHIP_COMMON_HEADERS
  <algorithm> <array> <chrono> <cmath> <condition_variable> <cstdint> <filesystem> <fstream> <functional> <map> <memory>
  <mutex> <optional> <random> <span> <sstream> <string> <string_view> <thread> <utility> <variant> <vector>
  <Eigen/Core> <Eigen/Geometry>)

kinship_precompile(kinship_headers HEADERS ${KINSHIP_COMMON_HEADERS} LINKS Eigen3::Eigen)
# For those that read command lines or JSON: the two largest headers of all.
kinship_precompile(kinship_text_headers HEADERS ${KINSHIP_COMMON_HEADERS} <CLI/CLI.hpp> <nlohmann/json.hpp>
  LINKS Eigen3::Eigen CLI11::CLI11 nlohmann_json::nlohmann_json)
