#include "server/store/sqlite/files/store_file.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "proto/types/failure.hpp"

namespace kinship::store::library_version_test {
namespace {

TEST(LibraryVersion, OfThisMachineServes) {
  EXPECT_NO_THROW(require_library(sqlite3_libversion_number()));
}

TEST(LibraryVersion, AnOlderOneIsRefusedWithBothVersions) {
  EXPECT_NO_THROW(require_library(3'037'000));
  try {
    require_library(3'034'001);
    FAIL() << "let through";
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(),
                 "SQLite 3.34.1 is older than SQLite 3.37.0, which a store needs; install a newer "
                 "libsqlite3");
  }
}

}  // namespace
}  // namespace kinship::store::library_version_test
