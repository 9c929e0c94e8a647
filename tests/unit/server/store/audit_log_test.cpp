#include <gtest/gtest.h>

#include <string>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::audit_log_test {
namespace {

void ignore(double) {}

/// A store in a file whose audit log has two entries.
class AuditLog : public testing::Test {
 protected:
  AuditLog() {
    const auto store = open_sqlite_store(file_);
    store->add_audit(entry("first"));
    store->add_audit(entry("second"));
  }
  static AuditEntry entry(const std::string& target) {
    AuditEntry entry;
    entry.verb = "act";
    entry.target = target;
    return entry;
  }
  /// Verbs and targets, the oldest first.
  static std::string log_of(const std::filesystem::path& file) {
    std::string log;
    for (const AuditEntry& each : open_sqlite_store(file)->list_audit("", "", 100).rows)
      log = each.verb + " " + std::filesystem::path(each.target).filename().string() + "; " + log;
    return log;
  }
  std::string refusal(const std::string& sql) const {
    Database database(file_, Access::ReadWrite);
    try {
      database.execute(sql);
    } catch (const SqliteError& error) {
      return error.what();
    }
    return {};
  }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "store.db";
  const std::filesystem::path copy_ = directory_ / "copy.db";
};

TEST_F(AuditLog, NoStatementChangesOrRemovesAnEntry) {
  const std::string values = " (1, 5, '', '', '', 1, 'act', 'forged', 2, '', '', '', 0)";
  for (const std::string& sql :
       {std::string("UPDATE audit SET target = 'forged' WHERE id = 1"),
        std::string("UPDATE OR REPLACE audit SET id = 2 WHERE id = 1"),
        std::string("DELETE FROM audit WHERE id = 2"), std::string("DELETE FROM audit"),
        "INSERT OR REPLACE INTO audit VALUES" + values, "REPLACE INTO audit VALUES" + values,
        "INSERT INTO audit VALUES" + values +
            " ON CONFLICT (id) DO UPDATE SET target = excluded.target"})
    EXPECT_NE(refusal(sql).find("the audit log is append-only"), std::string::npos) << sql;
  EXPECT_EQ(log_of(file_), "act first; act second; ");
}

TEST_F(AuditLog, ARestoreOverAStoreOfAnotherLogKeepsBoth) {
  const std::filesystem::path other = directory_ / "other.db";
  open_sqlite_store(other)->add_audit(entry("elsewhere"));
  restore_store(other, file_, ignore);
  EXPECT_EQ(log_of(file_), "act elsewhere; act first; act second; restore other.db; ");
}

TEST_F(AuditLog, ARepairKeepsItAndAddsToIt) {
  repair_store(file_, ignore);
  EXPECT_EQ(log_of(file_), "act first; act second; repair store.db; ");
}

}  // namespace
}  // namespace kinship::store::audit_log_test
