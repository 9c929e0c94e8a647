// A query that fails explains itself: kinship-plan reports it, the server keeps what was in the
// way, and one file of it is planned again.

#include <gtest/gtest.h>

#include <fstream>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/problem_json.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::failed_attempt_test {
namespace {

/// A Panda that would turn through a wall.
Problem turn_through_a_wall() {
  Problem problem;
  problem.name = "turn";
  problem.T_task_base = Eigen::Isometry3d::Identity();
  const Path sweep = test::panda_sweep(1);
  problem.start = sweep.waypoints().col(0);
  problem.goal_configurations = sweep.waypoints().rightCols(1);
  problem.scene.objects = {
      {"table", BoxShape{{2, 2, 0.1}}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -0.25))},
      {"ceiling", BoxShape{{3, 3, 0.1}}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 1))},
      {"wall", BoxShape{{2, 0.05, 4}}, Eigen::Isometry3d(Eigen::Translation3d(1.2, 0, 0))}};
  problem.attached = {{"can",
                       "palm",
                       SphereShape{0.02},
                       Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.05)),
                       {"finger_left", "finger_right"}}};
  return problem;
}

class FailedAttempt : public testing::Test {
 protected:
  ProblemResult plan(const std::string& file, const std::string& more) {
    const test::Answer answer = cell_.run(
        "kinship-plan", (directory_.path() / file).string() + " --model " + test::source_dir() +
                            "/robots/models/panda --label panda --guidance none --json" +
                            " --max-checks 1000 " + more);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return json::problem_result_from_json(answer.out.substr(0, answer.out.find('\n')))
        .value_or_throw();
  }
  void write(const std::string& file, const Problem& problem) {
    std::ofstream(directory_.path() / file) << json::to_json(problem) << '\n';
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
};

TEST_F(FailedAttempt, NamesTheBodyInTheWayAndIsPlannedAgainFromOneFile) {
  cell_.start();
  write("problem.jsonl", turn_through_a_wall());
  const ProblemResult first =
      plan("problem.jsonl", "--task turn --report --outbox " + (directory_ / "outbox").string());
  ASSERT_FALSE(first.solved);

  AdminRequest request{.verb = AdminVerb::FindAttempts, .argument = "outcome=unsolved"};
  const auto summary =
      json::row_from_json<AttemptSummary>(cell_.ask(request).rows.at(0)).value_or_throw();
  EXPECT_TRUE(summary.has_search);
  EXPECT_NE(summary.why.find("'wall'"), std::string::npos) << summary.why;
  request.argument = "outcome=solved";
  EXPECT_TRUE(cell_.ask(request).rows.empty());

  const std::string id = summary.report_uuid.text();
  EXPECT_NE(cell_.kinship("attempts list --outcome unsolved").out.find(id.substr(0, 8)),
            std::string::npos);
  const test::Answer shown = cell_.kinship("attempts show " + id);
  EXPECT_NE(shown.out.find("why         " + first.reason), std::string::npos) << shown.out;
  EXPECT_NE(shown.out.find("touches 'wall' in "), std::string::npos) << shown.out;

  const std::string page = (directory_ / "attempt.html").string();
  const test::Answer plotted = cell_.kinship("attempts plot " + id + " --output " + page);
  ASSERT_EQ(plotted.code, 0) << plotted.err;
  EXPECT_NE(test::read_text(page).find(R"("second":"wall")"), std::string::npos);
  EXPECT_EQ(cell_.kinship("paths plot " + id + " --output -").code, 3);

  const std::string file = (directory_ / "again.jsonl").string();
  const test::Answer exported = cell_.kinship("attempts export " + id + " --output " + file);
  ASSERT_EQ(exported.code, 0) << exported.err;
  const ProblemResult again = plan("again.jsonl", "");
  EXPECT_FALSE(again.solved);
  EXPECT_EQ(again.reason, first.reason);
  EXPECT_EQ(again.collision_checks, first.collision_checks);

  const std::string text = test::read_text(file);
  Problem open = json::problem_from_json(text.substr(0, text.find('\n'))).value_or_throw();
  EXPECT_EQ(std::erase_if(open.scene.objects,
                          [](const SceneObject& object) { return object.name == "wall"; }),
            1U);
  write("open.jsonl", open);
  EXPECT_TRUE(plan("open.jsonl", "").solved);
}

TEST_F(FailedAttempt, WithAMeshThatWasRecordedAsSeveralSolidsIsPlannedAgainToo) {
  cell_.start();
  const Problem turn = turn_through_a_wall();
  Attempt attempt = test::panda_attempt(cell_.register_model("panda").robot, "turn", 1);
  attempt.path.reset();
  attempt.record.outcome = Outcome::Failed;
  RecordedScene& scene = attempt.scene.emplace();
  scene.objects = turn.scene.objects;
  scene.objects[1].name = scene.objects[2].name = "bin";
  scene.allowed_collisions = {{"bin", "table"}};
  SearchRecord& search = attempt.search.emplace();
  search.start = turn.start;
  search.goals = turn.goal_configurations;
  search.allowed_collisions = {{"palm", "bin"}};
  const Receipt receipt = cell_.client().deliver({attempt}).value_or_throw().at(0);
  ASSERT_EQ(receipt.status, ReceiptStatus::Recorded) << receipt.message;

  const std::string file = (directory_ / "again.jsonl").string();
  const test::Answer exported =
      cell_.kinship("attempts export " + attempt.report_uuid.text() + " --output " + file);
  ASSERT_EQ(exported.code, 0) << exported.err;
  const Problem again =
      json::problem_from_json(test::read_text(file).substr(0, test::read_text(file).find('\n')))
          .value_or_throw();
  EXPECT_EQ(again.scene.objects[1].name, "bin/1");
  EXPECT_EQ(again.scene.objects[2].name, "bin/2");
  using Pairs = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(again.allowed_collisions,
            (Pairs{{"bin/1", "table"}, {"bin/2", "table"}, {"palm", "bin/1"}, {"palm", "bin/2"}}));
}

TEST_F(FailedAttempt, IsReportedBareIfTheUserWantsSo) {
  cell_.start();
  write("problem.jsonl", turn_through_a_wall());
  plan("problem.jsonl",
       "--task turn --report --record-search never --outbox " + (directory_ / "outbox").string());
  const auto summary =
      json::row_from_json<AttemptSummary>(cell_.ask({.verb = AdminVerb::FindAttempts}).rows.at(0))
          .value_or_throw();
  EXPECT_FALSE(summary.has_search);
  const test::Answer exported = cell_.kinship("attempts export " + summary.report_uuid.text());
  EXPECT_NE(exported.err.find("--record-search"), std::string::npos) << exported.err;
}

}  // namespace
}  // namespace kinship::failed_attempt_test
