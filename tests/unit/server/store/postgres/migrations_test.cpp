#include "server/store/postgres/opening/migrations.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "server/store/postgres/database/postgres_error.hpp"
#include "tests/unit/server/store/postgres/empty_store.hpp"

namespace kinship::store::postgres {
namespace {

constexpr Migration kMore{2, "0002_more", "CREATE TABLE more (x bigint)"};
constexpr Migration kBroken{2, "0002_broken", "CREATE TABLE more (x bigint); CREATE nonsense"};

class PostgresMigrations : public EmptyStore {
 protected:
  std::string sql(const std::string& text) const { return test::query_postgres(url_, text); }
  static std::vector<Migration> with(const Migration& next) {
    const std::span<const Migration> known = embedded_migrations();
    std::vector<Migration> migrations(known.begin(), known.end());
    migrations.push_back(next);
    migrations.back().version = static_cast<std::int64_t>(migrations.size());
    return migrations;
  }
  static constexpr const char* kEntries =
      "SELECT verb, was, became, outcome, client LIKE 'kinshipd of user %' FROM audit";
};

TEST_F(PostgresMigrations, OfAStoreThatWasThereAreInTheAuditLogOfANewOneNot) {
  EXPECT_EQ(sql(kEntries), "");
  const std::size_t before = embedded_migrations().size();
  migrate(*connection_, with(kMore));
  EXPECT_EQ(sql(kEntries), "migrate\tschema " + std::to_string(before) + "\tschema " +
                               std::to_string(before + 1) + "\t2\tt");
  const std::string target = sql("SELECT target FROM audit");
  EXPECT_EQ(target, connection_->description());
  migrate(*connection_, with(kMore));
  EXPECT_EQ(sql("SELECT count(*) FROM audit"), "1") << "there was nothing to do";
}

TEST_F(PostgresMigrations, OneThatFailsLeavesNeitherTablesNorAnEntry) {
  EXPECT_THROW(migrate(*connection_, with(kBroken)), PostgresError);
  EXPECT_EQ(sql("SELECT count(*) FROM audit"), "0");
  EXPECT_EQ(sql("SELECT to_regclass('more') IS NULL"), "t");
  EXPECT_EQ(sql("SELECT max(version) FROM schema_migration"),
            std::to_string(embedded_migrations().size()));
}

}  // namespace
}  // namespace kinship::store::postgres
