#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <set>
#include <thread>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// kill -9 at any instant: every acknowledged report is there afterwards, none twice.
namespace kinship::store::store_kill_test {
namespace {

constexpr std::uint64_t kSeed = 20261121;
constexpr std::uint64_t kClients = 4;
constexpr int kKills = 10;

enum class Acknowledge { AfterReceipt, BeforeCommit };  // the second is the fault seeded on purpose

const RobotRecord& robot() {
  static const RobotRecord kRobot = test::make_robot("panda", 1);
  return kRobot;
}

/// Two of three carry a scene: one that many share, and one of their own.
Attempt attempt(std::uint64_t number) {
  Attempt attempt = number % 5 == 0 ? test::make_unsolved(robot().digest, "shelf", number)
                                    : test::make_attempt(robot().digest, "shelf", number);
  const double height_m = number % 3 == 1 ? 1.0 : 1e-3 * static_cast<double>(1 + number % 500'000);
  if (number % 3 != 0)
    attempt.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}},
                                   {"shelf", BoxShape{{0.3, 1, height_m}}, test::make_pose()}},
                                  {},
                                  {}};
  return attempt;
}

/// A client of the doomed server: reports one attempt after the other and writes the number of
/// each acknowledged one into the ledger.
void report_for_ever(Store& store, std::uint64_t first, int ledger, Acknowledge when) {
  for (std::uint64_t number = first;; ++number) {
    const auto note = [&] {
      if (write(ledger, &number, sizeof number) != sizeof number)
        _exit(3);
    };
    if (when == Acknowledge::BeforeCommit)
      note();
    const ReceiptStatus status = test::report(store, {attempt(number)}).at(0).status;
    if (status != ReceiptStatus::Stored && status != ReceiptStatus::Recorded)
      _exit(4);
    if (when == Acknowledge::AfterReceipt)
      note();
  }
}

[[noreturn]] void serve_until_killed(const std::filesystem::path& file, int round, int ledger,
                                     Acknowledge when) {
  const std::unique_ptr<Store> store = open_sqlite_store(file);
  if (!store->register_robot(robot()))
    _exit(2);
  std::vector<std::thread> clients;
  for (std::uint64_t client = 0; client < kClients; ++client)
    clients.emplace_back([&, client] {
      const std::uint64_t life = static_cast<std::uint64_t>(round) * kClients + client;
      report_for_ever(*store, 1'000'000 * (life + 1), ledger, when);
    });
  clients.front().join();  // never
  _exit(5);
}

/// Runs a server, kills it at a random moment; what it acknowledged goes into `ledger`.
void one_life(const std::filesystem::path& file, int round, std::mt19937_64& generator,
              Acknowledge when, std::set<std::uint64_t>& ledger) {
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    serve_until_killed(file, round, ends[1], when);
  }
  close(ends[1]);
  std::uint64_t number = 0;
  std::uint64_t wanted = 1 + generator() % 60;
  while (wanted-- > 0 && read(ends[0], &number, sizeof number) == sizeof number)
    ledger.insert(number);
  std::this_thread::sleep_for(std::chrono::microseconds(generator() % 3000));  // the random moment
  kill(child, SIGKILL);
  while (read(ends[0], &number, sizeof number) == sizeof number)
    ledger.insert(number);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the server ended by itself with " << WEXITSTATUS(status);
}

/// Acknowledged attempts that are not there, or not as they were reported.
std::size_t count_lost(const Store& store, const std::set<std::uint64_t>& ledger) {
  std::size_t lost = 0;
  for (const std::uint64_t number : ledger) {
    const Attempt wanted = attempt(number);
    const std::optional<Attempt> found = store.find_attempt(wanted.report_uuid);
    const bool same =
        found && found->path.has_value() == wanted.path.has_value() &&
        (!wanted.path || found->path->waypoints() == wanted.path->waypoints()) &&
        found->scene.has_value() == wanted.scene.has_value() &&
        (!wanted.scene || content_digest(*found->scene) == content_digest(*wanted.scene));
    if (!same)
      ++lost;
  }
  return lost;
}

TEST(StoreKill, LosesNoAcknowledgedReportAndKeepsNoneTwice) {
  const test::TemporaryDirectory directory;
  std::mt19937_64 generator(kSeed);
  std::set<std::uint64_t> ledger;
  for (int round = 0; round < kKills; ++round) {
    one_life(directory / "s.db", round, generator, Acknowledge::AfterReceipt, ledger);
    const std::unique_ptr<Store> store = open_sqlite_store(directory / "s.db");
    EXPECT_EQ(count_lost(*store, ledger), 0U) << "after kill " << round + 1;
  }
  const std::unique_ptr<Store> store = open_sqlite_store(directory / "s.db");
  const StoreStatus before = store->status();
  EXPECT_GE(before.attempts, ledger.size());
  EXPECT_EQ(store->read_paths(robot().digest, "shelf", {.after_id = 0, .limit = 1'000'000}).size(),
            before.paths);
  for (const std::uint64_t number : ledger)
    EXPECT_EQ(test::report(*store, {attempt(number)}).at(0).status, ReceiptStatus::Duplicate);
  EXPECT_EQ(store->status().attempts, before.attempts);
  EXPECT_EQ(store->status().paths, before.paths);
  RecordProperty("acknowledged", static_cast<int>(ledger.size()));
}

TEST(StoreKill, TheLedgerFindsAReceiptThatComesBeforeTheCommit) {
  const test::TemporaryDirectory directory;
  std::mt19937_64 generator(kSeed);
  std::set<std::uint64_t> ledger;
  for (int round = 0; round < kKills; ++round)
    one_life(directory / "s.db", round, generator, Acknowledge::BeforeCommit, ledger);
  EXPECT_GT(count_lost(*open_sqlite_store(directory / "s.db"), ledger), 0U);
}

}  // namespace
}  // namespace kinship::store::store_kill_test
