// A scene on its way: kinship-plan reports it with its attempts, kinshipd keeps it once, and the
// configurations of another robot that would touch it are left out and counted.

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/problem_json.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::recorded_scene_test {
namespace {

using std::chrono::seconds;

constexpr int kProblems = 5;

/// A Panda that turns in front of a wall, over a table and below a ceiling: room for its elbow, but
/// not for that of a UR10e that reaches over its shoulder.
Problem turn_before_the_wall(int number) {
  Problem problem;
  problem.name = "turn_" + std::to_string(number);
  problem.T_task_base = Eigen::Isometry3d::Identity();
  const Path sweep = test::panda_sweep(static_cast<std::uint64_t>(number));
  problem.start = sweep.waypoints().col(0);
  problem.goal_configurations = sweep.waypoints().rightCols(1);
  const auto at = [](double x, double z) {
    return Eigen::Isometry3d(Eigen::Translation3d(x, 0, z));
  };
  problem.scene.objects = {{"table", BoxShape{{2, 2, 0.1}}, at(0, -0.25)},
                           {"ceiling", BoxShape{{3, 3, 0.1}}, at(0, 1.0)},
                           {"wall", BoxShape{{0.05, 3, 3}}, at(-0.3, 0)}};
  problem.attached = {
      {"can", "palm", SphereShape{0.02}, at(0, 0.05), {"finger_left", "finger_right"}}};
  problem.allowed_collisions = {{"can", "table"}};
  return problem;
}

class RecordedScenes : public testing::Test {
 protected:
  RecordedScenes()
      : server_({.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}}),
        client_(
            {.domain = domain_.number(), .outbox = directory_ / "outbox", .timeout = seconds(60)}) {
    std::ofstream file(directory_ / "problems.jsonl");
    for (int i = 0; i < kProblems; ++i)
      file << json::to_json(turn_before_the_wall(i)) << '\n';
  }

  void plan_and_report(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {(directory_ / "problems.jsonl").string(),
                                          "--model",
                                          test::source_dir() + "/robots/models/panda",
                                          "--label",
                                          "panda",
                                          "--task",
                                          "turn",
                                          "--guidance",
                                          "none",
                                          "--report",
                                          "--timeout",
                                          "60",
                                          "--domain",
                                          std::to_string(domain_.number()),
                                          "--outbox",
                                          (directory_ / "plan_outbox").string(),
                                          "--output",
                                          (directory_ / "results.jsonl").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    test::Program plan("kinship-plan", arguments, directory_ / "plan.log");
    ASSERT_EQ(plan.wait(), 0) << test::read_text(directory_ / "plan.log");
  }

  /// The attempts that `paths export` hands out.
  std::vector<Attempt> exported() {
    AdminRequest request;
    request.verb = AdminVerb::ExportPaths;
    std::vector<Attempt> attempts;
    do {
      const AdminReply page = client_.admin(request).value_or_throw();
      for (const std::string& row : page.rows) {
        const json::ExperienceLine line = json::experience_line_from_json(row).value_or_throw();
        if (const auto* const named = std::get_if<json::NamedAttempt>(&line))
          attempts.push_back(named->attempt);
      }
      request.cursor = page.next_cursor;
    } while (!request.cursor.empty());
    return attempts;
  }

  /// What a UR10e at the same place gets of the Panda's experience, as `explain` tells it.
  Source source_of_ur10e() {
    FetchRequest request;
    request.task = "turn";
    request.robot = client_.register_robot(test::model_description("ur10e")).value_or_throw().robot;
    request.T_task_base = Eigen::Isometry3d::Identity();
    request.deadline = seconds(120);
    const FetchReply reply = client_.fetch(request).value_or_throw();
    EXPECT_TRUE(reply.distribution)
        << reply.message << "; planned: " << test::read_text(directory_ / "results.jsonl");
    AdminRequest explain;
    explain.verb = AdminVerb::ExplainDistribution;
    explain.argument = reply.distribution.value().id.hex();
    const AdminReply row = client_.admin(explain).value_or_throw();
    return json::row_from_json<Explanation>(row.rows.at(0))
        .value_or_throw()
        .distribution.sources.at(0);
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  test::ServerProcess server_;
  link::Client client_;
};

TEST_F(RecordedScenes, LeaveOutWhatAnotherRobotWouldTouchThere) {
  plan_and_report({});
  const std::vector<Attempt> attempts = exported();
  ASSERT_EQ(attempts.size(), static_cast<std::size_t>(kProblems));
  for (const Attempt& attempt : attempts) {
    ASSERT_TRUE(attempt.scene);
    EXPECT_EQ(content_digest(*attempt.scene), content_digest(*attempts[0].scene));
  }
  ASSERT_EQ(attempts[0].scene->objects.size(), 3U);
  ASSERT_EQ(attempts[0].scene->held.size(), 1U);
  EXPECT_EQ(attempts[0].scene->held[0].name, "can");
  EXPECT_EQ(attempts[0].scene->allowed_collisions.size(), 1U);

  const Source source = source_of_ur10e();
  EXPECT_EQ(source.paths_with_scene, source.paths_used);
  EXPECT_GT(source.paths_with_scene, 0U);
  EXPECT_GT(source.scene_collisions, 0U);
  EXPECT_LT(source.scene_collisions, source.filter_checks);
  EXPECT_GT(source.configurations, 0U);
}

TEST_F(RecordedScenes, AConstraintIsOneAlsoWhereNothingElseIs) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Problem problem = turn_before_the_wall(0);
  problem.scene = {};
  problem.attached.clear();
  problem.allowed_collisions.clear();
  problem.constraint.emplace();
  problem.constraint->bounds << -kInfinity, -kInfinity, -5, -kInfinity, -kInfinity, -kInfinity,  //
      kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity;
  std::ofstream(directory_ / "problems.jsonl") << json::to_json(problem) << '\n';
  plan_and_report({});
  const std::vector<Attempt> attempts = exported();
  ASSERT_EQ(attempts.size(), 1U);
  ASSERT_TRUE(attempts[0].scene && attempts[0].scene->constraint);
  EXPECT_EQ(attempts[0].scene->constraint->bounds, problem.constraint->bounds);
  EXPECT_TRUE(attempts[0].scene->objects.empty());
}

TEST_F(RecordedScenes, AreNotSentIfTheUserDoesNotWantIt) {
  plan_and_report({"--record-scenes", "no"});
  for (const Attempt& attempt : exported())
    EXPECT_FALSE(attempt.scene);
  const Source source = source_of_ur10e();
  EXPECT_GT(source.paths_used, 0U);
  EXPECT_EQ(source.paths_with_scene, 0U);
  EXPECT_EQ(source.scene_collisions, 0U);
}

}  // namespace
}  // namespace kinship::recorded_scene_test
