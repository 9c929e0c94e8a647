#include "tests/faults/fleet_reporter.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>

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
                       std::uint64_t first) {
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

int run_reporting_client(const std::vector<std::string>& arguments) {
  std::signal(SIGTERM, [](int) { is_told_to_end = true; });
  std::cout << "started" << std::endl;
  link::Client client({.domain = static_cast<std::uint32_t>(std::stoul(arguments.at(0))),
                       .outbox = arguments.at(1),
                       .timeout = std::chrono::milliseconds(500)});
  const Digest panda = model_chain("panda").digest();
  // Without a server its description is in the outbox now, and the sender registers it.
  static_cast<void>(client.register_robot(model_description("panda")));
  report_until_told(client, panda, LedgerFile(arguments.at(2)), std::stoull(arguments.at(3)));
  const link::Client::OutboxState state = client.flush(std::chrono::minutes(2));
  std::cout << "pending " << state.pending << " refused " << state.refused << std::endl;
  return 0;
}

}  // namespace kinship::test
