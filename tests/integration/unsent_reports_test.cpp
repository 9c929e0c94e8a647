// What a planner without a server reported before it was killed reaches a server that never heard
// of its robot.

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/problem_json.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::unsent_reports_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

class UnsentReports : public testing::Test {
 protected:
  /// Plans with reports and is killed once it has written two results.
  /// \return the results that it wrote.
  std::vector<ProblemResult> plan_until_killed() const {
    test::Program problems("kinship-experiments",
                           {"shelf", "--model", model_, "--count", "40", "--output", problems_});
    EXPECT_EQ(problems.wait(), 0);
    test::Program plan("kinship-plan", {problems_, "--model", model_, "--task", "shelf",
                                        "--guidance", "none", "--report", "--outbox", outbox_,
                                        "--domain", std::to_string(domain_.number()), "--timeout",
                                        "0.2", "--max-checks", "3000"});
    std::string lines = plan.read_line() + "\n" + plan.read_line() + "\n";
    plan.signal(SIGKILL);
    EXPECT_EQ(plan.wait(), 128 + SIGKILL);
    lines += plan.read_all();
    std::vector<ProblemResult> results;
    std::istringstream stream(lines);
    for (std::string line; std::getline(stream, line);)
      if (auto result = json::problem_result_from_json(line))
        results.push_back(std::move(result).value());
    return results;
  }

  std::size_t files_in(const char* part) const {
    return static_cast<std::size_t>(
        std::count_if(fs::directory_iterator(fs::path(outbox_) / part), {},
                      [](const auto& entry) { return entry.path().extension() == ".json"; }));
  }

  static ServerStatus status_of(link::Client& client) {
    return json::row_from_json<ServerStatus>(client.admin({}).value_or_throw().rows.at(0))
        .value_or_throw();
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  const std::string model_ = test::source_dir() + "/robots/models/panda";
  const std::string problems_ = directory_ / "problems.jsonl";
  const std::string outbox_ = directory_ / "outbox";
};

TEST_F(UnsentReports, AreStoredOnceByAServerThatDidNotKnowTheRobot) {
  const std::vector<ProblemResult> results = plan_until_killed();
  ASSERT_GE(results.size(), 2U);
  ASSERT_LT(results.size(), 40U);
  const std::size_t reported = files_in("pending");
  EXPECT_GE(reported, results.size());      // each result's report came before it
  EXPECT_LE(reported, results.size() + 1);  // killed between the two

  const test::ServerProcess server({.store = directory_ / "fleet.db", .domain = domain_.number()});
  for (int run = 0; run < 2; ++run) {  // the second one has nothing to send
    link::Client client({.domain = domain_.number(), .outbox = outbox_, .timeout = seconds(20)});
    const link::Client::OutboxState state = client.flush(seconds(60));
    EXPECT_EQ(state.pending, 0U) << state.problem;
    EXPECT_EQ(state.accepted, run == 0 ? reported : 0U);
    EXPECT_EQ(status_of(client).attempts, reported);
    EXPECT_EQ(status_of(client).robots, 1U);
  }
  EXPECT_EQ(files_in("rejected"), 0U);
  EXPECT_EQ(files_in("sent"), reported);
}

}  // namespace
}  // namespace kinship::unsent_reports_test
