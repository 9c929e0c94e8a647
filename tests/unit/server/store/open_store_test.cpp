#include "server/store/open_store.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "server/store/postgres/database/connection_string.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::open_store_test {
namespace {

std::string message_of(const std::string& name) {
  try {
    static_cast<void>(open_store(name, {}));
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "";
}

TEST(OpenStore, APathIsAFileAndAUrlADatabase) {
  EXPECT_EQ(*kind_of_store("fleet.db"), StoreKind::SqliteFile);
  EXPECT_EQ(*kind_of_store("/var/lib/kinship/fleet.db"), StoreKind::SqliteFile);
  EXPECT_EQ(*kind_of_store("odd:name/fleet.db"), StoreKind::SqliteFile);
  EXPECT_EQ(*kind_of_store("postgresql://db/fleet"), StoreKind::PostgresDatabase);
  EXPECT_EQ(*kind_of_store("postgres://db/fleet"), StoreKind::PostgresDatabase);
}

TEST(OpenStore, AnotherSchemeIsRefusedAndMakesNoFolder) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const std::string message = message_of("mysql://host/fleet");
  const bool is_empty = std::filesystem::is_empty(folder.path());
  std::filesystem::current_path(before);
  EXPECT_NE(message.find("'mysql://'"), std::string::npos) << message;
  EXPECT_NE(message.find("postgresql://"), std::string::npos) << message;
  EXPECT_TRUE(is_empty);
}

TEST(OpenStore, APasswordIsInNoMessage) {
  for (const char* const url : {"postgresql://kinship:se%40cret@127.0.0.1:1/fleet",
                                "postgresql://kinship@127.0.0.1:1/fleet?password=se%40cret",
                                "postgresql://kinship:se%40cret%zz@127.0.0.1:1/fleet",
                                "postgresql://kinship:se%40cret@127.0.0.1:1/fleet?nothing=known"}) {
    const std::string message = message_of(url);
    EXPECT_FALSE(message.empty()) << url;
    EXPECT_EQ(message.find("cret"), std::string::npos) << message;
    EXPECT_EQ(displayed_store(url).find("cret"), std::string::npos) << displayed_store(url);
  }
  EXPECT_EQ(displayed_store("fleet.db"), "fleet.db");
}

TEST(ConnectionString, EachHostHasItsPort) {
  const postgres::ConnectionString both("postgresql://kinship@a:1,b:2/fleet");
  EXPECT_EQ(both.description(), "postgresql://kinship@a:1,b:2/fleet");
  ASSERT_EQ(both.each_host().size(), 2U);
  EXPECT_EQ(both.each_host()[0].description(), "postgresql://kinship@a:1/fleet");
  EXPECT_EQ(both.each_host()[1].description(), "postgresql://kinship@b:2/fleet");
  const postgres::ConnectionString sockets("postgresql://kinship@/fleet?host=/a,/b&port=5432");
  EXPECT_EQ(sockets.description(), "postgresql://kinship@/a:5432,/b:5432/fleet");
  EXPECT_EQ(sockets.each_host()[1].description(), "postgresql://kinship@/b:5432/fleet");
}

TEST(ConnectionString, IsShownWithAllHostsAsAUrlHasThem) {
  for (const auto& [url, shown] : std::map<std::string, std::string>{
           {"postgres://a/fleet", "postgresql://a/fleet"},
           {"postgresql://k:secret@a,b:5433,c/fleet?sslmode=disable",
            "postgresql://k@a,b:5433,c/fleet"},
           {"postgresql://a,b/fleet?port=5433&password=secret", "postgresql://a:5433,b:5433/fleet"},
           {"postgresql://[::1]:1,[fe80::2]/fleet", "postgresql://[::1]:1,[fe80::2]/fleet"},
           {"postgresql:///fleet?hostaddr=10.0.0.1,10.0.0.2",
            "postgresql://10.0.0.1,10.0.0.2/fleet"}})
    EXPECT_EQ(displayed_store(url), shown);
}

}  // namespace
}  // namespace kinship::store::open_store_test
