#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "tests/faults/bystander.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// One client's trouble is its own: beside bad neighbours (neighbours.hpp) a bystander is answered,
/// and the server's memory and log stay bounded. KINSHIP_LONG=1: for a minute each.
namespace kinship::test::neighbours_test {
namespace {

struct Neighbour {
  const char* name;
  const char* kind;
  bool is_stopped = false;           ///< by SIGSTOP, once it is ready
  std::optional<int> accepted = {};  ///< of what it does until it is done
  std::optional<double> max_s = {};  ///< that a status or a cached fetch may take beside it
};

class Neighbours : public testing::TestWithParam<Neighbour> {
 protected:
  /// Lives beside the neighbour, so long that a client that is dead is known to be.
  Bystander::Rounds live_beside() {
    const auto end =
        std::chrono::steady_clock::now() + std::chrono::seconds(is_long_run() ? 60 : 3);
    Bystander::Rounds all;
    const auto append = [](Bystander::Calls& to, const Bystander::Calls& from) {
      to.times_s.insert(to.times_s.end(), from.times_s.begin(), from.times_s.end());
      to.unanswered += from.unanswered;
      to.answer += from.answer;
    };
    while (all.unanswered() == 0 && std::chrono::steady_clock::now() < end) {
      const Bystander::Rounds some = bystander_.live(5);
      append(all.status, some.status);
      append(all.fetch, some.fetch);
      append(all.report, some.report);
      note_memory();
    }
    return all;
  }
  void note_memory() { most_mb_ = std::max(most_mb_, figures_of(server_.pid()).resident_mb); }
  std::uintmax_t log_bytes() const {
    return std::filesystem::file_size(directory_ / "fleet.db.log");
  }

  ReservedDomain domain_;
  TemporaryDirectory directory_;
  // One of the neighbours begins more tasks than one client may: it is to see all of them stored.
  ServerProcess server_{{.store = directory_ / "fleet.db",
                         .domain = domain_.number(),
                         .arguments = {"--client-tasks-per-day", "0"}}};
  Bystander bystander_{domain_.number(), directory_ / "outbox"};
  double most_mb_ = 0;
};

TEST_P(Neighbours, TroubleIsNobodyElses) {
  const Bystander::Rounds alone = bystander_.live(30);
  const double before_mb = figures_of(server_.pid()).resident_mb;
  Program neighbour("../tests/faults_fleet",
                    {"neighbour", GetParam().kind, std::to_string(domain_.number())},
                    directory_ / "neighbour.log");
  ASSERT_EQ(neighbour.read_line(), "ready") << read_text(directory_ / "neighbour.log");
  if (GetParam().is_stopped)
    neighbour.signal(SIGSTOP);
  const Bystander::Rounds beside = live_beside();
  if (GetParam().accepted) {
    EXPECT_EQ(neighbour.read_line(), "done " + std::to_string(*GetParam().accepted))
        << read_text(directory_ / "neighbour.log");
  }
  neighbour.signal(SIGKILL);
  neighbour.wait();
  note_memory();

  std::cout << table_row(GetParam().name, alone, beside) << "; the server had " << before_mb
            << " MB, then at most " << most_mb_ << " MB, and wrote " << log_bytes() << " B\n";
  EXPECT_EQ(beside.unanswered(), 0U) << beside.answers();
  if (GetParam().max_s) {
    EXPECT_LT(std::ranges::max(beside.status.times_s), *GetParam().max_s);
    EXPECT_LT(std::ranges::max(beside.fetch.times_s), *GetParam().max_s);
  }
  EXPECT_LT(most_mb_, before_mb + 500 + kQuarantine_mb);
  EXPECT_LT(log_bytes(), is_long_run() ? 500'000U : 100'000U);
  EXPECT_EQ(bystander_.live(1).unanswered(), 0U) << "after it";
  EXPECT_EQ(server_.terminate(), 0);
}

/// A request whose first three sends were pushed out by those of others is answered later.
constexpr double kFourthSend_s = 1.4;

INSTANTIATE_TEST_SUITE_P(
    Bad, Neighbours,
    testing::Values(Neighbour{"FloodOfReports", "report"},
                    Neighbour{"FloodOfFits", "fetch", false, {}, kFourthSend_s},
                    Neighbour{"FloodOfListings", "admin", false, {}, kFourthSend_s},
                    Neighbour{"FloodOfRegistrations", "register"},
                    Neighbour{"StoppedWhileItFollows", "stopped", true},
                    Neighbour{"AMillionWaypoints", "long-paths", false, 62},
                    Neighbour{"TenThousandTasks", "many-tasks", false, 10'000},
                    Neighbour{"FourThousandLeases", "long-leases", false, 4096}),
    [](const auto& neighbour) { return std::string(neighbour.param.name); });

}  // namespace
}  // namespace kinship::test::neighbours_test
