# cmake -DOUTPUT=x.cpp -P embed_migrations.cmake -- A.sql B.sql ...
# Writes the texts of the migrations into a C++ source, so that a server carries its schema.
set(separator_seen FALSE)
set(entries "")
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(index RANGE ${last})
  set(argument "${CMAKE_ARGV${index}}")
  if(separator_seen)
    get_filename_component(name "${argument}" NAME_WE)
    if(NOT name MATCHES "^0*([1-9][0-9]*)_")
      message(FATAL_ERROR "${argument}: a migration is called NNNN_name.sql")
    endif()
    set(version ${CMAKE_MATCH_1})
    file(READ "${argument}" text)
    string(APPEND entries "    Migration{${version}, \"${name}\", R\"kinship_sql(${text})kinship_sql\"},\n")
  elseif(argument STREQUAL "--")
    set(separator_seen TRUE)
  endif()
endforeach()
file(WRITE "${OUTPUT}" "// Written by server/store/embed_migrations.cmake from schema/. Do not edit.
#include <array>

#include \"server/store/sqlite/migrations.hpp\"

namespace kinship::store {

std::span<const Migration> embedded_migrations() {
  static constexpr std::array kMigrations = {
${entries}  };
  return kMigrations;
}

}  // namespace kinship::store
")
