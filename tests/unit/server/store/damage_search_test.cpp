#include "tests/support/random_values.hpp"
#include "tests/unit/server/store/store_damage.hpp"

/// The search for damage: check, scrub and repair.
namespace kinship::store::store_damage_test {
namespace {

class DamageSearch : public StoreDamage {};

// A search goes on by ids: behind the last one, whatever it has become, it has to end.
TEST_F(DamageSearch, ASearchEndsBehindARowWhoseIdIsDamaged) {
  test::RandomValues random(5);
  AuditEntry audit;
  audit.verb = "backup";
  const RobotRecord second = test::make_robot("second", 2);
  static_cast<void>(store_->register_robot(second));
  for (std::uint64_t number = 0; number < 3; ++number) {
    Attempt reported = attempt(number);
    reported.task = number == 2 ? "bin" : "shelf";
    reported.scene = random.recorded_scene();
    test::report(*store_, {reported});
    store_->add_audit(audit);
  }
  store_.reset();
  const fs::path sound = directory_ / "sound.db";
  fs::copy_file(file_, sound);
  for (const std::string table : {"task", "scene", "robot", "audit", "path", "attempt"}) {
    const std::uint64_t page = leaves_of(table).back();
    const std::uint64_t place = place_of_last_id(page);
    for (const int bit : {1, 4, 64}) {  // one is the id of another row
      SCOPED_TRACE(table + ", bit " + std::to_string(bit));
      flip(page, place, bit);
      EXPECT_GT(check().problems, 0U);
      EXPECT_NE(first_finding_of_scrub().find("table " + table + ": "), std::string::npos);
      store_.reset();
      static_cast<void>(repair_store(file_, [](double) {}));
      open();
      static_cast<void>(store_->register_robot(second));  // it may be lost
      store_.reset();
      EXPECT_EQ(check().problems, 0U) << testing::PrintToString(check().messages);
      for (const char* const sidecar : {"-wal", "-shm", ".high-water-mark"})
        fs::remove(file_.string() + sidecar);
      fs::copy_file(sound, file_, fs::copy_options::overwrite_existing);
    }
  }
}

TEST_F(DamageSearch, TheScrubFindsDamageThatNobodyReadsAndNamesIt) {
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 0; number < 100; ++number)
    attempts.push_back(attempt(number, 60));
  test::report(*store_, std::move(attempts));
  store_.reset();
  break_page(leaves_of("attempt_by_task_robot").at(0));
  const std::string words = first_finding_of_scrub();
  EXPECT_NE(words.find("table attempt: "), std::string::npos) << words;
  const StoreStatus status = store_->status();
  EXPECT_NE(status.message.find("kinshipd repair"), std::string::npos) << status.message;
  store_.reset();
}

TEST_F(DamageSearch, TheCheckNamesADamagedRowOnceInWords) {
  for (std::uint64_t number = 0; number < 200; ++number)
    test::report(*store_, {attempt(number, 60)});
  store_.reset();
  flip(leaves_of("path").at(5));
  const StoreCheck found = check();
  std::size_t named = 0;
  for (const std::string& message : found.messages) {
    named += message.ends_with(": damaged (checksum)") ? 1U : 0U;
    EXPECT_EQ(message.find("SELECT"), std::string::npos) << message;
    EXPECT_EQ(message.find("error code"), std::string::npos) << message;
  }
  EXPECT_EQ(named, 1U) << testing::PrintToString(found.messages);
}

TEST_F(DamageSearch, AStoreWithoutItsFirstPageIsRefusedAndRepaired) {
  test::report(*store_, {attempt(1)});
  store_.reset();
  break_page(1);
  const StoreCheck found = check();
  EXPECT_EQ(found.problems, 1U);
  ASSERT_EQ(found.messages.size(), 1U);
  EXPECT_NE(found.messages.at(0).find("the schema cannot be read"), std::string::npos)
      << found.messages.at(0);
  try {
    store_ = open_sqlite_store(file_);
    FAIL() << "opened";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("'kinshipd repair'"), std::string::npos)
        << failure.what();
  }
  EXPECT_EQ(repair_store(file_, [](double) {}).damaged_places, 1U);
  open();
  EXPECT_EQ(paths().size(), 1U);
  EXPECT_EQ(report(attempt(1)).status, ReceiptStatus::Duplicate);
}

/// Rows before and after, and every attempt that is missing by the UUID of its report.
void expect_account(const Repaired& repaired, const std::vector<Attempt>& attempts) {
  for (const Repaired::Table& table : repaired.tables) {
    EXPECT_EQ(table.before, table.after + table.missing.size()) << table.name;
    if (table.name != "attempt" && table.name != "path")
      continue;
    EXPECT_EQ(table.before, attempts.size()) << table.name;
    EXPECT_GT(table.missing.size(), 0U) << table.name;
    for (const Repaired::Table::Missing& row : table.missing)
      EXPECT_EQ(table.name == "attempt" ? row.report : std::nullopt,
                table.name == "attempt"
                    ? std::optional(attempts.at(static_cast<std::size_t>(row.id - 1)).report_uuid)
                    : std::nullopt);
  }
  EXPECT_EQ(repaired.tables.size(), 6U);
}

TEST_F(DamageSearch, ARepairSaysWhatIsLost) {
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 0; number < 200; ++number)
    attempts.push_back(attempt(number, 60));
  test::report(*store_, attempts);
  const Uuid epoch = store_->epoch();
  store_.reset();
  break_page(leaves_of("path").at(5));
  break_page(leaves_of("attempt").at(2));
  break_page(pages_of("robot").at(0));
  break_page(pages_of("path_by_task_robot").at(0));
  const Repaired repaired = repair_store(file_, [](double) {});
  EXPECT_EQ(repaired.damaged_places, 3U);
  EXPECT_NE(repaired.restored.epoch, epoch);
  EXPECT_TRUE(fs::exists(repaired.restored.replaced));
  const auto lost = [&](const std::string& table) {
    std::uint64_t rows = 0;
    for (const Repaired::Lost& part : repaired.lost)
      if (part.table == table && part.robot == "panda")
        rows += part.rows;
    return rows;
  };
  EXPECT_EQ(lost("robot"), 1U);
  EXPECT_GT(lost("path"), 0U);
  EXPECT_GT(lost("attempt"), 0U);
  expect_account(repaired, attempts);
  store_ = open_sqlite_store(file_);
  EXPECT_TRUE(store_->robots().empty());
  EXPECT_EQ(*store_->register_robot(robot_), RegisterStatus::Registered);
  EXPECT_EQ(paths().size(), 200 - lost("path"));
  for (const Receipt& receipt : test::report(*store_, attempts))
    EXPECT_NE(receipt.status, ReceiptStatus::TryAgain) << receipt.message;
  EXPECT_EQ(paths().size(), 200U);
  store_.reset();
  EXPECT_EQ(check().problems, 0U) << testing::PrintToString(check().messages);
}

}  // namespace
}  // namespace kinship::store::store_damage_test
