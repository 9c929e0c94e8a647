#include "tests/faults/store_clients.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "proto/types/failure.hpp"
#include "server/store/postgres/postgres_store.hpp"
#include "tests/faults/report_history.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::test {
namespace {

std::atomic<bool> is_told_to_end_now = false;

/// As clients do between two tries.
void rest() { std::this_thread::sleep_for(std::chrono::milliseconds(5)); }

/// One client: a thread, and what it knows.
class StoreClient {
 public:
  StoreClient(store::Store& store, const HistoryFile& history, std::uint32_t number)
      : store_(store), history_(history), number_(number), generator_(number + 1) {}

  /// What a life before this one left.
  void learn(const HistoryEntry& entry) {
    if (entry.kind == HistoryEntry::Kind::Begun) {
      pending_.insert(entry.number);
      if (entry.number >= kNumbersPerClient)
        next_ = std::max(next_, entry.number % kNumbersPerClient + 1);
      ++begun_;
    } else if (entry.kind == HistoryEntry::Kind::Answered) {
      pending_.erase(entry.number);
      last_ = entry.number;
    }
  }

  void run() {
    const std::set<std::uint64_t> left = pending_;
    for (const std::uint64_t number : left)
      send(number);
    while (!is_told_to_end_now) {
      const std::uint64_t number = next_number();
      history_.note({.kind = HistoryEntry::Kind::Begun,
                     .client = number_,
                     .number = number,
                     .began_ns = history_now_ns()});
      send(number);
      if (generator_() % 8 == 0)
        send(last_);
      if (generator_() % 4 == 0)
        read_generation(generator_() % 2 == 0 ? key_of(number)
                                              : key_of(generator_() % (2 * kHistoryKeys)));
    }
  }

 private:
  static constexpr std::uint64_t kNumbersPerClient = 1'000'000;

  /// Every fourth is one that all clients send: who is first, has it stored.
  std::uint64_t next_number() {
    ++begun_;
    if (begun_ % 4 == 0)
      return begun_ / 4;
    return (1 + std::uint64_t{number_}) * kNumbersPerClient + next_++;
  }

  void send(std::uint64_t number) {
    const Attempt attempt = numbered_report(number);
    while (true) {
      const std::int64_t began_ns = history_now_ns();
      const Receipt receipt = report(store_, {attempt}).at(0);
      if (receipt.status == ReceiptStatus::TryAgain) {
        rest();
        continue;
      }
      if (receipt.status == ReceiptStatus::Refused || receipt.status == ReceiptStatus::UnknownRobot)
        std::cerr << "report " << number << ": " << receipt.message << std::endl;
      history_.note({.kind = HistoryEntry::Kind::Answered,
                     .client = number_,
                     .number = number,
                     .status = static_cast<std::uint32_t>(receipt.status),
                     .began_ns = began_ns,
                     .ended_ns = history_now_ns()});
      last_ = number;
      if (::write(STDOUT_FILENO, "answered\n", 9) != 9)
        _exit(3);
      return;
    }
  }

  void read_generation(const ReportKey& key) {
    try {
      const std::int64_t began_ns = history_now_ns();
      const std::uint64_t generation =
          store_.generation(history_robots()[key.robot].digest, history_task(key.task));
      history_.note({.kind = HistoryEntry::Kind::Read,
                     .client = number_,
                     .number = generation,
                     .key = key.index(),
                     .began_ns = began_ns,
                     .ended_ns = history_now_ns()});
    } catch (const Failure&) {
      rest();  // said in words: the database is away
    }
  }

  store::Store& store_;
  const HistoryFile& history_;
  std::uint32_t number_;
  std::mt19937_64 generator_;
  std::set<std::uint64_t> pending_;
  std::uint64_t next_ = 0, begun_ = 0, last_ = 0;
};

/// As a service that is started again until its database is there.
std::unique_ptr<store::Store> open_patiently(const std::string& url, bool requires_standby) {
  while (true) {
    try {
      std::unique_ptr<store::Store> store = store::open_postgres_store(
          url,
          {.retry_after = std::chrono::milliseconds(50), .require_synchronous = requires_standby});
      for (const store::RobotRecord& robot : history_robots())
        static_cast<void>(store->register_robot(robot));
      return store;
    } catch (const Failure& failure) {
      std::cerr << "not open: " << failure.what() << std::endl;
      if (is_told_to_end_now)
        throw;
      rest();
    }
  }
}

}  // namespace

int run_store_clients(const std::vector<std::string>& arguments) {
  std::signal(SIGTERM, [](int) { is_told_to_end_now = true; });
  const std::filesystem::path file = arguments.at(1);
  const auto count = static_cast<std::uint32_t>(std::stoul(arguments.at(2)));
  const auto first = static_cast<std::uint32_t>(std::stoul(arguments.at(3)));
  const std::vector<HistoryEntry> before = read_history(file);
  const HistoryFile history(file);
  const std::unique_ptr<store::Store> store =
      open_patiently(arguments.at(0), arguments.at(4) == "synchronous");

  std::vector<StoreClient> clients;
  for (std::uint32_t i = 0; i < count; ++i)
    clients.emplace_back(*store, history, first + i);
  for (const HistoryEntry& entry : before)
    clients.at(entry.client - first).learn(entry);
  std::vector<std::thread> threads;
  for (StoreClient& client : clients)
    threads.emplace_back([&client] { client.run(); });
  for (std::thread& thread : threads)
    thread.join();
  return 0;
}

}  // namespace kinship::test
