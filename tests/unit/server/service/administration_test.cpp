#include "server/service/administration.hpp"

#include <gtest/gtest.h>

#include <future>
#include <map>
#include <memory>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/fleet.hpp"
#include "tests/unit/server/service/given_guidance.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::service::administration_test {
namespace {

class AdministrationTest : public testing::Test {
 protected:
  AdministrationTest() {
    registry_.register_robot(fleet::teacher(), 1);
    registry_.register_robot(fleet::pupil(), 2);
  }

  AdminPage ask(AdminVerb verb, const std::string& argument = "") {
    return administration_.answer(fleet::question(verb, argument), "", fleet::caller_here());
  }
  void report(const std::vector<Attempt>& attempts) {
    std::promise<void> done;
    store_->commit_reports(attempts, [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
  }
  Distribution put_distribution(std::uint8_t first_byte, std::uint8_t last_byte) {
    Distribution distribution;
    distribution.id.bytes.fill(first_byte);
    distribution.id.bytes.back() = last_byte;
    distribution.task = "shelf";
    distribution.robot = teacher_.digest;
    distribution.profile = "default";
    distribution.state = DistributionState::Failed;
    distribution.reason = "nothing";
    distribution.limits = Eigen::Matrix2Xd::Zero(2, 3);
    if (!store_->find_task(distribution.task))
      report({fleet::unsolved(teacher_.digest, distribution.task)});
    distribution.revision = store_->put_distribution(distribution);
    return distribution;
  }
  template <typename Row>
  static const Row& row(const AdminPage& page, std::size_t index = 0) {
    return std::get<Row>(page.rows.at(index));
  }

  Administration::Parts parts(runtime::RobotRegistry& robots) {
    return {.store = *store_,
            .robots = robots,
            .jobs = jobs_,
            .clock = clock_,
            .guidance = guidance_,
            .status =
                [] {
                  ServerStatus status;
                  status.version = "7";
                  return status;
                },
            .on_change = [this](const std::string& task,
                                const std::string& what) { changes_ += task + "|" + what + "\n"; }};
  }

  std::string changes_;
  GivenGuidance guidance_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  runtime::RobotRegistry registry_{*store_};
  runtime::Clock clock_;
  Jobs jobs_{clock_, {}};
  Administration administration_{parts(registry_)};
  const runtime::Robot teacher_ = fleet::robot_of(fleet::teacher());
  const runtime::Robot pupil_ = fleet::robot_of(fleet::pupil());
};

TEST_F(AdministrationTest, StatusIsOneRow) {
  const AdminPage page = ask(AdminVerb::Status);
  EXPECT_EQ(page.status, AdminStatus::Ok);
  EXPECT_EQ(row<ServerStatus>(page).version, "7");
}

TEST_F(AdministrationTest, ListedRobotsNameTheirSolver) {
  const AdminPage page = ask(AdminVerb::ListRobots);
  ASSERT_EQ(page.rows.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(row<RobotSummary>(page, i).solver.ends_with("Levenberg-Marquardt"));
}

TEST_F(AdministrationTest, ARobotIsShownByLabelOrByDigestPrefix) {
  const std::string hex = teacher_.digest.hex();
  for (const std::string& name : {std::string("teacher"), hex.substr(0, 6), hex}) {
    const AdminPage page = ask(AdminVerb::ShowRobot, name);
    ASSERT_EQ(page.status, AdminStatus::Ok) << page.message;
    ASSERT_EQ(page.rows.size(), 2U);
    EXPECT_EQ(row<RobotSummary>(page).robot, teacher_.digest);
    EXPECT_EQ(row<RobotDescription>(page, 1).urdf, fleet::teacher().urdf);
  }
}

TEST_F(AdministrationTest, UnknownRobotsAreNotFound) {
  const AdminPage page = ask(AdminVerb::ShowRobot, "nobody");
  EXPECT_EQ(page.status, AdminStatus::NotFound);
  EXPECT_EQ(page.message, "no robot 'nobody'");
}

TEST_F(AdministrationTest, AnAmbiguousPrefixNamesTheCandidates) {
  Digest twin = teacher_.digest;
  twin.bytes.back() ^= 1U;
  RobotDescription description = fleet::teacher();
  description.label = "twin";
  ASSERT_TRUE(store_->register_robot(
      {.digest = twin, .description = description, .dof = 3, .registered_ms = 1}));
  const AdminPage page = ask(AdminVerb::ShowRobot, teacher_.digest.hex().substr(0, 8));
  EXPECT_EQ(page.status, AdminStatus::Refused);
  EXPECT_NE(page.message.find("'teacher'"), std::string::npos) << page.message;
  EXPECT_NE(page.message.find("'twin'"), std::string::npos) << page.message;
}

TEST_F(AdministrationTest, TasksAndAttemptsAreShown) {
  const Attempt attempt = fleet::solved(teacher_, "shelf", 1);
  report({attempt});
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "shelf")).paths, 1U);
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ListTasks)).task, "shelf");
  const AdminPage page = ask(AdminVerb::ShowPath, attempt.report_uuid.text());
  EXPECT_EQ(row<Attempt>(page).path->waypoints(), attempt.path->waypoints());
}

TEST_F(AdministrationTest, MissingThingsAreNamed) {
  EXPECT_EQ(ask(AdminVerb::ShowTask, "bin").message, "no task 'bin'");
  const std::string uuid = Uuid::random().text();
  EXPECT_EQ(ask(AdminVerb::ShowPath, uuid).message, "no report '" + uuid + "'");
  EXPECT_EQ(ask(AdminVerb::ShowPath, "17").message,
            "'17' is not a report's UUID, nor a prefix of at least 8 of its digits");
  EXPECT_EQ(ask(AdminVerb::ShowDistribution, "abcd").message, "no distribution 'abcd'");
  EXPECT_EQ(ask(AdminVerb::ShowDistribution, "xyz").status, AdminStatus::Refused);
}

TEST_F(AdministrationTest, AnExplanationSaysWhatWasRehearsedWithItsDistribution) {
  const Distribution one = put_distribution(0x11, 1), other = put_distribution(0x22, 2);
  const auto explained = [&](const Distribution& distribution) {
    const AdminPage page = ask(AdminVerb::ExplainDistribution, distribution.id.hex());
    return row<Explanation>(page).rehearsal;
  };
  EXPECT_FALSE(explained(one));
  const Rehearsal rehearsal{.guide = Guide::Ways, .is_complete = true, .queries = 7};
  guidance_.rehearsed[one.id] = std::make_shared<const Rehearsal>(rehearsal);
  EXPECT_EQ(explained(one), rehearsal);
  EXPECT_FALSE(explained(other));
}

TEST_F(AdministrationTest, PathsAreListedByRobotAndTaskInPages) {
  report(fleet::solved(teacher_, "shelf", 5, 1));
  report(fleet::solved(pupil_, "shelf", 2, 1));
  AdminRequest request = fleet::question(AdminVerb::ListPaths);
  request.robot = "teacher";
  request.task = "shelf";
  request.limit = 2;
  std::size_t rows = 0, pages = 0;
  do {
    const AdminPage page = administration_.answer(request, "", fleet::caller_here());
    ASSERT_EQ(page.status, AdminStatus::Ok) << page.message;
    for (std::size_t i = 0; i < page.rows.size(); ++i)
      EXPECT_EQ(row<PathSummary>(page, i).label, "teacher");
    rows += page.rows.size();
    ++pages;
    request.cursor = page.next_cursor;
  } while (!request.cursor.empty());
  EXPECT_EQ(rows, 5U);
  EXPECT_EQ(pages, 3U);
}

TEST_F(AdministrationTest, AttemptsAreListedByRobotAndTaskInPages) {
  report(fleet::solved(teacher_, "shelf", 3, 1));
  report(fleet::solved(pupil_, "shelf", 2, 1));
  AdminRequest request = fleet::question(AdminVerb::ListAttempts);
  request.task = "shelf";
  request.limit = 4;
  const AdminPage first = administration_.answer(request, "", fleet::caller_here());
  ASSERT_EQ(first.rows.size(), 4U) << first.message;
  EXPECT_EQ(row<AttemptSummary>(first, 3).label, "pupil");
  request.cursor = first.next_cursor;
  EXPECT_EQ(administration_.answer(request, "", fleet::caller_here()).rows.size(), 1U);
  request = fleet::question(AdminVerb::ListAttempts);
  request.robot = "teacher";
  EXPECT_EQ(administration_.answer(request, "", fleet::caller_here()).rows.size(), 3U);
  request.task = "bin";
  EXPECT_EQ(administration_.answer(request, "", fleet::caller_here()).message, "no task 'bin'");
}

TEST_F(AdministrationTest, FiltersThatNameNothingAreNotFoundAndUselessOnesRefused) {
  AdminRequest request = fleet::question(AdminVerb::ListPaths);
  request.robot = "nobody";
  EXPECT_EQ(administration_.answer(request, "", fleet::caller_here()).status,
            AdminStatus::NotFound);
  request = fleet::question(AdminVerb::ListPaths);
  request.task = "bin";
  EXPECT_EQ(administration_.answer(request, "", fleet::caller_here()).message, "no task 'bin'");
  for (const VerbRule& rule : kVerbRules) {
    request = fleet::question(rule.verb, "x");
    request.task = "bin";
    const AdminPage page = administration_.answer(request, "", fleet::caller_here());
    const std::string refusal = std::string(rule.name) + " takes no filter of task";
    EXPECT_EQ(page.message == refusal, !rule.is(VerbRule::NamesTask)) << rule.name << page.message;
  }
  request = fleet::question(AdminVerb::ListTasks);
  request.robot = "nobody";
  EXPECT_EQ(administration_.answer(request, "", fleet::caller_here()).status, AdminStatus::Refused);
}

TEST_F(AdministrationTest, AFilterByRobotReadsNoDescriptions) {
  report(fleet::solved(teacher_, "shelf", 2, 1));
  store::TroubledStore watched(*store_);
  Administration::Parts watched_parts{.store = watched,
                                      .robots = registry_,
                                      .jobs = jobs_,
                                      .clock = clock_,
                                      .guidance = guidance_,
                                      .status = {}};
  Administration administration(watched_parts);
  for (const std::string& name : {std::string("teacher"), teacher_.digest.short_hex()}) {
    AdminRequest request = fleet::question(AdminVerb::ListPaths);
    request.robot = name;
    EXPECT_EQ(administration.answer(request, "", fleet::caller_here()).rows.size(), 2U);
  }
  EXPECT_EQ(watched.descriptions_read, 0);
}

TEST_F(AdministrationTest, DistributionsAreShownByIdPrefix) {
  report({fleet::solved(teacher_, "shelf", 1)});
  const Distribution a = put_distribution(0xAB, 1);
  put_distribution(0xCD, 1);
  EXPECT_EQ(ask(AdminVerb::ListDistributions).rows.size(), 2U);
  EXPECT_EQ(row<Distribution>(ask(AdminVerb::ShowDistribution, "ABab")).id, a.id);
  EXPECT_EQ(row<Distribution>(ask(AdminVerb::ShowDistribution, a.id.hex())).id, a.id);
  put_distribution(0xAB, 2);
  EXPECT_EQ(ask(AdminVerb::ShowDistribution, "abab").status, AdminStatus::Refused);
}

TEST_F(AdministrationTest, ADamagedRobotIsListedWithWhatIsWrong) {
  store::damage_robot(directory_ / "fleet.db", "pupil");
  runtime::RobotRegistry cold(*store_);
  Administration administration(parts(cold));
  const AdminPage page =
      administration.answer(fleet::question(AdminVerb::ListRobots), "", fleet::caller_here());
  ASSERT_EQ(page.status, AdminStatus::Ok) << page.message;
  ASSERT_EQ(page.rows.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& summary = row<RobotSummary>(page, i);
    EXPECT_EQ(summary.solver.ends_with("Levenberg-Marquardt"), summary.label == "teacher")
        << summary.solver;
  }
}

TEST_F(AdministrationTest, APrefixThatIsTooShortIsSaidToBe) {
  const AdminPage page = ask(AdminVerb::ShowRobot, teacher_.digest.hex().substr(0, 3));
  EXPECT_EQ(page.status, AdminStatus::NotFound);
  EXPECT_NE(page.message.find("needs at least 4 digits"), std::string::npos) << page.message;
}

}  // namespace
}  // namespace kinship::service::administration_test
