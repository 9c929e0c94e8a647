// An outbox whose server has another store than before: what is sent to it, and what is kept.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>
#include <set>
#include <utility>

#include "client/link/durable_file.hpp"
#include "client/link/report_sender.hpp"
#include "proto/files/lock_file.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/store_epoch.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/client/link/another_user.hpp"

namespace kinship::link::other_stores_test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
constexpr std::uint64_t kSeed = 36;
const ConsistencyToken kToken(40, 0xab);

class OtherStoresTest : public testing::Test {
 protected:
  void SetUp() override { open(Resend::Unacknowledged); }
  void open(Resend resend) { outbox.emplace(folder.path(), resend); }
  Uuid add() {
    const Attempt attempt = values.attempt(5);
    outbox->add(attempt);
    return attempt.report_uuid;
  }
  Uuid send() {
    const Uuid uuid = add();
    outbox->mark_sent(uuid);
    return uuid;
  }
  /// Two reports that the first store acknowledged, the older one in `sent_before`.
  void acknowledge_two() {
    outbox->note_store(first, kToken);
    older = send();
    outbox->age(24h * 7);
    newer = send();
  }
  bool is_in(const char* part, const Uuid& uuid) const {
    return fs::exists(folder.path() / part / (uuid.text() + ".json"));
  }
  std::set<Uuid> pending() const {
    const std::vector<Uuid> uuids = outbox->pending();
    return {uuids.begin(), uuids.end()};
  }
  std::size_t kept() const {
    std::size_t count = 0;
    for (const KeptReports& each : outbox->kept_of_older_stores())
      count += each.reports;
    return count;
  }

  test::TemporaryDirectory folder;
  test::RandomValues values{kSeed};
  std::optional<Outbox> outbox;
  const Uuid first = next_epoch({}), second = next_epoch({});
  Uuid older, newer;
};

TEST_F(OtherStoresTest, AnEpochNamesItsStore) {
  EXPECT_TRUE(is_same_store(first, next_epoch(first)));
  EXPECT_NE(first, next_epoch(first));
  EXPECT_FALSE(is_same_store(first, second));
  EXPECT_EQ(store_name(next_epoch(first)), first.text().substr(0, 13));
}

TEST_F(OtherStoresTest, AStoreNeverSeenGetsWhatNoStoreHasAcknowledged) {
  acknowledge_two();
  const Uuid waits = add();
  EXPECT_FALSE(outbox->note_store(second, {}));
  EXPECT_EQ(pending(), std::set{waits});
  EXPECT_TRUE(outbox->known_token().empty()) << "of the other store";
  const auto kept = Outbox(folder.path()).kept_of_older_stores();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].store, store_name(first));
  EXPECT_EQ(kept[0].reports, 2U);
  EXPECT_NE(describe(kept).find("2 reports of an older store (" + store_name(first) + ")"),
            std::string::npos)
      << describe(kept);
  EXPECT_FALSE(outbox->note_store(next_epoch(second), {})) << "nothing of it was acknowledged";
  EXPECT_EQ(pending(), std::set{waits});
}

TEST_F(OtherStoresTest, AStoreThatComesBackAsItWasHasItsReports) {
  acknowledge_two();
  outbox->note_store(second, {});
  const Uuid of_second = send();
  EXPECT_FALSE(outbox->note_store(first, {}));
  EXPECT_TRUE(pending().empty());
  EXPECT_TRUE(is_in("sent", older));
  EXPECT_TRUE(is_in("sent", newer));
  EXPECT_FALSE(is_in("sent", of_second));
  EXPECT_EQ(outbox->known_token(), kToken);
  EXPECT_EQ(kept(), 1U);
}

TEST_F(OtherStoresTest, AStoreThatComesBackPutBackGetsWhatItAcknowledged) {
  acknowledge_two();
  outbox->note_store(second, {});
  send();
  EXPECT_TRUE(outbox->note_store(next_epoch(first), {}));
  EXPECT_EQ(pending(), (std::set{older, newer}));
}

TEST_F(OtherStoresTest, AllAreSentOnDemandAlsoLater) {
  acknowledge_two();
  outbox->note_store(second, {});
  EXPECT_EQ(kept(), 2U);
  open(Resend::All);
  EXPECT_TRUE(outbox->note_store(second, {}));
  EXPECT_EQ(pending(), (std::set{older, newer}));
  EXPECT_EQ(kept(), 0U);
}

TEST_F(OtherStoresTest, NoneOfThoseBeforeAreSentOnDemand) {
  acknowledge_two();
  const Uuid waited = add();
  open(Resend::None);
  EXPECT_TRUE(outbox->holds_back());
  const Uuid now = add();
  // Clocks of files are coarse, and those of robots are put right while they run.
  fs::last_write_time(folder.path() / "pending" / (now.text() + ".json"),
                      fs::file_time_type::clock::now() - 1h);
  EXPECT_FALSE(outbox->note_store(second, {}));
  EXPECT_EQ(pending(), std::set{now});
  EXPECT_EQ(kept(), 3U);
  outbox->age(24h * 7);
  outbox->age(24h * 7);
  EXPECT_EQ(kept(), 1U) << "what no store has acknowledged is kept for good";
  outbox->note_store(first, {});
  EXPECT_EQ(pending(), (std::set{now, waited}));
}

TEST_F(OtherStoresTest, AllThatIsAcknowledgedCanBeSentAgainOrDeleted) {
  acknowledge_two();
  EXPECT_EQ(outbox->resend_acknowledged(), 2U) << "of the store that it has";
  outbox->mark_sent(older);
  outbox->mark_sent(newer);
  outbox->note_store(second, {});
  EXPECT_EQ(outbox->resend_acknowledged(), 2U) << "of an older one";
  outbox->mark_sent(older);
  outbox->note_store(next_epoch({}), {});
  EXPECT_EQ(outbox->drop_of_older_stores(outbox->kept_of_older_stores()), 1U);
  EXPECT_EQ(outbox->resend_acknowledged(), 0U);
  EXPECT_EQ(pending(), std::set{newer});
}

TEST_F(OtherStoresTest, ADeletionIsOfTheStoresThatWereListedAndLeavesWhatNoneAcknowledged) {
  acknowledge_two();
  outbox->note_store(second, {});
  const auto listed = outbox->kept_of_older_stores();
  send();
  const Uuid put_away = add();
  outbox->set_aside(put_away, "a constraint");
  outbox->note_store(next_epoch({}), {});
  EXPECT_EQ(kept(), 3U);
  EXPECT_EQ(outbox->drop_of_older_stores(listed), 2U);
  ASSERT_EQ(outbox->kept_of_older_stores().size(), 1U);
  EXPECT_EQ(outbox->kept_of_older_stores()[0].store, store_name(second));
  EXPECT_EQ(outbox->reports_set_aside(), std::vector{put_away});
  EXPECT_EQ(outbox->drop_of_older_stores(listed), 0U) << "twice";
}

TEST_F(OtherStoresTest, NothingIsDeletedWhileAProcessSends) {
  acknowledge_two();
  outbox->note_store(second, {});
  const auto lock = files::LockFile::try_acquire(folder.path() / "sender.lock", 0644);
  ASSERT_TRUE(lock);
  try {
    outbox->drop_of_older_stores(outbox->kept_of_older_stores());
    ADD_FAILURE() << "deleted";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.error().code, ErrorCode::Unavailable);
    EXPECT_NE(failure.error().message.find("process " + std::to_string(getpid()) + " sends"),
              std::string::npos)
        << failure.what();
  }
  EXPECT_EQ(kept(), 2U);
}

/// Everything in `folder` may be changed by every user, but what is in `locked`.
void lock_folder(const fs::path& folder, const fs::path& locked) {
  constexpr fs::perms kWritten =
      fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  fs::permissions(folder, fs::perms::all);
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    fs::permissions(entry.path(), fs::perms::all);
  fs::permissions(locked, kWritten, fs::perm_options::remove);
}

TEST_F(OtherStoresTest, WhatCannotBeDeletedIsToldAndStaysListed) {
  acknowledge_two();
  outbox->note_store(second, {});
  const auto listed = outbox->kept_of_older_stores();
  const fs::path away = folder.path() / "other_stores" / store_name(first);
  lock_folder(folder.path(), away / "sent");
  std::string said;
  {
    const AnotherUser user;
    if (AnotherUser::is_root())
      GTEST_SKIP() << "root that must not become another user";
    try {
      outbox->drop_of_older_stores(listed);
    } catch (const Failure& failure) {
      said = failure.what();
    }
  }
  EXPECT_EQ(said, (away / "sent").string() + ": cannot be deleted: Permission denied");
  ASSERT_EQ(outbox->kept_of_older_stores().size(), 1U) << "by its epoch, which goes last";
  lock_folder(folder.path(), folder.path() / "sent");
  EXPECT_GE(outbox->drop_of_older_stores(listed), 1U);
  EXPECT_FALSE(fs::exists(away));
}

TEST_F(OtherStoresTest, AFolderThatIsEmptiedButStaysIsToldAndHoldsUpNoReport) {
  acknowledge_two();
  for (const Uuid& epoch : {second, first, second})
    outbox->note_store(epoch, {});
  const fs::path others = folder.path() / "other_stores";
  lock_folder(folder.path(), others);
  std::string said;
  {
    const AnotherUser user;
    if (AnotherUser::is_root())
      GTEST_SKIP() << "root that must not become another user";
    outbox->note_store(first, {});
    EXPECT_TRUE(is_in("sent", older) && is_in("sent", newer));
    try {
      outbox->age(0s);
    } catch (const Failure& failure) {
      said = failure.what();
    }
  }
  EXPECT_NE(said.find(": cannot be deleted: Permission denied"), std::string::npos) << said;
}

TEST_F(OtherStoresTest, ReportsOfOlderStoresAge) {
  acknowledge_two();
  outbox->note_store(second, {});
  outbox->age(24h * 7 - 1s);
  EXPECT_EQ(kept(), 2U);
  outbox->age(1s);
  outbox->age(24h * 7);
  EXPECT_EQ(kept(), 0U);
  EXPECT_TRUE(fs::is_empty(folder.path() / "other_stores")) << "a store is forgotten then";
}

TEST_F(OtherStoresTest, WhoIsKilledAmidAChangeOfStoresLosesNothing) {
  acknowledge_two();
  const std::string epoch = read_file(folder.path() / "store_epoch", 100);
  outbox->note_store(second, {});
  const Uuid of_second = send();
  // As killed before the epoch was written, with a report that was moved and one that was not.
  write_durably(folder.path() / "store_epoch", epoch);
  const fs::path away = folder.path() / "other_stores" / store_name(first);
  fs::rename(folder.path() / "sent" / (of_second.text() + ".json"), folder.path() / "gone");
  fs::rename(away / "sent" / (older.text() + ".json"),
             folder.path() / "sent" / (older.text() + ".json"));
  EXPECT_FALSE(outbox->note_store(second, {}));
  EXPECT_EQ(kept(), 2U);
  // As killed after the epoch was written, before they were brought back.
  write_durably(folder.path() / "store_epoch", epoch);
  EXPECT_FALSE(outbox->note_store(first, {}));
  EXPECT_EQ(kept(), 0U);
  EXPECT_TRUE(is_in("sent", older) && is_in("sent", newer));
}

TEST_F(OtherStoresTest, NothingIsSentBeforeTheStoreIsKnownIfNoneIsToBeSent) {
  acknowledge_two();
  const Uuid waited = add();
  open(Resend::None);
  std::mutex mutex;
  std::vector<std::size_t> sizes;
  std::set<Uuid> received;
  ReportSender sender(*outbox, [&](const ReportRequest& batch) {
    const std::lock_guard lock(mutex);
    ReportReply reply{second, {}};
    sizes.push_back(batch.attempts.size());
    for (const Attempt& attempt : batch.attempts) {
      received.insert(attempt.report_uuid);
      reply.receipts.push_back({attempt.report_uuid, ReceiptStatus::Stored, ""});
    }
    return reply;
  });
  const Uuid now = add();
  sender.wake();
  sender.wait_until_empty(std::chrono::steady_clock::now() + 20s);
  const std::lock_guard lock(mutex);
  EXPECT_EQ(sizes.at(0), 0U);
  EXPECT_EQ(received, std::set{now}) << "and not " << waited.text();
}

TEST_F(OtherStoresTest, WhyTheStoreIsNotKnownIsTold) {
  acknowledge_two();
  add();
  ReportReply refusal;
  refusal.message = "the batch cannot be read";
  for (const auto& [reply, why] : std::vector<std::pair<Result<ReportReply>, std::string>>{
           {Error{ErrorCode::Unavailable, "no server"}, "no server"},
           {refusal, refusal.message},
           {ReportReply{}, "the server does not say which store it has"}}) {
    open(Resend::None);
    std::atomic<int> calls = 0;
    std::promise<void> called_twice;
    ReportSender sender(*outbox, [&, answer = reply](const ReportRequest&) {
      if (++calls == 2)
        called_twice.set_value();
      return answer;
    });
    called_twice.get_future().wait();
    EXPECT_EQ(sender.counts().problem, why);
  }
}

TEST_F(OtherStoresTest, WhyTheStoreWasNotKnownIsForgottenOnceItIs) {
  acknowledge_two();
  open(Resend::None);
  std::atomic<int> calls = 0;
  std::promise<void> called_thrice;
  ReportSender sender(
      *outbox,
      [&](const ReportRequest&) -> Result<ReportReply> {
        if (++calls == 3)
          called_thrice.set_value();
        if (calls == 1)
          return Error{ErrorCode::Unavailable, "no server"};
        return ReportReply{second, {}};
      },
      {}, [] { return std::chrono::steady_clock::now(); },
      [&] { return static_cast<std::uint64_t>(calls.load()); });  // one more server each time
  called_thrice.get_future().wait();
  EXPECT_EQ(sender.counts().problem, "");
}

}  // namespace
}  // namespace kinship::link::other_stores_test
