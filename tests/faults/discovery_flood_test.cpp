#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/link/admin_rows.hpp"
#include "client/link/client.hpp"
#include "tests/faults/announcement_flood.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// Beside announcements of participants that are not there newcomers are answered as soon as ever,
/// and what the announcements took is given back.
namespace kinship::test::discovery_flood_test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

struct Flood {
  const char* name;
  double per_s;
  bool is_secured = false;
  const char* from = "127.0.0.1";
  int ports = 1;
  /// What the first flood leaves in the heap, for the next one, which adds nothing to it.
  double heap_mb = 12;
};

class DiscoveryFlood : public testing::TestWithParam<Flood> {
 public:
  DiscoveryFlood(const DiscoveryFlood&) = delete;
  DiscoveryFlood& operator=(const DiscoveryFlood&) = delete;
  ~DiscoveryFlood() override { unsetenv("KINSHIP_SECURITY"); }  // NOLINT(concurrency-mt-unsafe)

 protected:
  DiscoveryFlood() {
    if (GetParam().is_secured) {
      secure({"init", fleet_.string()});
      secure({"add", "desk", "--security", fleet_.string(), "--role", "admin", "--out",
              desk_.string()});
      setenv("KINSHIP_SECURITY", desk_.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
    }
    std::vector<std::string> arguments;
    if (GetParam().is_secured)
      arguments = {"--security", fleet_.string()};
    server_.emplace(ServerProcess::Options{
        .store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = arguments});
  }
  static void secure(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "secure");
    const Answer done = run_to_end("kinshipd", arguments);
    EXPECT_EQ(done.code, 0) << done.err;
  }

  Answer kinship(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"--domain", std::to_string(domain_.number())});
    return run_to_end("kinship", arguments);
  }

  /// The time that 95 of 100 newcomers need at most, s.
  double newcomers_s() const {
    std::vector<double> times_s;
    for (int i = 0; i < (is_long_run() ? 300 : 30); ++i) {
      const auto begin = Clock::now();
      const Answer answer = kinship({"--timeout", "20", "tasks", "list"});
      times_s.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
      EXPECT_EQ(answer.code, 0) << answer.err;
    }
    std::ranges::sort(times_s);
    std::cout << GetParam().name << ": newcomers' median " << times_s[times_s.size() / 2]
              << " s, longest " << times_s.back() << " s\n";
    return times_s[times_s.size() * 95 / 100];
  }

  /// By one client: each further one would be a participant, too.
  static ServerStatus status(link::Client& client) {
    return link::row_of<ServerStatus>(client, AdminRequest()).value_or_throw();
  }
  static std::uint64_t participants(link::Client& client) {
    const ServerStatus now = status(client);
    return std::ranges::find(now.bounds, "participants", &BoundUse::what)->used;
  }

  ReservedDomain domain_;
  TemporaryDirectory directory_;
  const std::filesystem::path fleet_ = directory_ / "fleet", desk_ = directory_ / "desk";
  std::optional<ServerProcess> server_;
};

TEST_P(DiscoveryFlood, KeepsNoNewcomerWaiting) {
  constexpr double kLimit_s = 0.5;
  const Packet announcement =
      endless_announcement(capture_client(domain_.number(), directory_.path()));
  const double alone_s = newcomers_s();
  const double before_mb = figures_of(server_->pid()).resident_mb;
  std::uint64_t sent = 0;
  double beside_s = 0, most_mb = 0;
  link::Client client({.domain = domain_.number(), .has_outbox = false, .timeout = seconds(20)});
  {
    const AnnouncementFlood flood({.domain = domain_.number(),
                                   .announcement = announcement,
                                   .per_s = GetParam().per_s,
                                   .from = GetParam().from,
                                   .ports = GetParam().ports});
    while (static_cast<double>(flood.sent()) < 4 * GetParam().per_s)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    beside_s = newcomers_s();
    most_mb = figures_of(server_->pid()).resident_mb;
    sent = flood.sent();
  }
  EXPECT_LE(beside_s, std::max(kLimit_s, 2 * alone_s)) << "alone " << alone_s;
  EXPECT_TRUE(std::ranges::any_of(status(client).troubles, [](const TroubleCount& each) {
    return each.what.starts_with("newcomers beyond") && each.count > 100;
  }));
  const auto end = Clock::now() + seconds(30);
  while (participants(client) > 2 && Clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_LE(participants(client), 2U) << "the server itself, and this client";
  const double after_mb = figures_of(server_->pid()).resident_mb;
  std::cout << sent << " announcements; the server had " << before_mb << " MB, then " << most_mb
            << " MB, in the end " << after_mb << " MB\n";
  EXPECT_LT(after_mb, before_mb + GetParam().heap_mb + kQuarantine_mb);
  EXPECT_EQ(server_->terminate(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Of, DiscoveryFlood,
    testing::Values(Flood{"OneSocket", 500},
                    Flood{"OneSocketAtASecuredServer", 200, true, "127.0.0.1", 1, 16},
                    Flood{"ManyPortsOfAnotherAddress", 500, false, "127.0.0.2", 256, 32},
                    Flood{"ManyPortsOfTheNewcomersAddress", 500, false, "127.0.0.1", 256, 32}),
    [](const auto& flood) { return std::string(flood.param.name); });

}  // namespace
}  // namespace kinship::test::discovery_flood_test
