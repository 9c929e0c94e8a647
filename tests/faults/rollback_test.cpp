// A store that was put back to an earlier state under a running fleet: clients that do not report
// any more offer again what it lost, and it ends with every acknowledged report, once.

#include <csignal>
#include <fstream>
#include <map>

#include "tests/faults/reporting_fleet.hpp"

namespace kinship::rollback_test {
namespace {

namespace fs = std::filesystem;

class Rollback : public test::ReportingFleet {
 protected:
  /// Five reports that every snapshot has, of a client that is not there any more.
  void SetUp() override {
    start_server();
    register_panda("early");
    report("early", 0, 5)->kill();
    register_panda("idle");
  }
  /// Reports and stays, idle, once it has its receipts.
  std::unique_ptr<test::ChildProcess> report(const std::string& outbox, std::uint64_t first,
                                             std::uint64_t count) {
    auto client = start_client(outbox, first, count);
    EXPECT_TRUE(read_ledger(*client));
    return client;
  }
  std::map<std::string, std::string> snapshot() {
    EXPECT_EQ(server_->terminate(), 0);
    server_.reset();
    std::map<std::string, std::string> files;
    for (const char* const suffix : {"", ".high-water-mark"})
      files[suffix] = test::read_text(store_.string() + suffix);
    return files;
  }
  /// Over the same inodes, as the machine's disk would be.
  void put_back(const std::string& suffix, const std::string& bytes) const {
    fs::remove(store_.string() + "-wal");
    fs::remove(store_.string() + "-shm");
    std::ofstream(store_.string() + suffix, std::ios::binary | std::ios::trunc) << bytes;
  }
  void expect_all_again(std::uint64_t attempts) {
    const ServerStatus status =
        wait_for([&](const ServerStatus& s) { return s.attempts == attempts; });
    EXPECT_EQ(status.attempts, attempts);
    EXPECT_EQ(status.rollbacks, 1U);
    EXPECT_NE(status.storage_message.find("rolled back"), std::string::npos);
  }
};

TEST_F(Rollback, CopyThatIsServedIsNoticedByTheServerAndFilledUpByAnIdleClient) {
  const fs::path copy = directory_ / "copy.db";
  std::ofstream(copy, std::ios::binary) << snapshot().at("");
  start_server();
  const auto idle = report("idle", 100, 7);
  kill_server();
  start_server(copy);
  EXPECT_EQ(status().rollbacks, 1U);
  expect_all_again(12);
  EXPECT_EQ(expect_ledger_in(copy), 12U);
}

TEST_F(Rollback, FileThatWasPutBackOverItselfIsNoticedByTheServer) {
  const auto before = snapshot();
  start_server();
  const auto idle = report("idle", 100, 7);
  const Uuid epoch = status().store_epoch;
  kill_server();
  put_back("", before.at(""));
  start_server();
  EXPECT_EQ(status().rollbacks, 1U);
  EXPECT_NE(status().store_epoch, epoch);
  expect_all_again(12);
  EXPECT_EQ(expect_ledger_in(store_), 12U);
}

TEST_F(Rollback, DiskThatWasPutBackIsNoticedByAnIdleClient) {
  const auto before = snapshot();
  start_server();
  const auto idle = report("idle", 100, 7);
  kill_server();
  for (const auto& [suffix, bytes] : before)
    put_back(suffix, bytes);
  start_server();
  expect_all_again(12);
  EXPECT_EQ(expect_ledger_in(store_), 12U);
}

TEST_F(Rollback, DiskThatWasPutBackIsNoticedAlsoOnceItHoldsMoreThanEver) {
  const auto before = snapshot();
  start_server();
  const auto idle = report("idle", 100, 7);
  kill_server();
  for (const auto& [suffix, bytes] : before)
    put_back(suffix, bytes);
  idle->signal(SIGSTOP);
  start_server();
  register_panda("other");
  const auto other = report("other", 200, 20);
  EXPECT_EQ(status().rollbacks, 0U);
  idle->signal(SIGCONT);
  expect_all_again(32);
  EXPECT_EQ(expect_ledger_in(store_), 32U);
}

TEST_F(Rollback, ClientThatReportsNoticesIt) {
  const auto before = snapshot();
  start_server();
  report("idle", 100, 7)->kill();
  kill_server();
  for (const auto& [suffix, bytes] : before)
    put_back(suffix, bytes);
  start_server();
  const auto next = report("idle", 300, 1);
  expect_all_again(13);
  EXPECT_EQ(expect_ledger_in(store_), 13U);
}

TEST_F(Rollback, ServerThatIsKilledAndStartedAgainKeepsItsEpoch) {
  const auto idle = report("idle", 100, 7);
  const Uuid epoch = status().store_epoch;
  for (int i = 0; i < 3; ++i) {
    kill_server();
    start_server();
    report("early", 400 + static_cast<std::uint64_t>(i), 1)->kill();
  }
  EXPECT_EQ(status().store_epoch, epoch);
  EXPECT_EQ(status().rollbacks, 0U);
  EXPECT_EQ(reports_in("idle", "sent"), 7U);
  EXPECT_EQ(expect_ledger_in(store_), 15U);
}

}  // namespace
}  // namespace kinship::rollback_test
