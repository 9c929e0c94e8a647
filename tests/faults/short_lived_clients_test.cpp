#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include "tests/faults/bystander.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// A thousand clients that come and go, half of them by SIGKILL, leave no growth at the server:
/// what it takes for the first half it takes for the second one too. KINSHIP_LONG=1: 4500.
namespace kinship::test::short_lived_clients_test {
namespace {

constexpr int kProcesses = 4;  // side by side
constexpr int kClientsOfProcess = 25;

class ShortLivedClients : public testing::Test {
 protected:
  /// A hundred clients come and go.
  void live_once() {
    std::vector<std::unique_ptr<Program>> processes;
    for (int i = 0; i < kProcesses; ++i)
      processes.push_back(std::make_unique<Program>(
          "../tests/faults_fleet",
          std::vector<std::string>{"short-lived", std::to_string(domain_.number()),
                                   std::to_string(kClientsOfProcess), i % 2 == 0 ? "end" : "die"},
          directory_ / "clients.log"));
    for (int i = 0; i < kProcesses; ++i) {
      EXPECT_EQ(processes[static_cast<std::size_t>(i)]->read_line(),
                "answered " + std::to_string(kClientsOfProcess))
          << read_text(directory_ / "clients.log");
      EXPECT_EQ(processes[static_cast<std::size_t>(i)]->wait(), i % 2 == 0 ? 0 : 128 + SIGKILL);
    }
  }
  /// Those after the leases of who died (5 s) have ended.
  ProcessFigures settled() const {
    std::this_thread::sleep_for(std::chrono::seconds(7));
    return figures_of(server_.pid());
  }

  ReservedDomain domain_;
  TemporaryDirectory directory_;
  ServerProcess server_{{.store = directory_ / "fleet.db", .domain = domain_.number()}};
  Bystander bystander_{domain_.number(), directory_ / "outbox"};
};

TEST_F(ShortLivedClients, LeaveNoGrowth) {
  const int hundreds = is_long_run() ? 40 : 5;
  for (int i = 0; i < 5; ++i)  // its heap has grown to what it needs for a hundred at once
    live_once();
  const ProcessFigures before = settled();
  for (int i = 0; i < hundreds; ++i)
    live_once();
  const ProcessFigures after = settled();
  std::cout << "after 500 clients " << hundreds * kProcesses * kClientsOfProcess
            << " more: " << before.resident_mb << " -> " << after.resident_mb << " MB, "
            << before.threads << " -> " << after.threads << " threads, " << before.descriptors
            << " -> " << after.descriptors << " descriptors\n";
  EXPECT_LT(after.resident_mb, before.resident_mb + 15 + kQuarantine_mb);
  EXPECT_LE(after.threads, before.threads + 1);
  EXPECT_LE(after.descriptors, before.descriptors + 4);
  EXPECT_EQ(bystander_.live(3).unanswered(), 0U);
  EXPECT_EQ(server_.terminate(), 0);
}

}  // namespace
}  // namespace kinship::test::short_lived_clients_test
