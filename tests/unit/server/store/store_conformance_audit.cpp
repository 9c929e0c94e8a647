#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

AuditEntry asked_by(const std::string& name, const std::string& verb, const std::string& target) {
  AuditEntry entry;
  entry.name = name;
  entry.role = "operator";
  entry.client = name;
  entry.is_local = false;
  entry.verb = verb;
  entry.target = target;
  return entry;
}

/// The log in the order in which it was written: "verb target outcome: before -> after".
std::vector<std::string> lines_of(const Store& store) {
  std::vector<std::string> lines;
  for (const AuditEntry& entry : store.list_audit("", "", 1000).rows) {
    constexpr const char* kOutcomes[] = {"begun", "done", "refused", "failed"};
    lines.insert(lines.begin(), entry.verb + " " + entry.target + " " +
                                    kOutcomes[static_cast<int>(entry.outcome)] + ": " +
                                    entry.before + " -> " + entry.after);
  }
  return lines;
}

using Lines = std::vector<std::string>;

TEST_P(StoreConformance, AnActIsInTheAuditLogWithWhatWasBeforeAndIsAfter) {
  for (std::uint64_t number = 1; number <= 3; ++number)
    ASSERT_EQ(report(solved(number)), ReceiptStatus::Stored);
  const Distribution distribution = test::make_distribution(panda_.digest, "shelf", 7);
  store_->put_distribution(distribution);
  const std::string uuid = solved(1).report_uuid.text();
  const AuditEntry retire = asked_by("anna", "retire_path", uuid);
  const AuditEntry evict = asked_by("anna", "evict_distribution", "0707");
  const AuditEntry reset = asked_by("anna", "reset_task", "shelf");
  const AuditEntry rename = asked_by("root", "rename_robot", "panda");
  ASSERT_TRUE(store_->retire_path(solved(1).report_uuid, &retire));
  ASSERT_TRUE(store_->evict_distribution(distribution.id, &evict));
  ASSERT_TRUE(store_->reset_task("shelf", {}, &reset));
  ASSERT_TRUE(store_->rename_robot(panda_.digest, "panda_2", &rename));
  const std::string digest = panda_.digest.short_hex();
  EXPECT_EQ(
      lines_of(*store_),
      (Lines{"retire_path " + uuid + " done: task 'shelf': 3 paths -> 2 paths",
             "evict_distribution 0707 done: task 'shelf', robot " + digest + ": revision 1 -> gone",
             "reset_task shelf begun: task 'shelf': 2 paths -> ",
             "reset_task shelf done:  -> task 'shelf': 0 paths, 2 retired",
             "rename_robot panda done: 'panda' -> 'panda_2' (" + digest + ")"}));
}

TEST_P(StoreConformance, ARemovalIsInTheAuditLogOnceOrBegunAndDone) {
  constexpr std::uint64_t kManyPaths = 501;  // more than a transaction takes
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 1; number <= kManyPaths; ++number)
    attempts.push_back(solved(number));
  for (const Receipt& receipt : test::report(*store_, attempts))
    ASSERT_EQ(receipt.status, ReceiptStatus::Stored);
  const AuditEntry panda = asked_by("root", "remove_robot", "panda");
  const AuditEntry iiwa = asked_by("root", "remove_robot", "iiwa");
  ASSERT_TRUE(store_->remove_robot(panda_.digest, {}, &panda));
  ASSERT_TRUE(store_->remove_robot(iiwa_.digest, {}, &iiwa));
  const std::string of_panda = "'panda' (" + panda_.digest.short_hex() + "): ";
  EXPECT_EQ(lines_of(*store_),
            (Lines{"remove_robot panda begun: " + of_panda + "501 paths, 501 attempts -> ",
                   "remove_robot panda done: " + of_panda +
                       "1 path, 501 attempts -> removed, 501 paths retired, 0 distributions gone",
                   "remove_robot iiwa done: 'iiwa' (" + iiwa_.digest.short_hex() +
                       "): 0 paths, 0 attempts -> deleted, 0 distributions gone"}));
}

TEST_P(StoreConformance, WhatIsNotDoneLeavesNoEntryOfItsOwn) {
  const AuditEntry entry = asked_by("anna", "any", "thing");
  EXPECT_FALSE(store_->retire_path(test::id_from<Uuid>(99), &entry));
  EXPECT_FALSE(store_->reset_task("nothing", {}, &entry));
  EXPECT_FALSE(store_->rename_robot(panda_.digest, "iiwa", &entry));
  EXPECT_FALSE(store_->remove_robot(test::id_from<Digest>(99), {}, &entry));
  EXPECT_FALSE(store_->evict_distribution(test::id_from<Digest>(99), &entry));
  EXPECT_EQ(lines_of(*store_), Lines{});
}

TEST_P(StoreConformance, TheAuditLogIsListedNewestFirstPageByPageAndByName) {
  for (int number = 0; number < 5; ++number)
    store_->add_audit(asked_by(number % 2 == 0 ? "anna" : "ben", "act", std::to_string(number)));
  reopen();
  const Page<AuditEntry> first = store_->list_audit("anna", "", 2);
  ASSERT_EQ(first.rows.size(), 2U);
  EXPECT_EQ(first.rows[0].target + first.rows[1].target, "42");
  EXPECT_EQ(first.rows[0].number, 5U);
  EXPECT_FALSE(first.rows[0].is_local);
  EXPECT_GT(first.rows[0].time_ms, 1'700'000'000'000);
  const Page<AuditEntry> second = store_->list_audit("anna", first.next_cursor, 2);
  ASSERT_EQ(second.rows.size(), 1U);
  EXPECT_EQ(second.rows[0].target, "0");
  EXPECT_EQ(second.next_cursor, "");
  EXPECT_EQ(store_->list_audit("", "", 1000).rows.size(), 5U);
  EXPECT_THROW(store_->list_audit("", "robots 1", 1), Failure);
}

TEST_P(StoreConformance, LongTextsOfAnEntryAreCut) {
  AuditEntry entry = asked_by(std::string(1000, 'n'), "act", std::string(5000, 't'));
  entry.message = std::string(5000, 'm') + "\x01";
  entry.client = std::string(1000, 'c');
  store_->add_audit(entry);
  const AuditEntry kept = store_->list_audit("", "", 1).rows.at(0);
  EXPECT_EQ(kept.name.size(), kMaxWordBytes);
  EXPECT_EQ(kept.target.size(), kMaxTargetBytes);
  EXPECT_EQ(kept.message.size(), kMaxMessageBytes);
}

}  // namespace
}  // namespace kinship::store
