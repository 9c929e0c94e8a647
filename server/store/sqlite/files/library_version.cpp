#include "server/store/sqlite/files/library_version.hpp"

#include "proto/types/failure.hpp"

namespace kinship::store {
namespace {

std::string version_text(int number) {
  return "SQLite " + std::to_string(number / 1'000'000) + '.' +
         std::to_string(number / 1000 % 1000) + '.' + std::to_string(number % 1000);
}

}  // namespace

void require_library(int number) {
  if (number < kOldestSqlite)
    throw Failure(ErrorCode::Storage, version_text(number) + " is older than " +
                                          version_text(kOldestSqlite) +
                                          ", which a store needs; install a newer libsqlite3");
}

std::string library_advice(int number) {
  constexpr int kFixed = 3'051'003;
  return number < kFixed ? version_text(number) +
                               " is older than 3.51.3: no other program may write to the store"
                         : "";
}

}  // namespace kinship::store
