#include "tests/faults/fleet_reporter.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <thread>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::test {
namespace {

/// A line of the ledger.
struct Entry {
  std::uint64_t number = 0;
  std::uint64_t is_accepted = 0;
};

class LedgerFile {
 public:
  explicit LedgerFile(const std::string& file)
      : descriptor_(open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0)
      throw std::runtime_error("cannot open " + file);
  }
  LedgerFile(const LedgerFile&) = delete;
  LedgerFile& operator=(const LedgerFile&) = delete;
  ~LedgerFile() { close(descriptor_); }

  void note(const Entry& entry) const {
    if (write(descriptor_, &entry, sizeof entry) != sizeof entry)
      throw std::runtime_error("cannot write the ledger");
  }

 private:
  int descriptor_;
};

std::atomic<bool> is_told_to_end = false;

void report_until_told(link::Client& client, const Digest& panda, const LedgerFile& ledger,
                       std::uint64_t first, std::chrono::milliseconds pause) {
  constexpr std::size_t kMaxPending = 200;  // what waits is read again in every round of sending
  std::mt19937_64 generator(first);
  const auto report = [&](std::uint64_t number) {
    ledger.note({number, 0});
    client.report(numbered_attempt(panda, number));
    ledger.note({number, 1});
  };
  for (std::uint64_t number = first; !is_told_to_end; ++number) {
    report(number);
    if (generator() % 8 == 0)
      report(number - std::min<std::uint64_t>(generator() % 300, number - first));
    std::this_thread::sleep_for(pause);
    while (!is_told_to_end && client.outbox().pending > kMaxPending)
      client.flush(std::chrono::milliseconds(5));
  }
}

}  // namespace

bool is_solved(std::uint64_t number) { return number / 2 % 5 != 4; }

Attempt numbered_attempt(const Digest& robot, std::uint64_t number) {
  const std::uint64_t content = number / 2;
  Attempt attempt = panda_attempt(robot, "sweep_" + std::to_string(content % 3), content);
  attempt.report_uuid = id_from<Uuid>(number);
  attempt.record.collision_checks = number;
  if (!is_solved(number)) {
    attempt.record.outcome = Outcome::Timeout;
    attempt.path.reset();
  }
  return attempt;
}

void ReportLedger::read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  Entry entry;
  while (stream.read(reinterpret_cast<char*>(&entry), sizeof entry))
    (entry.is_accepted != 0 ? accepted : begun).insert(entry.number);
}

FleetAudit audit_fleet(const store::Store& store, const Digest& panda, const ReportLedger& ledger) {
  FleetAudit audit;
  std::set<std::uint64_t> contents;
  for (const std::uint64_t number : ledger.begun) {
    const Attempt wanted = numbered_attempt(panda, number);
    const std::optional<Attempt> found = store.find_attempt(wanted.report_uuid);
    if (found) {
      ++audit.stored;
      if (!is_as_reported(*found, wanted))
        ++audit.wrong;
      if (is_solved(number))
        contents.insert(number / 2);
    } else if (ledger.accepted.contains(number)) {
      ++audit.lost;
    }
  }
  const store::StoreStatus status = store.status();
  audit.unknown = status.attempts - audit.stored;
  std::set<std::vector<double>> paths;
  std::size_t read = 0;
  for (int task = 0; task < 3; ++task)
    for (const store::StoredPath& path :
         store.read_paths(panda, "sweep_" + std::to_string(task), {.limit = 100'000'000})) {
      ++read;
      paths.emplace(path.path.waypoints().reshaped().begin(),
                    path.path.waypoints().reshaped().end());
    }
  EXPECT_EQ(read, status.paths);
  audit.repeated = read - paths.size();
  audit.pathless = contents.size() - paths.size();
  return audit;
}

void expect_nothing_wrong(const FleetAudit& audit) {
  EXPECT_EQ(audit.lost, 0U);
  EXPECT_EQ(audit.wrong, 0U);
  EXPECT_EQ(audit.unknown, 0U);
  EXPECT_EQ(audit.repeated, 0U);
  EXPECT_EQ(audit.pathless, 0U);
}

int run_reporting_client(const std::vector<std::string>& arguments) {
  std::signal(SIGTERM, [](int) { is_told_to_end = true; });
  std::cout << "started" << std::endl;
  link::Client client({.domain = static_cast<std::uint32_t>(std::stoul(arguments.at(0))),
                       .security = arguments.size() > 5 ? arguments[5] : "",
                       .outbox = arguments.at(1),
                       .timeout = std::chrono::milliseconds(500)});
  const Digest panda = model_chain("panda").digest();
  // Without a server its description is in the outbox now, and the sender registers it.
  static_cast<void>(client.register_robot(model_description("panda")));
  report_until_told(client, panda, LedgerFile(arguments.at(2)), std::stoull(arguments.at(3)),
                    std::chrono::milliseconds(std::stoul(arguments.at(4))));
  const link::Client::OutboxState state = client.flush(std::chrono::minutes(2));
  std::cout << "pending " << state.pending << " refused " << state.refused << std::endl;
  return 0;
}

}  // namespace kinship::test
