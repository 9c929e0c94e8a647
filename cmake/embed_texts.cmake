# Text files as a C++ source, so that a program carries what it needs.
#
#   cmake -DOUTPUT=x.cpp -DHEADER=folder/declares.hpp -DNAMESPACE=a::b -DTYPE=Text -DFUNCTION=texts
#         [-DENTRY=<entry>] -P embed_texts.cmake -- A.sql B.js ...
#
# Writes `std::span<const TYPE> FUNCTION()` of one entry per file, in the order given. <entry> is an
# initializer of TYPE in which @NAME@, @STEM@, @NUMBER@ and @TEXT@ stand for the file's name, its
# name up to the first point, the number its name begins with, and its text as a literal; the
# default is {"@NAME@", @TEXT@}.
cmake_minimum_required(VERSION 3.25)
if(NOT ENTRY)
  set(ENTRY "{\"@NAME@\", @TEXT@}")
endif()
set(separator_seen FALSE)
set(entries "")
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(index RANGE ${last})
  set(file "${CMAKE_ARGV${index}}")
  if(NOT separator_seen)
    if(file STREQUAL "--")
      set(separator_seen TRUE)
    endif()
    continue()
  endif()
  get_filename_component(name "${file}" NAME)
  get_filename_component(stem "${file}" NAME_WE)
  set(entry "${ENTRY}")
  string(REPLACE "@NAME@" "${name}" entry "${entry}")
  string(REPLACE "@STEM@" "${stem}" entry "${entry}")
  if(ENTRY MATCHES "@NUMBER@")
    if(NOT stem MATCHES "^0*([1-9][0-9]*)_")
      message(FATAL_ERROR "${file}: must be called NNNN_name")
    endif()
    string(REPLACE "@NUMBER@" "${CMAKE_MATCH_1}" entry "${entry}")
  endif()
  file(READ "${file}" text)
  if(text MATCHES "\\)kinship_text\"")
    message(FATAL_ERROR "${file}: holds the end of a literal")
  endif()
  string(REPLACE "@TEXT@" "R\"kinship_text(${text})kinship_text\"sv" entry "${entry}")
  string(APPEND entries "    ${TYPE}${entry},\n")
endforeach()
file(WRITE "${OUTPUT}" "// Written by cmake/embed_texts.cmake while building. Do not edit.
#include <array>
#include <string_view>

#include \"${HEADER}\"

namespace ${NAMESPACE} {

using namespace std::string_view_literals;

// NOLINTNEXTLINE(readability-function-size): the texts themselves
std::span<const ${TYPE}> ${FUNCTION}() {
  static constexpr std::array kTexts = {
${entries}  };
  return kTexts;
}

}  // namespace ${NAMESPACE}
")
