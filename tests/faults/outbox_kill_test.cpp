// Two processes report through one outbox while they and the server are killed at random: what
// report() returned for reaches the store, once. KINSHIP_LONG=1: some hundred kills.

#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <iostream>
#include <random>

#include "client/link/outbox.hpp"
#include "proto/types/failure.hpp"
#include "tests/faults/reporting_fleet.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/small_file_system.hpp"

namespace kinship::outbox_kill_test {
namespace {

constexpr std::uint64_t kSeed = 20261123;

int rounds() { return test::is_long_run() ? 300 : 12; }

class OutboxKill : public test::ReportingFleet {
 protected:
  void wait_a_while() {
    std::uniform_int_distribution<int> while_ms(20, 600);
    std::this_thread::sleep_for(std::chrono::milliseconds(while_ms(generator_)));
  }

  std::mt19937_64 generator_{kSeed};
};

TEST_F(OutboxKill, WhatWasReportedReachesTheStoreOnceWhoeverIsKilled) {
  start_server();
  register_panda("outbox");
  status();                       // makes the observer
  std::atomic<int> in_doubt = 0;  // batches with attempts that a killed sender had no receipt for
  const auto watcher = observer_->watch({.on_event = [&](const Event& event) {
    if (event.text.find("known already") != std::string::npos)
      ++in_doubt;
  }});
  std::uint64_t next = 0;
  const auto start = [&] { return start_client("outbox", 1'000'000 * ++next, 0); };
  std::unique_ptr<test::ChildProcess> clients[] = {start(), start()};
  int kills = 0;
  for (int round = 0; round < rounds(); ++round) {
    wait_a_while();
    if (round % 3 == 1) {
      kill_server();
      ++kills;
      if (round % 2 == 0)
        wait_a_while();
      start_server();
    }
    std::unique_ptr<test::ChildProcess>& client = clients[generator_() % 2];
    client->signal(SIGKILL);
    EXPECT_FALSE(read_ledger(*client));
    client = start();
    ++kills;
  }
  for (std::unique_ptr<test::ChildProcess>& client : clients) {
    client->signal(SIGKILL);
    EXPECT_FALSE(read_ledger(*client));
    ++kills;
  }
  const auto last = start_client("outbox", 1'000'000 * ++next, 1);
  EXPECT_TRUE(read_ledger(*last));
  EXPECT_EQ(reports_in("outbox", "pending"), 0U);
  EXPECT_EQ(reports_in("outbox", "rejected"), 0U);
  const std::uint64_t attempts = expect_ledger_in(store_);
  EXPECT_EQ(reports_in("outbox", "sent"), attempts);
  std::cout << kills << " kills, " << ledger_.size() << " reports in the ledger, " << attempts
            << " stored, " << in_doubt << " batches sent again after their commit\n";
  EXPECT_TRUE(!test::is_long_run() || in_doubt > 0);
}

/// Two programs on one outbox whose disk fills up, with a stranger's folder and FIFO among the
/// reports: one is killed, the other has no room, the server dies in between.
TEST_F(OutboxKill, OnAFullDiskAmongStrangeFilesTwoProgramsLoseNothing) {
  const std::filesystem::path folder = directory_.path() / "outbox";
  std::filesystem::create_directory(folder);
  std::size_t room_kb = 1024;
  const test::SmallFileSystem disk(folder, std::to_string(room_kb) + "k");
  if (!disk.is_mounted())
    GTEST_SKIP() << disk.why();
  start_server();
  register_panda("outbox");
  const auto strange = [&] { return folder / "pending" / (Uuid::random().text() + ".json"); };
  const std::filesystem::path fifo = strange();
  std::filesystem::create_directory(strange());
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::uint64_t next = 0;
  const auto start = [&] { return start_client("outbox", 1'000'000 * ++next, 0); };
  int full = 0;
  for (int round = 0; round < rounds(); ++round) {
    const std::unique_ptr<test::ChildProcess> killed = start(), filling = start();
    wait_a_while();
    killed->signal(SIGKILL);
    EXPECT_FALSE(read_ledger(*killed));
    if (round % 3 == 1) {
      kill_server();
      start_server();
    }
    EXPECT_FALSE(read_ledger(*filling)) << "it ends where it has no room";
    ++full;
    room_kb += 1024;
    disk.resize(std::to_string(room_kb) + "k");
  }
  const auto last = start_client("outbox", 1'000'000 * ++next, 1);
  EXPECT_TRUE(read_ledger(*last));
  EXPECT_EQ(reports_in("outbox", "pending"), 2U) << "the strange ones";
  EXPECT_TRUE(std::filesystem::is_fifo(fifo));
  EXPECT_EQ(reports_in("outbox", "rejected"), 0U);
  EXPECT_FALSE(std::filesystem::exists(folder / "set_aside"));
  const std::uint64_t attempts = expect_ledger_in(store_);
  EXPECT_EQ(reports_in("outbox", "sent"), attempts);
  std::cout << full << " times full, " << ledger_.size() << " reports in the ledger, " << attempts
            << " stored\n";
}

/// In a child process: its own mounts end with it.
/// \return its exit code; 77 if it may not mount.
int on_a_disk_of_64_kb(const std::filesystem::path& folder, const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    const bool is_mounted =
        (unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
        mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
        mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") == 0;
    try {
      _exit(is_mounted ? work() : 77);
    } catch (const std::exception& exception) {
      std::cerr << exception.what() << '\n';
      _exit(99);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// \return the number of the first thing that is wrong; 0: nothing.
int fill_up(const std::filesystem::path& folder) {
  link::Outbox outbox(folder);
  const Uuid epoch = Uuid::random();
  outbox.note_store(epoch, {});
  const Digest panda{};
  std::set<Uuid> reported;
  int refused = 0;
  for (std::uint64_t number = 0; number < 200; ++number) {
    const Attempt attempt = test::panda_attempt(panda, "sweep", number);
    try {
      outbox.add(attempt);
      reported.insert(attempt.report_uuid);
    } catch (const Failure& failure) {
      if (failure.code() != ErrorCode::Storage)
        return 1;
      ++refused;
    }
  }
  if (reported.empty() || refused == 0)
    return 2;
  const std::vector<Uuid> pending = outbox.pending();
  if (std::set<Uuid>(pending.begin(), pending.end()) != reported)
    return 3;
  for (const Uuid& uuid : pending)
    if (!outbox.read(uuid))
      return 4;
  // Receipts are noted all the same: what is sent needs no room.
  outbox.note_store(epoch, ConsistencyToken(40, 1));
  for (const Uuid& uuid : pending)
    outbox.mark_sent(uuid);
  return outbox.pending_count() == 0 ? 0 : 5;
}

TEST(OutboxOnAFullDisk, SaysSoAndKeepsWhatItReturnedForWhole) {
  const test::TemporaryDirectory directory;
  const int outcome =
      on_a_disk_of_64_kb(directory.path(), [&] { return fill_up(directory.path()); });
  if (outcome == 77)
    GTEST_SKIP() << "may not mount a small disk";
  EXPECT_EQ(outcome, 0);
}

}  // namespace
}  // namespace kinship::outbox_kill_test
